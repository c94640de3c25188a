#include "model/table/row_order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "model/table/median.hpp"

namespace fogbench::model {
namespace {

using Rows = std::vector<std::size_t>;

/// Stamps out of order in more than this share of a run's rows: the rows are shuffled, or the clock
/// is no clock.
constexpr double kMostOutOfOrder = 0.05;
constexpr std::size_t kMostRowsNamed = 3;

std::string row_in_words(std::size_t row) {
  return fmt::format("row {} of the data", row + 1);
}

/// The table's run indices in the order of the runs' names.
std::vector<std::uint32_t> runs_by_name(const TextColumn& run) {
  std::vector<std::uint32_t> sorted(run.values.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::string &s = run.values[a], &t = run.values[b];
    return std::pair(s.size(), s) < std::pair(t.size(), t);
  });
  return sorted;
}

/// Which of the values form the longest strictly increasing sequence.
std::vector<bool> longest_rise(const std::vector<double>& values) {
  constexpr auto kNone = static_cast<std::size_t>(-1);
  Rows tail;  // tail[k]: the smallest end of a sequence of k + 1 values
  Rows before(values.size(), kNone);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    const auto at = std::lower_bound(tail.begin(), tail.end(), values[i],
                                     [&](std::size_t t, double v) { return values[t] < v; });
    if (at != tail.begin()) before[i] = *std::prev(at);
    if (at == tail.end()) {
      tail.push_back(i);
    } else {
      *at = i;
    }
  }
  std::vector<bool> out(values.size(), false);
  for (std::size_t i = tail.empty() ? kNone : tail.back(); i != kNone; i = before[i]) out[i] = true;
  return out;
}

/// Puts numbers in place of those that are not `good`: evenly between the good ones around them,
/// by the usual step at the ends. Precondition: at least two are good.
void interpolate(std::vector<double>& values, const std::vector<bool>& good) {
  Rows places;
  for (std::size_t i = 0; i < good.size(); ++i) {
    if (good[i]) places.push_back(i);
  }
  const double mean_step = (values[places.back()] - values[places.front()]) /
                           static_cast<double>(places.back() - places.front());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (good[i]) continue;
    const auto after = std::upper_bound(places.begin(), places.end(), i);
    if (after == places.begin()) {
      values[i] = values[places.front()] - mean_step * static_cast<double>(places.front() - i);
    } else if (after == places.end()) {
      values[i] = values[places.back()] + mean_step * static_cast<double>(i - places.back());
    } else {
      const std::size_t a = *std::prev(after), b = *after;
      values[i] = values[a] +
                  (values[b] - values[a]) * static_cast<double>(i - a) / static_cast<double>(b - a);
    }
  }
}

/// One run's rows, as they stand in the table.
class RunRows {
 public:
  RunRows(const Table& table, const std::string& observable, Rows rows) : rows_(std::move(rows)) {
    const auto time = table.column("time_s");
    for (const std::size_t row : rows_) time_.push_back(time[row]);
    drop_repeats(table.has(observable) ? table.column(observable) : std::span<const double>());
  }

  void put_in_order(RowOrder& out) {
    std::vector<bool> rises = longest_rise(time_);
    choose_of_repeated(rises);
    const auto in_order = static_cast<std::size_t>(std::count(rises.begin(), rises.end(), true));
    const auto blank = static_cast<std::size_t>(
        std::count_if(time_.begin(), time_.end(), [](double t) { return std::isnan(t); }));
    const std::size_t wrong = rows_.size() - in_order - blank;
    if (in_order >= 2 && is_few(wrong) && 2 * blank <= rows_.size()) {
      const std::vector<double> stated = time_;
      std::vector<bool> good = moved(rises);
      interpolate(time_, rises);
      for (std::size_t i = 0; i < good.size(); ++i) {
        if (good[i]) time_[i] = stated[i];
        good[i] = good[i] || rises[i];
      }
      tell(good, stated, out);
      rearrange(by_time());
    } else {
      sort(out);
    }
    out.rows.insert(out.rows.end(), rows_.begin(), rows_.end());
    out.time_s.insert(out.time_s.end(), time_.begin(), time_.end());
  }

 private:
  bool is_few(std::size_t count) const {
    return static_cast<double>(count) <=
           std::max(1.0, kMostOutOfOrder * static_cast<double>(rows_.size()));
  }

