// The bench's instruments as the operating system shows them. In memory both sides of a transport
// are ours; here the kernel's own USB, USBTMC and HID drivers, udev, libusb and hidapi lie between,
// and a device can really go away. For that Debian's kernel runs in an emulated machine: this
// program boots it once and judges what was seen inside (the script `guest`).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "config/device.hpp"
#include "config/device_file.hpp"
#include "drivers/number_codec.hpp"
#include "tests/support/process.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::DoubleNear;
using testing::ElementsAre;
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
                            .wait(400s);
    std::ofstream(kFolder / "console.log") << booted.out << booted.err;
    ASSERT_NE(booted.out.find("guest: status 0\r\n"), std::string::npos)
        << "The guest did not come to its end. The last that it said:\n"
        << last_lines(booted.out, 60) << booted.err;
  }

  /// What the guest left in the file `name`.
  static std::string result(const std::string& name) {
    std::ifstream file(kResults / name, std::ios::binary);
    EXPECT_TRUE(file) << "the guest left no " << name;
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  /// A run of the guest's store `name`.
  static nlohmann::json run(const std::string& name, const std::string& number = "1") {
    const auto shown = support::run({tests::build_tree() / "fogbench", "show", number, "--store",
                                     kResults / (name + ".db"), "--json"});
    EXPECT_EQ(shown.status, 0) << shown.err;
    return nlohmann::json::parse(shown.out, nullptr, false);
  }

  /// All messages of a run, a line each.
  static std::string events(const nlohmann::json& run) {
    std::string all;
    for (const auto& event : run["events"]) all += event["message"].get<std::string>() + "\n";
    return all;
  }
};

TEST_F(RealKernel, HasTheDriversOfUsbInstrumentsAndSeesThemExported) {
  EXPECT_THAT(result("drivers"),
              AllOf(HasSubstr("usbtmc\n"), HasSubstr("usbhid\n"), HasSubstr("hid-generic\n")));
  // As Debian's usbip prints them.
  EXPECT_THAT(result("exported"),
              AllOf(HasSubstr("1-1: "), HasSubstr("1-2: "), HasSubstr("1-3: "), HasSubstr("1-4: "),
                    HasSubstr("Test and Measurement / TMC"), HasSubstr("Human Interface Device")));
}

TEST_F(RealKernel, ItsUsbtmcDriverSpeaksToASupply) {
  EXPECT_EQ(result("usbtmc"),
            "identity KEPCO,BOP\n"
            "status byte 0\n"
            "unasked ETIMEDOUT\n"
            "after a time-out 0.000000E+00\n"
            "after a clear 0.000000E+00\n");
}

TEST_F(RealKernel, ItsHidrawDeliversTheMagnetometersReports) {
  const auto file =
      config::load_device(tests::source_tree() / "config/devices/magnetometer-hid.json");
  ASSERT_TRUE(file) << file.error().message;
  const auto& device = std::get<config::HidDevice>(*file);
  const std::string bytes = result("reports");
  ASSERT_EQ(bytes.size(), 3U * device.report_bytes);
  std::vector<double> field_x_ut, sequence;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::span report(
        reinterpret_cast<const std::uint8_t*>(bytes.data()) + i * device.report_bytes,
        device.report_bytes);
    EXPECT_EQ(report[0], device.report_id);
    for (const config::FieldSpec& field : device.fields) {
      const auto value = drivers::read_field(field, device.byte_order, report);
      ASSERT_TRUE(value);
      if (field.name == "field_x") field_x_ut.push_back(*value);
      if (field.name == "sequence") sequence.push_back(*value);
    }
  }
  // The simulated bench's ambient field along the vertical.
  for (const double ut : field_x_ut) EXPECT_NEAR(ut, -50.0, 0.5);
  // On a busy machine one is left out.
  EXPECT_GE(sequence[1] - sequence[0], 1.0);
  EXPECT_GE(sequence[2] - sequence[1], 1.0);
}

TEST_F(RealKernel, PyvisaSpeaksToASupply) {
  EXPECT_EQ(result("pyvisa"),
            "identity KEPCO,BOP\n"
            "set 0.25\n"
            "refused -222,\"Data out of range\"\n"
            "zero 0.0\n");
}

