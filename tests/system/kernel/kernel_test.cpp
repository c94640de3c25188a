// The bench's instruments as the operating system shows them. In memory both sides of a transport
// are ours; here the kernel's own USB, USBTMC and HID drivers lie between, and a device can really
// go away. For that Debian's kernel runs in an emulated machine: this program boots it once and
// judges what was seen inside (the script `guest`).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/support/process.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

const std::filesystem::path kScripts = tests::source_tree() / "tests" / "system" / "kernel";
const std::filesystem::path kFolder = tests::build_tree() / "kernel";
const std::filesystem::path kKernel = kFolder / "debian";
const std::filesystem::path kResults = kFolder / "results";

std::string last_lines(const std::string& text, int count) {
  std::size_t from = text.size();
  while (count-- >= 0 && from != 0 && from != std::string::npos) from = text.rfind('\n', from - 1);
  return from == std::string::npos ? text : text.substr(from);
}

class RealKernel : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto fetched = support::Process({kScripts / "fetch_kernel", kKernel}).wait(300s);
    ASSERT_EQ(fetched.status, 0) << fetched.err;
    std::filesystem::remove_all(kResults);
    std::filesystem::create_directories(kResults);
    const auto booted = support::Process({kScripts / "boot", kKernel, kResults, kScripts / "guest",
                                          tests::build_tree()})
                            .wait(240s);
    std::ofstream(kFolder / "console.log") << booted.out << booted.err;
    ASSERT_NE(booted.out.find("guest: status 0\r\n"), std::string::npos)
        << "The guest did not come to its end. The last that it said:\n"
        << last_lines(booted.out, 60) << booted.err;
  }

  /// What the guest left in the file `name`.
  static std::string result(const std::string& name) {
    std::ifstream file(kResults / name);
    EXPECT_TRUE(file) << "the guest left no " << name;
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }
};

TEST_F(RealKernel, HasTheDriversOfUsbInstrumentsAndOfUsbIp) {
  for (const char* driver : {"usbtmc\n", "usbhid\n", "hid-generic\n"})
    EXPECT_THAT(result("drivers"), HasSubstr(driver));
  EXPECT_THAT(result("ports"), HasSubstr("Imported USB devices"));
}

}  // namespace
}  // namespace fogbench::system_tests
