#include "simulator/fault_schedule.hpp"

#include <gtest/gtest.h>

namespace fogbench::simulator {
namespace {

FaultSchedule scheduled(const config::FaultSpec& spec) {
  const auto made = FaultSchedule::create({spec}, "thermostat", {FaultKind::kTimeout});
  EXPECT_TRUE(made);
  return *made;
}

/// "x" for every operation that is spoilt, "." for the others, a second apart.
std::string spoilt(FaultSchedule schedule, const std::vector<std::string>& operations) {
  std::string pattern;
  for (const std::string& operation : operations) {
    schedule.begin(operation);
    const auto time_s = static_cast<double>(pattern.size());
    EXPECT_FALSE(schedule.active(FaultKind::kGarbage, time_s));
    pattern += schedule.active(FaultKind::kTimeout, time_s) ? 'x' : '.';
  }
  return pattern;
}

const std::vector<std::string> kOperations = {"read", "set_mode", "read",     "set_target",
                                              "read", "read",     "set_mode", "read"};

config::FaultSpec by_count(std::uint32_t first, std::uint32_t count, std::string operation = "") {
  config::FaultSpec spec{.device = "thermostat"};
  spec.at_operation = first;
  spec.operations = count;
  spec.operation = std::move(operation);
  return spec;
}

config::FaultSpec by_time(double at_s, double for_s, std::string operation = "") {
  config::FaultSpec spec{.device = "thermostat"};
  spec.at = config::Seconds{at_s};
  spec.duration = config::Seconds{for_s};
  spec.operation = std::move(operation);
  return spec;
}

TEST(FaultSchedule, SpoilsTheOperationsCountedFromOne) {
  EXPECT_EQ(spoilt(scheduled(by_count(1, 1)), kOperations), "x.......");
  EXPECT_EQ(spoilt(scheduled(by_count(3, 2)), kOperations), "..xx....");
  EXPECT_EQ(spoilt(scheduled(by_count(9, 5)), kOperations), "........");
}

TEST(FaultSchedule, CountsOnlyTheOperationsOfItsName) {
  EXPECT_EQ(spoilt(scheduled(by_count(2, 2, "read")), kOperations), "..x.x...");
  EXPECT_EQ(spoilt(scheduled(by_count(2, 9, "set_mode")), kOperations), "......x.");
}

TEST(FaultSchedule, ATimeCanBeNarrowedToAnOperation) {
  EXPECT_EQ(spoilt(scheduled(by_time(2.0, 4.0)), kOperations), "..xxxx..");
  EXPECT_EQ(spoilt(scheduled(by_time(2.0, 4.0, "read")), kOperations), "..x.xx..");
}

TEST(FaultSchedule, AFaultByHandLastsUntilItIsSwitchedOff) {
  FaultSchedule schedule;
  EXPECT_TRUE(schedule.empty());
  schedule.set(FaultKind::kUnplug, true);
  EXPECT_FALSE(schedule.empty());
  schedule.begin("read");
  EXPECT_TRUE(schedule.active(FaultKind::kUnplug, 0.0));
  EXPECT_TRUE(schedule.unplugged(1e6));
  EXPECT_FALSE(schedule.active(FaultKind::kTimeout, 0.0));
  schedule.set(FaultKind::kUnplug, false);
  EXPECT_FALSE(schedule.active(FaultKind::kUnplug, 0.0));
  EXPECT_FALSE(schedule.unplugged(0.0));
}

TEST(FaultSchedule, TakesOnlyItsOwnInstrumentsFaults) {
  const auto other = FaultSchedule::create({by_count(1, 1)}, "gyro", {});
  ASSERT_TRUE(other);
  EXPECT_TRUE(other->empty());
}

}  // namespace
}  // namespace fogbench::simulator
