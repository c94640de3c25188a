#include "drivers/scpi_coil_supply.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/fake_transports.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

/// A supply whose read-back is the mean of the last 320 ms.
class ScpiCoilSupplyTest : public testing::Test {
 protected:
  ScpiCoilSupplyTest() {
    config_.device.name = "test supply";
    config_.device.identity = "KEPCO";
    config_.device.set = "CURR {value}";
    config_.device.set_query = "CURR?";
    config_.device.measure_query = "MEAS:CURR?";
    config_.device.output_on = "OUTP ON";
    config_.device.output_off = "OUTP OFF";
    config_.device.minimum = -6.0;
    config_.device.maximum = 6.0;
    config_.device.resolution = 0.001;
    config_.device.read_back_tolerance = 0.004;
    far_.answers["*IDN?"] = "KEPCO,BOP";
    far_.obey = [this](const std::string& text) {
      if (text.starts_with("CURR ")) program(std::stod(text.substr(5)));
      if (text.starts_with("OUTP")) on_ = text == "OUTP ON";
      if (text == "OUTP OFF") program(0.0);
    };
    report();
  }
  void program(double current_a) {
    before_a_ = stuck_ ? before_a_ : set_a_;
    set_a_ = current_a;
    changed_ = clock_.now();
    report();
  }
  void report() {
    far_.answers["CURR?"] = std::to_string(set_a_);
    far_.answers["MEAS:CURR?"] = std::to_string(settled() && !stuck_ ? set_a_ : before_a_);
  }
  bool settled() const { return clock_.now() - changed_ >= 320ms; }
  /// The answer depends on when it is asked for.
  class LiveMessages final : public MessageTransport {
   public:
    explicit LiveMessages(ScpiCoilSupplyTest& test) : test_(test), inner_(test.far_) {}
    Status write(std::string_view message) override {
      test_.report();
      return inner_.write(message);
    }
    Result<std::string> read(Clock::Duration timeout) override { return inner_.read(timeout); }
    Status clear() override { return inner_.clear(); }

   private:
    ScpiCoilSupplyTest& test_;
    support::FakeMessages inner_;
  };
  Result<std::unique_ptr<ScpiCoilSupply>> open() {
    return begun(ScpiCoilSupply::attach("coil_vertical", config_,
                                        std::make_unique<LiveMessages>(*this), clock_));
  }
  std::unique_ptr<ScpiCoilSupply> enabled() {
    auto supply = open();
    EXPECT_TRUE(supply) << supply.error().message;
    const Status on = (*supply)->enable();
    EXPECT_TRUE(on) << on.error().message;
    far_.sent.clear();
    return std::move(*supply);
  }

  VirtualClock clock_;
  config::CoilConfig config_;
  support::FakeScpi far_;
  double set_a_ = 2.5;  // left behind by somebody
  double before_a_ = 2.5;
  Clock::Instant changed_{-1h};
  bool on_ = true;
  bool stuck_ = false;
};

TEST_F(ScpiCoilSupplyTest, IsAtZeroWithItsOutputOffOnceOpened) {
  const auto supply = open();
  ASSERT_TRUE(supply) << supply.error().message;
  EXPECT_EQ(set_a_, 0.0);
  EXPECT_FALSE(on_);
  EXPECT_EQ(*(*supply)->identity(), "KEPCO,BOP");
}

TEST_F(ScpiCoilSupplyTest, SwitchesOnAtZero) {
  const auto supply = enabled();
  EXPECT_TRUE(on_);
  EXPECT_EQ(set_a_, 0.0);
}

TEST_F(ScpiCoilSupplyTest, WaitsForTheReadBackToBeValid) {
  const auto supply = enabled();
  const Clock::Instant before = clock_.now();
  ASSERT_TRUE(supply->set_current(Ampere{-1.11249}));
  EXPECT_EQ(clock_.now() - before, 320ms);
  EXPECT_TRUE(far_.was_sent("CURR -1.112000"));
  const auto reading = supply->read();
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->set, Ampere{-1.112});
  EXPECT_EQ(reading->measured, Ampere{-1.112});
  EXPECT_EQ(reading->taken_at, clock_.now());
}

TEST_F(ScpiCoilSupplyTest, RefusesACurrentBeyondEitherLimitBeforeTheWire) {
  const auto supply = enabled();
  for (const double current : {4.001, -4.001, 1e9, std::nan("")}) {
    const Status status = supply->set_current(Ampere{current});
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::kLimit);
  }
  EXPECT_EQ(supply->set_current(Ampere{4.5}).error().message,
            "coil_vertical: current 4.5 A is outside -4 ... 4 A");
  EXPECT_TRUE(far_.sent.empty());
  EXPECT_TRUE(supply->set_current(Ampere{4.0}));
}

