#include "model/table/doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/table/median.hpp"
#include "model/table/steps_of_time.hpp"

namespace fogbench::model {
namespace {

constexpr double kEarthRateDegPerH = 15.041067;  // IERS conventions: 7.292115e-5 rad/s
constexpr double kSecondsInHour = 3600.0;
constexpr double kZeroCelsiusK = 273.15;
/// Values that a median is taken of.
constexpr std::size_t kValuesLookedAt = 100'000;
/// Fewer stamps out of order are mended and said where the table is used.
constexpr double kShareMended = 0.05;

struct Values {
  double middle = kMissing, least = kMissing, most = kMissing;
  double span() const { return most - least; }
};

/// Of a column, or of its absolute values.
Values values_of(const Table& table, const char* name, bool absolute) {
  Values out;
  if (!table.has(name)) return out;
  const auto column = table.column(name);
  std::vector<double> some;
  const std::size_t every = column.size() / kValuesLookedAt + 1;
  for (std::size_t row = 0; row < column.size(); ++row) {
    const double value = absolute ? std::abs(column[row]) : column[row];
    if (std::isnan(value)) continue;
    out.least = std::isnan(out.least) ? value : std::min(out.least, value);
    out.most = std::isnan(out.most) ? value : std::max(out.most, value);
    if (row % every == 0) some.push_back(value);
  }
  out.middle = median(std::move(some));
  return out;
}

void doubt_time(const Table& table, std::vector<std::string>& out) {
  if (!table.has("time_s")) return;
  const StepsOfTime steps = steps_of_time(table);
  for (const TimeFall& restart : steps.restarts) {
    out.push_back(
        fmt::format("time_s falls back from {:.10g} to {:.10g} s at row {}: the logger began anew "
                    "there, or its "
                    "counter wrapped; rows of another start need another run (a column run)",
                    restart.from_s, restart.to_s, restart.row + 1));
  }
  const auto rows = static_cast<double>(table.rows());
  const auto many = [&](std::size_t count) {
    return count > 1 && static_cast<double>(count) > kShareMended * rows;
  };
  if (many(steps.backwards - steps.restarts.size())) {
    out.push_back(fmt::format(
        "time_s runs backwards at {} of {} rows, first at row {}: rows were shuffled, files joined "
        "in the wrong order, or the clock was set",
        steps.backwards, table.rows(), steps.first_backwards + 1));
  }
  if (many(steps.repeated)) {
    out.push_back(fmt::format(
        "time_s repeats in {} of {} rows, first at row {}: the stamps are coarser than the rows, "
        "or rows were written twice",
        steps.repeated, table.rows(), steps.first_repeated + 1));
  }
}

void doubt_temperature(const Table& table, std::vector<std::string>& out) {
  constexpr double kMostSpanC = 150.0, kLeastC = -90.0, kMostC = 200.0;
  for (const char* const name : {"temperature_c", "ambient_c"}) {
    const Values t = values_of(table, name, false);
    if (!(t.span() > kMostSpanC) && !(t.least < kLeastC) && !(t.most > kMostC)) continue;
    const auto near = [](double value, double to) { return std::abs(value - to) < 0.5; };
    const char* cause = "another unit, or a broken sensor";
    if (near(t.least, 0.0) || near(t.least, -kZeroCelsiusK)) {
      cause = "a sensor that reads 0 where it has no value";
    } else if (t.least > 200.0 && t.most < 400.0) {
      cause = "numbers in K";
    } else if (t.most < kLeastC) {
      cause = "numbers in degC taken for K";
    } else if (std::abs(t.middle) > 1000.0) {
      cause = "numbers in mdegC";
    }
    out.push_back(fmt::format("{} goes from {:.4g} to {:.4g} degC: probably {} (--unit says which)",
                              name, t.least, t.most, cause));
  }
}

void doubt_rate(const Table& table, std::vector<std::string>& out) {
  const Values rate = values_of(table, "rate_deg_per_h", true);
  // A bench's gyro sees a part of the Earth's rate.
  const double largest = 1.1 * kEarthRateDegPerH * kSecondsInHour;
  constexpr double kLeastPart = 0.05;
  if (rate.middle > kLeastPart * kEarthRateDegPerH * kSecondsInHour && rate.middle < largest) {
    out.push_back(fmt::format(
        "rate_deg_per_h is about {:.4g}, 3600 times {:.3g}: perhaps numbers in deg/h that were "
        "taken for deg/s, as the Earth's rate is 15.04 deg/h (--unit says which)",
        rate.middle, rate.middle / kSecondsInHour));
  }
}

void doubt_field(const Table& table, std::vector<std::string>& out) {
  constexpr double kMostUt = 2000.0;
  for (const char* const name : {"field_x_ut", "field_y_ut", "field_z_ut"}) {
    const Values field = values_of(table, name, true);
    if (!(field.middle > kMostUt)) continue;
    out.push_back(fmt::format("{} is about {:.4g} uT: probably numbers in nT (--unit says which)",
                              name, field.middle));
  }
}

}  // namespace

std::vector<std::string> doubts(const Table& table) {
  std::vector<std::string> out;
  doubt_time(table, out);
  doubt_temperature(table, out);
  doubt_rate(table, out);
  doubt_field(table, out);
  return out;
}

}  // namespace fogbench::model