TEST_F(RealKernel, AnAuxiliarySensorThatIsUnpluggedCostsItsOwnChannelOnly) {
  EXPECT_EQ(result("sensors.status"), "0\n") << result("sensors.log");
  const auto run = this->run("sensors");
  EXPECT_EQ(run["outcome"], "completed");
  EXPECT_THAT(events(run), AllOf(HasSubstr("light_meter: HID device"), HasSubstr("is gone"),
                                 HasSubstr("light_meter: answers again after")));
  const auto exported = support::run({tests::build_tree() / "fogbench", "export", "1", "--store",
                                      kResults / "sensors.db", "-o", kResults / "sensors.csv"});
  ASSERT_EQ(exported.status, 0) << exported.err;
  std::istringstream rows(result("sensors.csv"));
  std::string header, row;
  std::getline(rows, header);
  EXPECT_THAT(header,
              testing::EndsWith("humidity_percent,illuminance_lx,pressure_hpa,room_c,supply_v"));
  std::size_t with = 0, without = 0;
  while (std::getline(rows, row)) {
    // From the end: supply_v, room_c, pressure_hpa, illuminance_lx, humidity_percent.
    std::vector<std::string> cells(5);
    for (std::string& cell : cells) {
      const std::size_t comma = row.rfind(',');
      cell = row.substr(comma + 1);
      row.resize(comma);
    }
    for (const std::size_t other : {0U, 1U, 2U, 4U}) EXPECT_NE(cells[other], "") << other;
    ++(cells[3].empty() ? without : with);
  }
  EXPECT_GE(with, 2U);
  EXPECT_GE(without, 1U);
}

TEST_F(RealKernel, ASweepIsInterruptedByAPulledPlugAndBeginsAnew) {
  EXPECT_EQ(result("replugged.status"), "0\n") << result("replugged.log");
  const auto run = this->run("replugged");
  EXPECT_EQ(run["outcome"], "completed");
  EXPECT_EQ(run["safe_state_reached"], true);
  EXPECT_THAT(events(run), AllOf(HasSubstr("coil_horizontal"), HasSubstr("coils to 0 A"),
                                 HasSubstr("interrupted, it restarts from step 2.1")));
  // The first level of the interrupted sweep is void; then come all of them.
  EXPECT_EQ(run["points"], 4);
  EXPECT_EQ(run["points_void"], 1);
  std::vector<double> fields_ut;
  for (const auto& point : run["measured"]) fields_ut.push_back(point["field_x_ut"]);
  EXPECT_THAT(fields_ut, ElementsAre(DoubleNear(0.0, 2.0), DoubleNear(0.0, 2.0),
                                     DoubleNear(200.0, 2.0), DoubleNear(0.0, 2.0)));
}

TEST_F(RealKernel, ADaemonThatIsKilledLeavesCurrentThatTheNextSwitchesOffWhateverElseIsMissing) {
  EXPECT_EQ(result("resumed.status"), "0\n") << result("resumed.log");
  // From the kill to the safe state, read back from both supplies, on the emulated machine.
  std::istringstream times(result("killed.times"));
  double killed_s = 0.0, safe_s = 0.0;
  ASSERT_TRUE(times >> killed_s >> safe_s);
  EXPECT_LT(safe_s - killed_s, 15.0) << result("resumed.log");
  // While the magnetometer is not there.
  EXPECT_THAT(result("resumed.log"),
              HasSubstr("safe state: coil_horizontal off, read back; coil_vertical off, read back; "
                        "thermostat off, read back"));
  EXPECT_THAT(result("waiting"), HasSubstr("waiting: magnetometer: HID device"));

  const auto before = run("killed"), after = run("killed", "2");
  EXPECT_EQ(before["outcome"], "interrupted") << result("resume");
  EXPECT_EQ(before["points_void"], 1);
  EXPECT_EQ(after["outcome"], "completed");
  EXPECT_EQ(after["takes_up"], 1);
  EXPECT_EQ(after["safe_state_reached"], true);
  EXPECT_THAT(events(after), HasSubstr("takes up run 1 at step 2.1"));
  std::vector<double> fields_ut;
  for (const auto& point : after["measured"]) fields_ut.push_back(point["field_x_ut"]);
  EXPECT_THAT(fields_ut, ElementsAre(DoubleNear(0.0, 2.0), DoubleNear(0.0, 2.0),
                                     DoubleNear(200.0, 2.0), DoubleNear(0.0, 2.0)));
}

TEST_F(RealKernel, ASweepWhoseMagnetometerNeverComesBackEndsInTheSafeState) {
  EXPECT_EQ(result("lost.status"), "4\n") << result("lost.log");
  const auto run = this->run("lost");
  EXPECT_EQ(run["outcome"], "failed");
  EXPECT_EQ(run["safe_state_reached"], true);
  EXPECT_THAT(run["reason"].get<std::string>(), HasSubstr("magnetometer"));
  EXPECT_THAT(events(run), HasSubstr("coils to 0 A"));
  // Both supplies say so, through the kernel's driver: what is set, and what flows.
  std::istringstream left(result("left_behind"));
  for (int supply = 0; supply < 2; ++supply) {
    double set_a = 1.0, measured_a = 1.0;
    ASSERT_TRUE(left >> set_a >> measured_a);
    EXPECT_EQ(set_a, 0.0);
    EXPECT_NEAR(measured_a, 0.0, 0.001);
  }
}

}  // namespace
}  // namespace fogbench::system_tests