TEST_F(ScpiCoilSupplyTest, AnOutputThatDoesNotFollowIsADeviceError) {
  const auto supply = enabled();
  stuck_ = true;
  before_a_ = 0.0;
  const Status status = supply->set_current(Ampere{2.0});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kDevice);
  EXPECT_EQ(
      status.error().message,
      "coil_vertical: was set to 2.000000 A but measures 0.000000 A, more than 0.004 A apart");
}

TEST_F(ScpiCoilSupplyTest, OneWrongReadBackIsForgiven) {
  const auto supply = enabled();
  stuck_ = true;
  before_a_ = 0.0;
  far_.before_write = [&](const std::string& text) {
    if (text == "MEAS:CURR?") stuck_ = false;  // from the next question on
  };
  const Clock::Instant before = clock_.now();
  EXPECT_TRUE(supply->set_current(Ampere{2.0}));
  EXPECT_EQ(clock_.now() - before, 640ms);
}

TEST_F(ScpiCoilSupplyTest, ARefusalOfTheInstrumentIsADeviceErrorWithItsWords) {
  const auto supply = enabled();
  far_.obey = [&](const std::string&) { far_.errors.emplace_back("-222,\"Data out of range\""); };
  const Status status = supply->set_current(Ampere{2.0});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kDevice);
  EXPECT_NE(status.error().message.find("-222"), std::string::npos);
}

TEST_F(ScpiCoilSupplyTest, IsSwitchedOffByZeroAndOutputOffAndAskedAfterItHasSettled) {
  const auto supply = enabled();
  ASSERT_TRUE(supply->set_current(Ampere{3.0}));
  far_.sent.clear();
  ASSERT_TRUE(supply->switch_off());
  EXPECT_EQ(far_.sent, (std::vector<std::string>{"CURR 0.000000", "OUTP OFF"}));
  EXPECT_FALSE(on_);
  const Clock::Instant told = clock_.now();
  ASSERT_TRUE(supply->confirm_off());
  EXPECT_EQ(far_.sent,
            (std::vector<std::string>{"CURR 0.000000", "OUTP OFF", "MEAS:CURR?", "SYST:ERR?"}));
  EXPECT_EQ(clock_.now() - told, 320ms);
}

TEST_F(ScpiCoilSupplyTest, SwitchingOffGoesOnAfterAFailureAndReportsTheFirst) {
  const auto supply = enabled();
  ASSERT_TRUE(supply->set_current(Ampere{3.0}));
  far_.write_failures = {{ErrorCode::kTimeout, "no answer"}};
  const Status status = supply->switch_off();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kTimeout);
  EXPECT_FALSE(on_);
  EXPECT_TRUE(supply->switch_off());
  EXPECT_EQ(set_a_, 0.0);
}

TEST_F(ScpiCoilSupplyTest, AStrangerIsSwitchedOffToo) {
  config_.device.identity = "ANOTHER,SUPPLY";
  auto supply = ScpiCoilSupply::attach("coil_vertical", config_,
                                       std::make_unique<LiveMessages>(*this), clock_);
  ASSERT_TRUE(supply) << supply.error().message;
  set_a_ = 3.0;
  on_ = true;
  ASSERT_TRUE((*supply)->switch_off());
  EXPECT_EQ(set_a_, 0.0);
  EXPECT_FALSE(on_);
  EXPECT_TRUE((*supply)->confirm_off());
  EXPECT_EQ((*supply)->begin().error().code, ErrorCode::kDevice);
}

TEST_F(ScpiCoilSupplyTest, ARefusalToSwitchOffIsToldAndIsNotTheNextCommands) {
  const auto supply = enabled();
  far_.obey = [&](const std::string& text) {
    if (text == "OUTP OFF") far_.errors.emplace_back("-221,\"Settings conflict\"");
  };
  ASSERT_TRUE(supply->switch_off());
  EXPECT_TRUE(supply->set_current(Ampere{0.0}));
  ASSERT_TRUE(supply->switch_off());
  const Status off = supply->confirm_off();
  ASSERT_FALSE(off);
  EXPECT_NE(off.error().message.find("switching off was refused: -221"), std::string::npos);
}

TEST_F(ScpiCoilSupplyTest, AnOutputThatCannotBeSwitchedIsOnlySetToZero) {
  config_.device.output_on.clear();
  config_.device.output_off.clear();
  const auto supply = enabled();
  ASSERT_TRUE(supply->set_current(Ampere{1.0}));
  ASSERT_TRUE(supply->switch_off());
  EXPECT_EQ(set_a_, 0.0);
  EXPECT_FALSE(far_.was_sent(""));
}

}  // namespace
}  // namespace fogbench::drivers
