// Whoever copies the ready files gets access to the instruments that they name.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/bench.hpp"
#include "config/connection.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::config {
namespace {

std::string rule_of(const char* subsystem, const UsbIdentity& device, const std::string& rules) {
  std::istringstream lines(rules);
  const std::string vendor = fmt::format("{{idVendor}}==\"{:04x}\"", device.vendor);
  const std::string product = fmt::format("{{idProduct}}==\"{:04x}\"", device.product);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(fmt::format("SUBSYSTEM==\"{}\"", subsystem)) &&
        line.find(vendor) != std::string::npos && line.find(product) != std::string::npos) {
      return line;
    }
  }
  return "none";
}

TEST(UdevRules, NameEveryUsbDeviceOfTheReadyFiles) {
  const std::string rules =
      support::read_text(tests::source_tree() / "config/udev/60-fogbench.rules");
  ASSERT_FALSE(rules.empty());
  int devices = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(tests::source_tree() / "config/benches")) {
    const auto bench = load_bench(file.path());
    ASSERT_TRUE(bench) << bench.error().message;
    for (const InstrumentConfig* instrument :
         {static_cast<const InstrumentConfig*>(&bench->coil_horizontal),
          static_cast<const InstrumentConfig*>(&bench->coil_vertical),
          static_cast<const InstrumentConfig*>(&bench->magnetometer)}) {
      const auto connection = parse_connection(instrument->connection);
      ASSERT_TRUE(connection);
      if (const auto* usb = std::get_if<UsbConnection>(&*connection)) {
        EXPECT_THAT(rule_of("usb", *usb, rules), testing::HasSubstr("MODE=\"0660\""));
        ++devices;
      } else if (const auto* hid = std::get_if<HidConnection>(&*connection)) {
        EXPECT_THAT(rule_of("hidraw", *hid, rules), testing::HasSubstr("MODE=\"0660\""));
        ++devices;
      }
    }
    const HidDevice& magnetometer = bench->magnetometer.device;
    EXPECT_NE(rule_of("hidraw", {magnetometer.vendor_id, magnetometer.product_id, ""}, rules),
              "none")
        << magnetometer.name;
  }
  EXPECT_GE(devices, 3) << "the factory's bench has two supplies and a magnetometer";
}

}  // namespace
}  // namespace fogbench::config
