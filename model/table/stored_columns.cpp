#include "model/table/stored_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "model/table/condense.hpp"
#include "model/table/read_text.hpp"
#include "model/table/text_fields.hpp"
#include "model/table/time_axis.hpp"

namespace fogbench::model {
namespace {

TextColumn text_column(const StoredColumn& column) {
  TextColumn out;
  std::map<std::string, std::uint32_t> places;
  for (std::size_t row = 0; row < column.rows(); ++row) {
    const std::string text =
        column.texts.empty() ? fmt::format("{}", column.values[row]) : column.texts[row];
    const auto [place, is_new] =
        places.try_emplace(text, static_cast<std::uint32_t>(out.values.size()));
    if (is_new) out.values.push_back(text);
    out.index.push_back(place->second);
  }
  return out;
}

/// Stamps, and numbers that were stored as text.
Status take_texts(StoredColumn& column, bool is_time, TextStamps& stamps) {
  for (const std::string& text : column.texts) {
    std::optional<double> value = to_number(text);
    if (!value && is_time) value = stamps.take(text, SlashDate::kUnknown);
    if (!value) {
      return Error{ErrorCode::kBadInput, fmt::format("column {}: found {}, expected numbers",
                                                     column.source.name, shown(text))};
    }
    column.values.push_back(*value);
  }
  column.texts.clear();
  return {};
}

/// Neighbours of one run and segment averaged, until there are at most `most` rows or nearly.
Table averaged(const Table& table, std::size_t most) {
  const std::size_t at_once = (table.rows() + most - 1) / most;
  const std::vector<std::uint32_t> counts(table.rows(), 1);
  const auto groups = neighbours(table.run().index, table.segment().index, counts, at_once);
  Table out;
  for (const std::string& name : table.column_names()) {
    out.set_column(name, condensed(name, table.column(name), {}, groups));
  }
  const auto kept = [&](const TextColumn& column) {
    TextColumn first{column.values, {}};
    for (const RowGroup& group : groups) first.index.push_back(column.index[group.begin]);
    return first;
  };
  out.set_run(kept(table.run()));
  out.set_run_word(table.run_word());
  out.set_segment(kept(table.segment()));
  out.set_rows_averaged(at_once);
  return out;
}

}  // namespace

Result<Table> table_of(const std::filesystem::path& file, StoredColumns stored,
                       const ReadOptions& options) {
  const auto bad = [&](std::string_view what) {
    return Error{ErrorCode::kBadInput, fmt::format("{}: {}", file.string(), what)};
  };
  if (stored.columns.empty() || stored.columns.front().rows() == 0) {
    return bad("found no rows, expected columns of measurements");
  }
  if (stored.columns.size() > kMostColumns) {
    return bad(
        fmt::format("found {} columns, expected at most {}", stored.columns.size(), kMostColumns));
  }
  std::vector<SourceColumn> source;
  for (const StoredColumn& column : stored.columns) {
    if (has_control_characters(column.source.name)) {
      return bad(
          fmt::format("found a column {}, expected printable names", shown(column.source.name)));
    }
    source.push_back(column.source);
  }
  auto choice = choose_columns(source, options);
  if (!choice) {
    return choice.error().code == ErrorCode::kUsage ? choice.error() : bad(choice.error().message);
  }
  Table table;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const ChosenColumn& chosen = choice->columns[i];
    StoredColumn& column = stored.columns[i];
    if (chosen.name.empty()) continue;
    if (chosen.name == "run") {
      table.set_run(text_column(column));
      continue;
    }
    if (chosen.name == "segment") {
      table.set_segment(text_column(column));
      continue;
    }
    const bool is_time = chosen.name == "time_s";
    TextStamps stamps;
    if (const Status taken = take_texts(column, is_time, stamps); !taken) {
      if (chosen.house != nullptr) return bad(taken.error().message);
      table.set_dropped(chosen.name, bad(taken.error().message).message);
      continue;
    }
    if (!is_time) {
      convert(chosen, column.values);
    } else {
      const auto said =
          stamps.any() ? stamps.settle(column.values) : settle_counter(chosen, {}, column.values);
      if (!said) return bad(said.error().message);
      choice->says.insert(choice->says.end(), said->begin(), said->end());
    }
    for (double& value : column.values) {
      if (std::isinf(value)) value = kMissing;
    }
    table.set_column(chosen.name, std::move(column.values));
  }
  for (const auto& [wanted, because] : choice->undecided) {
    table.set_dropped(wanted, bad(because).message);
  }
  if (table.rows() > options.most_rows) table = averaged(table, options.most_rows);
  std::vector<std::string> parts{stored.how};
  parts.insert(parts.end(), choice->says.begin(), choice->says.end());
  table.add_provenance(fmt::format("{}", fmt::join(parts, "; ")));
  return table;
}

}  // namespace fogbench::model
