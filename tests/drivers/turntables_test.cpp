#include "drivers/turntables.hpp"

#include <gtest/gtest.h>

#include "tests/support/fake_transports.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

class ScriptedOperator final : public Operator {
 public:
  Result<bool> confirm(const std::string& prompt) override {
    prompts.push_back(prompt);
    return answer;
  }
  std::vector<std::string> prompts;
  Result<bool> answer = true;
};

/// A table that turns at 3 deg/s.
class ScpiTurntableTest : public testing::Test {
 protected:
  class TurningTable final : public MessageTransport {
   public:
    explicit TurningTable(ScpiTurntableTest& test) : test_(test), inner_(test.far_) {}
    Status write(std::string_view message) override {
      test_.far_.answers["POS?"] = std::to_string(test_.position());
      return inner_.write(message);
    }
    Result<std::string> read(Clock::Duration timeout) override { return inner_.read(timeout); }
    Status clear() override { return inner_.clear(); }

   private:
    ScpiTurntableTest& test_;
    support::FakeMessages inner_;
  };

  ScpiTurntableTest() {
    config_.motorised = true;
    config_.device.emplace();
    config_.device->identity = "TABLE";
    config_.device->set = "MOVE {value}";
    config_.device->measure_query = "POS?";
    config_.device->minimum = -180.0;
    config_.device->maximum = 360.0;
    config_.device->read_back_tolerance = 0.01;
    far_.answers["*IDN?"] = "ACME TABLE";
    far_.obey = [this](const std::string& text) {
      from_ = position();
      to_ = std::stod(text.substr(5));
      started_ = clock_.now();
    };
  }
  double position() const {
    const double turned = jammed_ ? 0.0 : 3.0 * to_seconds(clock_.now() - started_);
    return to_ > from_ ? std::min(to_, from_ + turned) : std::max(to_, from_ - turned);
  }
  Result<std::unique_ptr<ScpiTurntable>> open() {
    return begun(
        ScpiTurntable::attach("turntable", config_, std::make_unique<TurningTable>(*this), clock_));
  }

  VirtualClock clock_;
  config::TurntableConfig config_;
  support::FakeScpi far_;
  double from_ = 0.0;
  double to_ = 0.0;
  Clock::Instant started_{};
  bool jammed_ = false;
};

TEST_F(ScpiTurntableTest, ReturnsOnceTheGyroStandsThere) {
  const auto table = open();
  ASSERT_TRUE(table) << table.error().message;
  ASSERT_TRUE((*table)->rotate_to(Degree{90.0}));
  EXPECT_EQ(*(*table)->azimuth(), Degree{90.0});
  EXPECT_NEAR(to_seconds(clock_.now().time_since_epoch()), 30.0, 0.6);
  EXPECT_EQ(*(*table)->identity(), "ACME TABLE");
}

TEST_F(ScpiTurntableTest, AJammedTableIsATimeout) {
  const auto table = open();
  ASSERT_TRUE(table);
  jammed_ = true;
  const Status status = (*table)->rotate_to(Degree{90.0});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(status.error().message, "turntable: stands at 0 deg 60 s after it was sent to 90 deg");
}

TEST_F(ScpiTurntableTest, AWholeTurnApartIsTheSamePlace) {
  const auto table = open();
  ASSERT_TRUE(table);
  to_ = from_ = 359.995;
  far_.obey = nullptr;
  EXPECT_TRUE((*table)->rotate_to(Degree{0.0}));
}

TEST_F(ScpiTurntableTest, AnAzimuthBeyondItsStopsIsRefusedBeforeTheWire) {
  const auto table = open();
  ASSERT_TRUE(table);
  far_.sent.clear();
  const Status status = (*table)->rotate_to(Degree{-181.0});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kLimit);
  EXPECT_TRUE(far_.sent.empty());
}

TEST_F(ScpiTurntableTest, AMotorWithoutADescriptionIsBadInput) {
  config_.device.reset();
  const auto table = open();
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().code, ErrorCode::kBadInput);
}

TEST(ManualTurntable, AsksTheOperatorOnceForEachMove) {
  ScriptedOperator operator_;
  ManualTurntable table("turntable", operator_);
  EXPECT_EQ(*table.azimuth(), Degree{0.0});
  ASSERT_TRUE(table.rotate_to(Degree{90.0}));
  ASSERT_TRUE(table.rotate_to(Degree{90.0}));
  EXPECT_EQ(operator_.prompts,
            std::vector<std::string>{"Turn the gyro from azimuth 0 deg to 90 deg, then confirm."});
  EXPECT_EQ(*table.azimuth(), Degree{90.0});
}

TEST(ManualTurntable, AnOperatorWhoDeclinesAbortsAndLeavesTheAzimuth) {
  ScriptedOperator operator_;
  operator_.answer = false;
  ManualTurntable table("turntable", operator_);
  const Status status = table.rotate_to(Degree{90.0});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kAborted);
  EXPECT_EQ(*table.azimuth(), Degree{0.0});

  operator_.answer = Error{ErrorCode::kTimeout, "nobody answers"};
  EXPECT_EQ(table.rotate_to(Degree{90.0}).error().message, "turntable: nobody answers");
}

}  // namespace
}  // namespace fogbench::drivers