  void drop_repeats(std::span<const double> value) {
    if (value.empty()) return;
    Rows places(rows_.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    const auto key = [&](std::size_t i) { return std::tuple(time_[i], value[rows_[i]], i); };
    std::erase_if(
        places, [&](std::size_t i) { return std::isnan(time_[i]) || std::isnan(value[rows_[i]]); });
    std::sort(places.begin(), places.end(),
              [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    std::vector<bool> repeated(rows_.size(), false);
    for (std::size_t k = 1; k < places.size(); ++k) {
      const std::size_t a = places[k - 1], b = places[k];
      repeated[b] = time_[a] == time_[b] && value[rows_[a]] == value[rows_[b]];
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (repeated[i]) continue;
      rows_[kept] = rows_[i];
      time_[kept++] = time_[i];
    }
    rows_.resize(kept);
    time_.resize(kept);
  }

  /// Of two neighbours with one stamp, the one that is beside the larger gap is to be moved.
  void choose_of_repeated(std::vector<bool>& rises) const {
    for (std::size_t i = 1; i + 2 < rises.size(); ++i) {
      if (rises[i] || !rises[i + 1] || time_[i] != time_[i + 1]) continue;
      if (!rises[i - 1] || !rises[i + 2]) continue;
      if (time_[i + 2] - time_[i] <= time_[i] - time_[i - 1]) continue;
      rises[i] = true;
      rises[i + 1] = false;
    }
  }

  /// Rows that stand in the wrong place but whose stamps find room between those of the others.
  std::vector<bool> moved(const std::vector<bool>& rises) const {
    constexpr double kRoom = 0.75;  // of the usual step, on both sides
    std::vector<double> stamps, steps;
    for (std::size_t i = 0; i < rises.size(); ++i) {
      if (!rises[i]) continue;
      if (!stamps.empty()) steps.push_back(time_[i] - stamps.back());
      stamps.push_back(time_[i]);
    }
    const double room = kRoom * median(std::move(steps));
    std::vector<bool> out(rises.size(), false);
    for (std::size_t i = 0; i < rises.size(); ++i) {
      if (rises[i] || std::isnan(time_[i])) continue;
      const auto after = std::upper_bound(stamps.begin(), stamps.end(), time_[i]);
      out[i] = after != stamps.begin() && after != stamps.end() && *after - time_[i] >= room &&
               time_[i] - *std::prev(after) >= room;
    }
    return out;
  }

  Rows by_time() const {
    Rows places(rows_.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    const auto before = [&](std::size_t a, std::size_t b) { return time_[a] < time_[b]; };
    if (!std::is_sorted(places.begin(), places.end(), before)) {
      std::stable_sort(places.begin(), places.end(), before);
    }
    return places;
  }

  void rearrange(const Rows& places) {
    Rows rows;
    std::vector<double> time;
    for (const std::size_t i : places) {
      rows.push_back(rows_[i]);
      time.push_back(time_[i]);
    }
    rows_ = std::move(rows);
    time_ = std::move(time);
  }

  void tell(const std::vector<bool>& good, const std::vector<double>& stated, RowOrder& out) const {
    std::vector<std::string> wrong;
    std::size_t blank = 0, count = 0;
    for (std::size_t i = 0; i < good.size(); ++i) {
      if (good[i]) continue;
      if (std::isnan(stated[i])) {
        ++blank;
      } else if (++count <= kMostRowsNamed) {
        wrong.push_back(fmt::format("{} (time_s {:.10g}, taken as {:.10g})", row_in_words(rows_[i]),
                                    stated[i], time_[i]));
      }
    }
    if (count > 0) {
      out.notes.push_back(
          fmt::format("A time stamp is repeated or steps back: {}{}.", fmt::join(wrong, ", "),
                      count > kMostRowsNamed ? fmt::format(" and {} more", count - kMostRowsNamed)
                                             : std::string()));
    }
    if (blank > 0) {
      out.notes.push_back(fmt::format("time_s is blank in {} row{}: taken from the rows around.",
                                      blank, blank > 1 ? "s" : ""));
    }
  }

  /// Shuffled rows. A row without a stamp follows the one that stands before it; of rows with one
  /// stamp the first counts.
  void sort(RowOrder& out) {
    for (std::size_t i = 0; i < time_.size(); ++i) {
      if (std::isnan(time_[i])) time_[i] = i > 0 ? time_[i - 1] : 0.0;
    }
    Rows places = by_time();
    Rows kept, left_out;
    for (const std::size_t i : places) {
      const bool again = !kept.empty() && time_[kept.back()] == time_[i];
      (again ? left_out : kept).push_back(i);
    }
    if (!left_out.empty() && !is_few(left_out.size())) {
      out.time_advances = false;
    } else if (!left_out.empty()) {
      std::vector<std::string> names;
      for (const std::size_t i : left_out) names.push_back(row_in_words(rows_[i]));
      if (names.size() > kMostRowsNamed) names.resize(kMostRowsNamed);
      out.notes.push_back(
          fmt::format("{} of {} rows repeat the time stamp of another one and are "
                      "left out ({}{}).",
                      left_out.size(), rows_.size(), fmt::join(names, ", "),
                      left_out.size() > names.size() ? ", ..." : ""));
      places = kept;
    }
    rearrange(places);
  }

  Rows rows_;
  std::vector<double> time_;
};

/// Of each run in the order of names, its rows as they stand.
std::vector<Rows> rows_of_runs(const Table& table) {
  const std::vector<std::uint32_t> runs = runs_by_name(table.run());
  Rows rank(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) rank[runs[i]] = i;
  std::vector<Rows> out(runs.size());
  for (std::size_t row = 0; row < table.rows(); ++row) {
    out[rank[table.run().index[row]]].push_back(row);
  }
  return out;
}

}  // namespace

bool has_calendar_time(const Signals& signals) {
  if (!signals.available("time_since_power_on_s")) return false;
  const auto time = signals.signal("time_s").array();
  return (signals.signal("time_since_power_on_s").array() < time).any();
}

RowOrder row_order(const Table& table, const std::string& observable) {
  RowOrder out;
  const bool timed = table.has("time_s");
  for (Rows& rows : rows_of_runs(table)) {
    if (rows.empty()) continue;
    if (timed) {
      RunRows(table, observable, std::move(rows)).put_in_order(out);
    } else {
      out.rows.insert(out.rows.end(), rows.begin(), rows.end());
    }
  }
  return out;
}

std::vector<std::string> mend_stamps(Table& table, const std::string& observable) {
  if (!table.has("time_s")) return {};
  RowOrder order = row_order(table, observable);
  if (order.notes.empty() || !order.time_advances) return {};
  const auto stated = table.column("time_s");
  std::vector<double> time(stated.begin(), stated.end());
  for (std::size_t i = 0; i < order.rows.size(); ++i) time[order.rows[i]] = order.time_s[i];
  table.set_column("time_s", std::move(time));
  return std::move(order.notes);
}

}  // namespace fogbench::model
