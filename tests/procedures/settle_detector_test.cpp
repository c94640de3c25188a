#include "procedures/settle_detector.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

namespace fogbench::procedures {
namespace {

constexpr SettleDetector::Criteria kCriteria{0.1, 60.0, 1.0};

/// When the detector first says settled, one reading a second; -1 when it never does in an hour.
int settled_after(SettleDetector& detector, const std::function<double(int)>& temperature_c) {
  for (int t = 0; t <= 3600; ++t) {
    if (detector.add(t, temperature_c(t), 31.0)) return t;
  }
  return -1;
}

TEST(SettleDetector, NeedsTheWholeDwellInsideTheBand) {
  SettleDetector detector(kCriteria);
  EXPECT_EQ(settled_after(detector, [](int t) { return t < 100 ? 30.0 : 31.05; }), 160);
}

TEST(SettleDetector, AnExcursionStartsTheDwellAnew) {
  SettleDetector detector(kCriteria);
  EXPECT_EQ(settled_after(detector, [](int t) { return t == 50 ? 31.2 : 31.0; }), 111);
  const auto evidence = nlohmann::json::parse(detector.evidence_json());
  EXPECT_EQ(evidence["dwells_broken_off"], 1);
}

TEST(SettleDetector, ASlopeTooSteepHoldsItBack) {
  SettleDetector steep(kCriteria);
  // 2 degC/h stays in the band for six minutes.
  EXPECT_EQ(settled_after(steep, [](int t) { return 30.9 + 2.0 * t / 3600.0; }), -1);
  SettleDetector gentle(kCriteria);
  EXPECT_EQ(settled_after(gentle, [](int t) { return 30.95 + 0.9 * t / 3600.0; }), 60);
}

TEST(SettleDetector, WaitsOutASlopeThatFlattens) {
  SettleDetector detector(kCriteria);
  const int settled =
      settled_after(detector, [](int t) { return 31.0 - 0.099 * std::exp(-t / 300.0); });
  // 0.099/300 s is 1.19 degC/h at the start; the mean slope over the last 60 s passes 1.0 soon.
  EXPECT_GT(settled, 60);
  EXPECT_LT(settled, 120);
}

TEST(SettleDetector, AHoleInTheReadingsStartsTheDwellAnew) {
  SettleDetector detector(kCriteria);
  for (int t = 0; t <= 50; ++t) EXPECT_FALSE(detector.add(t, 31.0, 31.0));
  for (int t = 65; t < 125; ++t) EXPECT_FALSE(detector.add(t, 31.0, 31.0)) << t;
  EXPECT_TRUE(detector.add(125, 31.0, 31.0));
}

TEST(SettleDetector, WithoutADwellTheBandIsEnough) {
  SettleDetector detector({2.5, 0.0, 1.0});
  EXPECT_FALSE(detector.add(0.0, 28.0, 31.0));
  EXPECT_TRUE(detector.add(1.0, 28.6, 31.0));
}

TEST(SettleDetector, LeavesTheBandAgain) {
  SettleDetector detector(kCriteria);
  EXPECT_EQ(settled_after(detector, [](int) { return 31.0; }), 60);
  EXPECT_FALSE(detector.add(61.0, 31.2, 31.0));
  EXPECT_FALSE(detector.settled());
}

TEST(SettleDetector, EvidenceIsJsonEvenBeforeTheFirstReading) {
  const SettleDetector detector(kCriteria);
  const auto evidence = nlohmann::json::parse(detector.evidence_json());
  EXPECT_FALSE(evidence["settled"].get<bool>());
  EXPECT_TRUE(evidence["mean_c"].is_null());
  EXPECT_EQ(detector.describe(), "the thermostat gave no reading");
}

}  // namespace
}  // namespace fogbench::procedures
