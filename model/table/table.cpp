#include "model/table/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cassert>
#include <limits>
#include <utility>

namespace fogbench::model {
namespace {

TextColumn selected(const TextColumn& column, const std::vector<bool>& keep) {
  TextColumn result{column.values, {}};
  for (std::size_t row = 0; row < keep.size(); ++row) {
    if (keep[row]) result.index.push_back(column.index[row]);
  }
  return result;
}

void append_text(TextColumn& column, const TextColumn& other) {
  std::vector<std::uint32_t> place;
  for (const std::string& value : other.values) {
    std::size_t at = 0;
    while (at < column.values.size() && column.values[at] != value) ++at;
    if (at == column.values.size()) column.values.push_back(value);
    place.push_back(static_cast<std::uint32_t>(at));
  }
  column.index.reserve(column.index.size() + other.index.size());
  for (const std::uint32_t index : other.index) column.index.push_back(place[index]);
}

}  // namespace

bool Table::has(std::string_view name) const {
  return columns_.find(name) != columns_.end();
}

std::span<const double> Table::column(std::string_view name) const {
  const auto found = columns_.find(name);
  assert(found != columns_.end());
  return found->second;
}

std::vector<std::string> Table::column_names() const {
  std::vector<std::string> names;
  for (const auto& [name, values] : columns_) names.push_back(name);
  return names;
}

std::string Table::why_missing(std::string_view name) const {
  const auto found = dropped_.find(name);
  if (found != dropped_.end()) return found->second;
  if (has(name)) return fmt::format("column {}: found no number in any row, expected some", name);
  return fmt::format("column {}: found only {}, expected it among the columns", name,
                     fmt::join(column_names(), ", "));
}

void Table::set_rows(std::size_t rows) {
  if (rows_ == rows) return;
  assert(rows_ == 0);
  rows_ = rows;
  if (run_.index.empty()) run_ = {{"1"}, std::vector<std::uint32_t>(rows, 0)};
  if (segment_.index.empty()) segment_ = {{""}, std::vector<std::uint32_t>(rows, 0)};
}

void Table::set_column(std::string name, std::vector<double> values) {
  set_rows(values.size());
  columns_.insert_or_assign(std::move(name), std::move(values));
}

void Table::set_run(TextColumn run) {
  set_rows(run.index.size());
  run_ = std::move(run);
}

void Table::set_segment(TextColumn segment) {
  set_rows(segment.index.size());
  segment_ = std::move(segment);
}

void Table::set_dropped(std::string name, std::string because) {
  columns_.erase(name);
  dropped_.insert_or_assign(std::move(name), std::move(because));
}

Table Table::select(const std::vector<bool>& keep) const {
  assert(keep.size() == rows_);
  Table result;
  result.dropped_ = dropped_;
  result.provenance_ = provenance_;
  result.run_ = selected(run_, keep);
  result.run_word_ = run_word_;
  result.segment_ = selected(segment_, keep);
  result.rows_ = result.run_.index.size();
  for (const auto& [name, values] : columns_) {
    std::vector<double>& kept = result.columns_[name];
    kept.reserve(result.rows_);
    for (std::size_t row = 0; row < rows_; ++row) {
      if (keep[row]) kept.push_back(values[row]);
    }
  }
  return result;
}

void Table::append(const Table& other) {
  if (rows_ == 0) {
    *this = other;
    return;
  }
  append_text(run_, other.run_);
  if (other.run_word_ != run_word_) run_word_ = "run";
  append_text(segment_, other.segment_);
  for (const auto& [name, values] : other.columns_) {
    columns_.try_emplace(name, std::vector<double>(rows_, kMissing));
  }
  rows_ += other.rows_;
  for (auto& [name, values] : columns_) {
    const auto found = other.columns_.find(name);
    if (found == other.columns_.end()) {
      values.resize(rows_, kMissing);
    } else {
      values.insert(values.end(), found->second.begin(), found->second.end());
    }
  }
  provenance_.insert(provenance_.end(), other.provenance_.begin(), other.provenance_.end());
  for (const auto& [name, because] : other.dropped_) dropped_.try_emplace(name, because);
}

}  // namespace fogbench::model
