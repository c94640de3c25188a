#include "drivers/stillness.hpp"

#include <gtest/gtest.h>

#include <array>

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

/// Adds one reading a second; the first second at which it complains, or -1.
int complains_at(StillnessWatch watch, const std::vector<std::array<double, 2>>& readings) {
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const auto at = Clock::Instant{} + static_cast<int>(i) * 1s;
    if (watch.add(readings[i], at)) return static_cast<int>(i);
  }
  return -1;
}

TEST(StillnessWatch, ComplainsOnceAllValuesHaveStoodStillForTooLong) {
  const StillnessWatch watch(config::Seconds{3.0});
  EXPECT_EQ(complains_at(watch, {{1, 2}, {1, 3}, {1, 3}, {1, 3}, {1, 3}, {1, 3}}), 4);
}

TEST(StillnessWatch, OneValueThatMovesIsEnough) {
  const StillnessWatch watch(config::Seconds{2.0});
  EXPECT_EQ(complains_at(watch, {{1, 2}, {1, 3}, {1, 2}, {1, 3}, {1, 2}, {1, 3}}), -1);
}

TEST(StillnessWatch, TwoEqualReadingsFarApartProveNothing) {
  StillnessWatch watch(config::Seconds{2.0});
  const std::array<double, 1> same{5.0};
  EXPECT_FALSE(watch.add(same, Clock::Instant{}));
  EXPECT_FALSE(watch.add(same, Clock::Instant{} + 1h));
  const auto still = watch.add(same, Clock::Instant{} + 2h);
  ASSERT_TRUE(still);
  EXPECT_EQ(still->count(), 7200.0);
}

TEST(StillnessWatch, WithoutATimeAnythingMayStandStill) {
  EXPECT_EQ(complains_at(StillnessWatch(std::nullopt), {{1, 2}, {1, 2}, {1, 2}, {1, 2}}), -1);
}

}  // namespace
}  // namespace fogbench::drivers
