#include "model/diagnose/thermometer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/verdict_text.hpp"
#include "tests/model/models.hpp"

namespace fogbench::model {
namespace {

/// Up and down again within an hour, a row every 20 s.
std::vector<double> heating_and_cooling() {
  std::vector<double> out;
  for (int i = 0; i < 180; ++i) out.push_back(20.3 + 0.11 * (i < 110 ? i : 220 - i));
  return out;
}

std::vector<double> in_steps(std::vector<double> values, double step) {
  for (double& v : values) v = step * std::round(v / step);
  return values;
}

std::vector<double> every(double step_s, std::size_t rows) {
  std::vector<double> out;
  for (std::size_t i = 0; i < rows; ++i) out.push_back(step_s * static_cast<double>(i));
  return out;
}

TEST(Thermometer, FindsTheStepOfItsReadings) {
  EXPECT_EQ(resolution_of(in_steps(heating_and_cooling(), 1.0)), 1.0);
  EXPECT_EQ(resolution_of(in_steps(heating_and_cooling(), 0.5)), 0.5);
  EXPECT_EQ(resolution_of(in_steps(heating_and_cooling(), 0.1)), 0.1);
  EXPECT_EQ(resolution_of(heating_and_cooling()), 0.0);
}

TEST(Thermometer, SetPointsInWholeDegreesAreNoSteps) {
  EXPECT_EQ(resolution_of(std::vector<double>{20, 20, 30, 30, 40, 40, 50, 50, 40, 30, 20}), 0.0);
}

TEST(Thermometer, TheTemperatureThatPassesThroughTheStepsIsFarCloserThanTheReadings) {
  const std::vector<double> truth = heating_and_cooling(), read = in_steps(truth, 1.0);
  const auto smooth = through_the_steps(read, every(20.0, truth.size()), {{0, truth.size()}}, 1.0);
  double of_readings = 0.0, of_smooth = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    of_readings += std::pow(read[i] - truth[i], 2);
    of_smooth += std::pow(smooth[i] - truth[i], 2);
    EXPECT_LE(std::abs(smooth[i] - read[i]), 0.5);
  }
  EXPECT_LT(of_smooth, 0.1 * of_readings);
}

TEST(Thermometer, AStuckSensorIsBridgedAndSaid) {
  std::vector<double> read = heating_and_cooling();
  for (std::size_t i = 40; i < 70; ++i) read[i] = read[40];
  Table table;
  table.set_column("time_s", every(20.0, read.size()));
  table.set_column("temperature_c", read);
  const MendedTemperature mended = mend_temperature(table);
  ASSERT_EQ(mended.notes.size(), 1U);
  EXPECT_NE(mended.notes[0].find("30 rows"), std::string::npos) << mended.notes[0];
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(table.column("temperature_c")[i], heating_and_cooling()[i], 1e-9);
  }
}

TEST(Thermometer, APlateauThatBeginsARampIsNotStuck) {
  std::vector<double> read(30, 20.0);
  for (int i = 0; i < 60; ++i) read.push_back(20.0537 + 0.0513 * i);
  Table table;
  table.set_column("time_s", every(20.0, read.size()));
  table.set_column("temperature_c", read);
  EXPECT_TRUE(mend_temperature(table).notes.empty());
}

/// A gyro that follows the temperature, and a thermometer that reads it in whole degrees.
TEST(Thermometer, ReadingsInWholeDegreesAreNoErrorOfTheGyro) {
  const std::vector<double> truth = heating_and_cooling();
  std::vector<double> rate;
  std::uint32_t state = 99;
  for (const double t : truth) {
    state = state * 1664525u + 1013904223u;
    rate.push_back(0.5 + 0.05 * t + 0.004 * (static_cast<double>(state >> 8) / (1u << 24) - 0.5));
  }
  Table table;
  table.set_column("time_s", every(20.0, truth.size()));
  table.set_column("duration_s", std::vector<double>(truth.size(), 20.0));
  table.set_column("temperature_c", in_steps(truth, 1.0));
  table.set_column("rate_deg_per_h", rate);
  const auto found = diagnose(table, model_of_effects({"bias", "temperature_linear"}), {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(name_of(found->verdict), "adequate") << verdict_in_words(*found, "").verdict;
  EXPECT_TRUE(found->missing.empty());
  ASSERT_FALSE(found->notes.empty());
  EXPECT_NE(found->notes.front().find("steps of 1 degC"), std::string::npos);
}

}  // namespace
}  // namespace fogbench::model
