#include "drivers/hid_magnetometer.hpp"

#include <gtest/gtest.h>

#include "drivers/number_codec.hpp"
#include "tests/support/fake_transports.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

class HidMagnetometerTest : public testing::Test {
 protected:
  HidMagnetometerTest() {
    device_.name = "test magnetometer";
    device_.report_id = 1;
    device_.report_bytes = 16;
    device_.range = Microtesla{600.0};
    for (std::uint16_t i = 0; i < 3; ++i) {
      device_.fields.push_back({.name = std::string("field_") + "xyz"[i],
                                .offset_bytes = static_cast<std::uint16_t>(1 + 4 * i),
                                .type = NumberType::kInt32,
                                .scale = 1e-4,
                                .unit = "uT"});
    }
    device_.fields.push_back({.name = "sequence", .offset_bytes = 13, .type = NumberType::kUint16});
    device_.fields.push_back({.name = "status", .offset_bytes = 15, .type = NumberType::kUint8});
    send({1.0, 2.0, 3.0}, 0);
  }
  std::vector<std::uint8_t> report(std::array<double, 3> field_ut, int sequence, int status = 0) {
    std::vector<std::uint8_t> bytes(device_.report_bytes);
    bytes[0] = device_.report_id;
    for (const FieldSpec& field : device_.fields) {
      double value = status;
      if (field.name == "sequence") value = sequence;
      if (field.name.starts_with("field_")) {
        value = field_ut[static_cast<std::size_t>(field.name.back() - 'x')];
      }
      EXPECT_TRUE(write_field(field, device_.byte_order, value, bytes));
    }
    return bytes;
  }
  void send(std::array<double, 3> field_ut, int sequence, int status = 0) {
    far_.reports.push_back(report(field_ut, sequence, status));
  }
  Result<std::unique_ptr<HidMagnetometer>> open() {
    return begun(HidMagnetometer::attach("magnetometer", device_,
                                         std::make_unique<support::FakeHid>(far_), clock_));
  }
  /// Opened, with only what is sent from now on to come.
  std::unique_ptr<HidMagnetometer> opened() {
    auto magnetometer = open();
    EXPECT_TRUE(magnetometer) << magnetometer.error().message;
    far_.reports.clear();
    return std::move(*magnetometer);
  }
  /// What reading gives when only this report comes.
  ErrorCode failure_of(const std::vector<std::uint8_t>& bytes, std::string* message = nullptr) {
    const auto magnetometer = opened();
    far_.reports = {bytes};
    const auto reading = magnetometer->read();
    EXPECT_FALSE(reading);
    if (message != nullptr) *message = reading.error().message;
    far_.reports = {report({1.0, 2.0, 3.0}, 0)};
    return reading.error().code;
  }

  VirtualClock clock_;
  config::HidDevice device_;
  support::FakeReports far_;
};

TEST_F(HidMagnetometerTest, ReadsTheThreeAxes) {
  const auto magnetometer = opened();
  clock_.sleep_for(5s);
  send({-312.5, 0.0001, 599.9}, 7);
  const auto reading = magnetometer->read();
  ASSERT_TRUE(reading) << reading.error().message;
  EXPECT_NEAR(reading->field[0].value, -312.5, 1e-9);
  EXPECT_NEAR(reading->field[1].value, 0.0001, 1e-9);
  EXPECT_NEAR(reading->field[2].value, 599.9, 1e-9);
  EXPECT_EQ(reading->taken_at, clock_.now());
  EXPECT_EQ(*magnetometer->identity(), "test magnetometer");
}

TEST_F(HidMagnetometerTest, CorrectsByTheCertificatesOffsetAndMatrix) {
  device_.calibration_offset_ut = {1.0, -2.0, 0.5};
  device_.calibration_matrix = {{{1.0, 0.1, 0.0}, {0.0, 2.0, 0.0}, {0.5, 0.0, 1.0}}};
  const auto magnetometer = opened();
  send({11.0, 18.0, 30.5}, 1);  // less the offset: 10, 20, 30
  const auto reading = magnetometer->read();
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->field[0].value, 12.0, 1e-9);
  EXPECT_NEAR(reading->field[1].value, 40.0, 1e-9);
  EXPECT_NEAR(reading->field[2].value, 35.0, 1e-9);
}

TEST_F(HidMagnetometerTest, ASaturatedAxisIsADeviceError) {
  for (const double field : {600.0, -600.0, 650.0}) {
    std::string message;
    EXPECT_EQ(failure_of(report({0.0, field, 0.0}, 5), &message), ErrorCode::kDevice);
    EXPECT_NE(message.find("magnetometer: field_y reads"), std::string::npos) << message;
  }
}

TEST_F(HidMagnetometerTest, ABadStatusIsADeviceError) {
  std::string message;
  EXPECT_EQ(failure_of(report({0.0, 0.0, 0.0}, 5, 4), &message), ErrorCode::kDevice);
  EXPECT_EQ(message, "magnetometer: its status is 4, expected 0");
}

TEST_F(HidMagnetometerTest, AnotherReportOrAShortOneIsAProtocolError) {
  auto other = report({0.0, 0.0, 0.0}, 5);
  other[0] = 2;
  EXPECT_EQ(failure_of(other), ErrorCode::kProtocol);
  auto cut = report({0.0, 0.0, 0.0}, 5);
  cut.pop_back();
  EXPECT_EQ(failure_of(cut), ErrorCode::kProtocol);
}

TEST_F(HidMagnetometerTest, ANanIsAProtocolError) {
  for (FieldSpec& field : device_.fields) {
    if (field.name == "field_z") field.type = NumberType::kFloat32;
  }
  far_.reports = {report({1.0, 2.0, 3.0}, 0)};
  auto nan = report({0.0, 0.0, 0.0}, 5);
  store_bytes(nan.data() + 9, 4, device_.byte_order, 0x7fc00000);
  std::string message;
  EXPECT_EQ(failure_of(nan, &message), ErrorCode::kProtocol);
  EXPECT_EQ(message, "magnetometer: field_z: reads nan, expected a finite number");
}

TEST_F(HidMagnetometerTest, ARepeatedSequenceIsStaleEvenWithAnotherField) {
  const auto magnetometer = opened();
  send({9.0, 9.0, 9.0}, 0);
  const auto reading = magnetometer->read();
  ASSERT_FALSE(reading);
  EXPECT_EQ(reading.error().code, ErrorCode::kStale);
  EXPECT_EQ(reading.error().message, "magnetometer: has repeated one report for 1 s");
  EXPECT_EQ(clock_.now().time_since_epoch(), 1s);
}

TEST_F(HidMagnetometerTest, WaitsForTheNextReportWhenAskedTooEarly) {
  const auto magnetometer = opened();
  send({1.0, 2.0, 3.0}, 0);
  send({1.0, 2.0, 3.0}, 1);
  EXPECT_TRUE(magnetometer->read());
  EXPECT_EQ(clock_.now().time_since_epoch(), 100ms);
}

TEST_F(HidMagnetometerTest, WithoutASequenceAnEqualReportIsARepeatedOne) {
  std::erase_if(device_.fields, [](const FieldSpec& field) { return field.name == "sequence"; });
  far_.reports = {report({1.0, 2.0, 3.0}, 0)};
  const auto magnetometer = opened();
  send({1.0, 2.0, 3.0}, 0);
  EXPECT_EQ(magnetometer->read().error().code, ErrorCode::kStale);
  far_.reports = {report({1.0, 2.0001, 3.0}, 0)};
  EXPECT_TRUE(magnetometer->read());
}

TEST_F(HidMagnetometerTest, ASilentDeviceIsATimeout) {
  const auto magnetometer = opened();
  const auto reading = magnetometer->read();
  ASSERT_FALSE(reading);
  EXPECT_EQ(reading.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(reading.error().message, "magnetometer: no report");
  far_.failure = Error{ErrorCode::kUnplugged, "unplugged"};
  EXPECT_EQ(magnetometer->read().error().code, ErrorCode::kUnplugged);
}

TEST_F(HidMagnetometerTest, ALayoutThatCannotBeIsBadInput) {
  device_.fields[1].offset_bytes = 13;
  EXPECT_EQ(open().error().code, ErrorCode::kBadInput);
  device_.fields.erase(device_.fields.begin());
  const auto magnetometer = open();
  ASSERT_FALSE(magnetometer);
  EXPECT_EQ(magnetometer.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(magnetometer.error().message,
            "magnetometer: the report of test magnetometer has no field field_x");
}

TEST_F(HidMagnetometerTest, AReportWhoseCountWentBackIsStaleOnce) {
  const auto magnetometer = opened();
  const auto read = [&](double field_ut, int sequence) {
    far_.reports = {report({field_ut, 0.0, 0.0}, sequence)};
    return magnetometer->read();
  };
  EXPECT_TRUE(read(1.0, 500));
  const auto old = read(2.0, 250);
  ASSERT_FALSE(old);
  EXPECT_EQ(old.error().code, ErrorCode::kStale);
  EXPECT_EQ(old.error().message, "magnetometer: the count of its reports went back");
  EXPECT_TRUE(read(3.0, 251)) << "it may have restarted";
}

TEST_F(HidMagnetometerTest, ACountMayTurnOverAndAnyNumberMayComeAfterALongSilence) {
  const auto magnetometer = opened();
  far_.reports = {report({1.0, 0.0, 0.0}, 65530)};
  // 0 was the last one: 65530 of 65536 looks like a step back, unless nobody has read for long.
  clock_.sleep_for(2h);
  EXPECT_TRUE(magnetometer->read());
  clock_.sleep_for(1s);
  far_.reports = {report({1.1, 0.0, 0.0}, 4)};
  EXPECT_TRUE(magnetometer->read());
}

TEST_F(HidMagnetometerTest, AxesThatStandStillWhileTheCountGoesOnAreStale) {
  device_.stuck_after = config::Seconds{2.0};
  const auto magnetometer = opened();
  std::vector<bool> good;
  for (int second = 1; second <= 4; ++second) {
    clock_.sleep_for(1s);
    far_.reports = {report({1.0, 2.0, second < 4 ? 3.0 : 3.1}, 10 * second)};
    good.push_back(static_cast<bool>(magnetometer->read()));
  }
  EXPECT_EQ(good, (std::vector<bool>{true, false, false, true}));
}

}  // namespace
}  // namespace fogbench::drivers
