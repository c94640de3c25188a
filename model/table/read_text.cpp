#include "model/table/read_text.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "config/channels.hpp"
#include "model/table/choose_columns.hpp"
#include "model/table/condense.hpp"
#include "model/table/dialect.hpp"
#include "model/table/line_reader.hpp"
#include "model/table/text_fields.hpp"
#include "model/table/text_source.hpp"
#include "model/table/time_axis.hpp"

namespace fogbench::model {
namespace {

class TextBuilder {
 public:
  void add(const std::string& text) {
    const auto [place, is_new] =
        places_.try_emplace(text, static_cast<std::uint32_t>(column_.values.size()));
    if (is_new) column_.values.push_back(text);
    column_.index.push_back(place->second);
  }
  const std::vector<std::uint32_t>& index() const { return column_.index; }
  void keep_first(const std::vector<RowGroup>& groups) {
    if (column_.index.empty()) return;
    for (std::size_t i = 0; i < groups.size(); ++i)
      column_.index[i] = column_.index[groups[i].begin];
    column_.index.resize(groups.size());
  }
  TextColumn take() { return std::move(column_); }

 private:
  TextColumn column_;
  std::unordered_map<std::string, std::uint32_t> places_;
};

class TextReader {
 public:
  TextReader(const std::filesystem::path& file, const ReadOptions& options)
      : file_(file), options_(options), most_rows_(options.most_rows) {}

  /// Rows were averaged although a later one shows that they are not in the order of time.
  bool averaged_in_vain() const { return rows_averaged_ > 1 && out_of_order_; }

  Result<Table> read(OpenedBytes opened) {
    // An archive's table is some times larger than its file.
    size_ = opened.archive.empty() ? opened.file_bytes : 0;
    if (!opened.archive.empty()) says_.push_back(opened.archive);
    auto text = open_text(std::move(opened.bytes));
    if (!text) return bad(text.error().message);
    if (!text->encoding.empty()) says_.push_back(text->encoding);
    lines_.emplace(std::move(text->text));
    if (Status known = recognise_dialect(); !known) return known.error();
    if (Status named = name_columns(); !named) return named.error();
    if (Status rows = read_rows(); !rows) return rows.error();
    return build();
  }

 private:
  enum class Kind { kNumber, kTime, kOther, kRun, kSegment, kIgnored };
  struct Column {
    std::string name;  ///< in the table
    Kind kind = Kind::kOther;
    std::vector<double> values;
    std::string dropped;
  };

  Error bad(std::string_view what) const {
    return {ErrorCode::kBadInput, fmt::format("{}: {}", file_.string(), what)};
  }
  Error bad_line(std::string_view what) const {
    return {ErrorCode::kBadInput, fmt::format("{}:{}: {}", file_.string(), line_number_, what)};
  }

  /// False at the end of the file.
  Result<bool> next_line(std::string_view& line) {
    const auto outcome = lines_->next(line);
    if (!outcome) {
      ++line_number_;
      return bad_line(outcome.error().message);
    }
    if (*outcome == LineReader::Outcome::kEnd) return false;
    ++line_number_;
    if (*outcome == LineReader::Outcome::kTooLong) {
      return bad_line("found a line longer than 1 MiB, expected a table's");
    }
    return true;
  }

  Status recognise_dialect() {
    auto head = lines_->peek(kLookedAt);
    if (head && head->find('\n') == std::string_view::npos) {
      head = lines_->peek(LineReader::kMaximumLine);
    }
    if (!head) return bad(head.error().message);
    auto dialect = recognise(*head, lines_->finished() && head->size() < kLookedAt);
    if (!dialect) return bad(dialect.error().message);
    dialect_ = std::move(*dialect);
    if (const std::string says = dialect_.says(); !says.empty()) says_.push_back(says);
    return {};
  }

  /// Goes through the lines before the first row.
  Status name_columns() {
    std::string_view line;
    for (std::size_t i = 0; i < dialect_.lines_before; ++i) {
      const Result<bool> more = next_line(line);
      if (!more) return more.error();
      if (!*more) break;
    }
    line_number_ = std::max<std::size_t>(dialect_.names_line, 1);
    std::vector<SourceColumn> source;
    for (std::size_t i = 0; i < dialect_.names.size(); ++i) {
      if (has_control_characters(dialect_.names[i])) {
        return bad_line(fmt::format("found {}, expected column names (is this a text file?)",
                                    shown(dialect_.names[i])));
      }
      source.push_back({dialect_.names[i], dialect_.units.empty() ? "" : dialect_.units[i]});
    }
    if (source.empty()) {
      return bad("found an empty file, expected a line of column names");
    }
    if (source.size() > kMostColumns) {
      return bad_line(
          fmt::format("found {} columns, expected at most {}", source.size(), kMostColumns));
    }
    auto choice = choose_columns(source, options_);
    if (!choice) {
      if (choice.error().code == ErrorCode::kUsage) return choice.error();
      return bad_line(choice.error().message);
    }
    choice_ = std::move(*choice);
    for (const ChosenColumn& chosen : choice_.columns) {
      columns_.push_back({chosen.name, kind_of(chosen.name), {}, {}});
    }
    tests_are_runs();
    line_number_ = dialect_.lines_before;
    return {};
  }

  /// The tests of one run stand apart as runs do.
  void tests_are_runs() {
    const auto named = [this](const char* name) {
      return std::find_if(columns_.begin(), columns_.end(),
                          [name](const Column& column) { return column.name == name; });
    };
    const auto test = named("test");
    if (test != columns_.end() && named("run") == columns_.end()) test->kind = Kind::kRun;
  }

  static Kind kind_of(const std::string& name) {
    if (name.empty()) return Kind::kIgnored;
    if (name == "run") return Kind::kRun;
    if (name == "segment") return Kind::kSegment;
    if (name == "time_s") return Kind::kTime;
    return config::is_point_channel(name) ? Kind::kNumber : Kind::kOther;
  }

  Status read_rows() {
    std::string_view line;
    const std::size_t bytes_before = lines_->consumed();
    while (true) {
      const Result<bool> more = next_line(line);
      if (!more) return more.error();
      if (!*more) break;
      if (line.empty() || is_comment(line)) continue;
      if (Status row = read_row(line); !row) return row;
      if (++rows_ == 1000) reserve((lines_->consumed() - bytes_before) / rows_);
      if (++stored_ >= most_rows_) average_neighbours();
    }
    if (rows_averaged_ > 1 && !out_of_order()) average_neighbours(rows_averaged_);
    if (rows_ == 0) {
      return bad("found a header and no rows, expected at least one row of data");
    }
    return {};
  }

  /// Room for all rows at once, so that no column is ever copied while it grows.
  void reserve(std::size_t bytes_per_row) {
    const std::size_t expected =
        std::min(size_ / std::max<std::size_t>(bytes_per_row, 2), most_rows_);
    for (Column& column : columns_) {
      if (holds_numbers(column)) column.values.reserve(expected + expected / 64);
    }
  }

  static bool holds_numbers(const Column& column) {
    return column.kind == Kind::kNumber || column.kind == Kind::kTime ||
           column.kind == Kind::kOther;
  }

  Status read_row(std::string_view line) {
    const char separator = dialect_.separator;
    const fast_float::parse_options how(fast_float::chars_format::general, dialect_.decimal());
    const bool blanks = separator == ' ';
    const char* const end = line.data() + line.size();
    const char* at = line.data();
    const auto skip_blanks = [end](const char* from) {
      while (from != end && (*from == ' ' || *from == '\t')) ++from;
      return from;
    };
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      Column& column = columns_[i];
      const bool is_last = i + 1 == columns_.size();
      if (blanks) at = skip_blanks(at);
      if (holds_numbers(column)) {
        // The common case first: a plain number, directly followed by its separator or the line's
        // end.
        double value = 0.0;
        const auto read = fast_float::from_chars_advanced(at, end, value, how);
        const char* const stop = read.ec == std::errc() && !std::isinf(value) ? read.ptr : nullptr;
        if (stop != nullptr && blanks) {
          const char* const next = skip_blanks(stop);
          if (next == end ? is_last : next != stop && !is_last) {
            column.values.push_back(value);
            at = next;
            continue;
          }
        } else if (stop != nullptr && (stop == end ? is_last : *stop == separator && !is_last)) {
          column.values.push_back(value);
          at = stop + (is_last ? 0 : 1);
          continue;
        }
      }
      std::string_view rest(at, static_cast<std::size_t>(end - at));
      bool last = false;
      if (!take_field(rest, separator, field_, last)) {
        return bad_line(
            fmt::format("column {}: found a quote that is not closed, expected one "
                        "around the whole field",
                        column.name));
      }
      // A separator that ends the line adds nothing.
      const bool nothing_more = is_last && !last && is_empty(rest);
      if (last != is_last && !nothing_more) return wrong_width(i, rest, last);
      if (Status stored = store(column); !stored) return stored;
      at = rest.data();
    }
    return {};
  }

  bool is_empty(std::string_view rest) const {
    return std::all_of(rest.begin(), rest.end(),
                       [&](char c) { return c == dialect_.separator || c == ' ' || c == '\t'; });
  }

  Status store(Column& column) {
    switch (column.kind) {
      case Kind::kIgnored:
        return {};
      case Kind::kRun:
      case Kind::kSegment:
        if (has_control_characters(field_)) {
          return bad_line(fmt::format("column {}: found {}, expected printable text", column.name,
                                      shown(field_)));
        }
        (column.kind == Kind::kRun ? run_ : segment_).add(field_);
        return {};
      default:
        break;
    }
    std::optional<double> value = to_number(field_, dialect_.decimal_comma);
    if (!value && column.kind == Kind::kTime) value = stamps_.take(field_, dialect_.dates);
    if (value) {
      column.values.push_back(*value);
      return {};
    }
    if (column.kind == Kind::kTime) {
      const auto stamp = time_stamp(field_, SlashDate::kUnknown);
      if (stamp && stamp->slashes) {
        return bad_line(fmt::format(
            "column {}: found {}: day {} of month {}, or day {} of month {}? Expected dates as "
            "2024-03-31",
            column.name, shown(field_), stamp->first, stamp->second, stamp->second, stamp->first));
      }
    }
    Error error =
        bad_line(fmt::format("column {}: found {}, expected {}", column.name, shown(field_),
                             column.kind == Kind::kTime ? "a finite number, a date or nothing"
                                                        : "a finite number or nothing"));
    if (column.kind != Kind::kOther) return error;
    column.kind = Kind::kIgnored;
    column.values = {};
    column.dropped = error.message;
    return {};
  }

  /// The new rows as those before them; where that frees less than a quarter of the table, twice as
  /// many rows of the file in each of its rows.
  void average_neighbours() {
    if (out_of_order()) {
      most_rows_ = kEveryRow;
      return;
    }
    if (rows_averaged_ > 1) average_neighbours(rows_averaged_);
    if (stored_ > most_rows_ / 4 * 3) average_neighbours(rows_averaged_ *= 2);
    // Rows of many short segments stay many.
    if (stored_ > most_rows_ / 4 * 3) most_rows_ *= 2;
  }

  void average_neighbours(std::size_t rows) {
    counts_.resize(stored_, 1);
    const std::vector<RowGroup> groups = neighbours(run_.index(), segment_.index(), counts_, rows);
    for (Column& column : columns_) {
      if (column.values.empty()) continue;
      std::vector<double> averaged = condensed(column.name, column.values, counts_, groups);
      // Not assigned as a whole: the column keeps the room that it has.
      column.values.assign(averaged.begin(), averaged.end());
    }
    run_.keep_first(groups);
    segment_.keep_first(groups);
    counts_ = rows_of(counts_, groups);
    stored_ = groups.size();
  }

  bool out_of_order() {
    const Column* const time = time_column();
    if (time == nullptr) return false;
    for (std::size_t i = 1; i < time->values.size(); ++i) {
      const bool one_run = run_.index().empty() || run_.index()[i] == run_.index()[i - 1];
      out_of_order_ = out_of_order_ || (one_run && time->values[i] < time->values[i - 1]);
    }
    return out_of_order_;
  }

  Column* time_column() {
    const auto time = std::find_if(columns_.begin(), columns_.end(),
                                   [](const Column& c) { return c.kind == Kind::kTime; });
    return time == columns_.end() ? nullptr : &*time;
  }

  Error wrong_width(std::size_t column, std::string_view rest, bool line_ended) {
    std::size_t found = column + 1;
    for (bool last = line_ended; !last; ++found) {
      if (!take_field(rest, dialect_.separator, field_, last)) break;
    }
    const bool decimals = dialect_.separator == ',' && found == 2 * columns_.size();
    return bad_line(fmt::format("found {} fields, expected {} as in the line of names{}", found,
                                columns_.size(),
                                decimals ? "; with decimal commas, something else than commas must "
                                           "separate the columns"
                                         : ""));
  }

  Result<Table> build() {
    Table table;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      Column& column = columns_[i];
      if (column.kind == Kind::kRun) {
        table.set_run(run_.take());
        table.set_run_word(column.name);
      }
      if (column.kind == Kind::kSegment) table.set_segment(segment_.take());
      if (column.kind == Kind::kTime) {
        if (Status settled = settle_time(choice_.columns[i], column.values); !settled) {
          return settled.error();
        }
      } else if (holds_numbers(column)) {
        convert(choice_.columns[i], column.values);
      }
      if (holds_numbers(column)) table.set_column(column.name, std::move(column.values));
      if (!column.dropped.empty()) table.set_dropped(column.name, column.dropped);
    }
    if (table.rows() == 0) {
      return bad("found no number in any column, expected columns of measurements");
    }
    for (const auto& [wanted, because] : choice_.undecided) {
      table.set_dropped(wanted, fmt::format("{}: {}", file_.string(), because));
    }
    table.set_rows_averaged(rows_averaged_);
    std::vector<std::string> parts;
    if (!says_.empty()) parts.push_back(fmt::format("{}", fmt::join(says_, ", ")));
    parts.insert(parts.end(), choice_.says.begin(), choice_.says.end());
    if (!parts.empty()) table.add_provenance(fmt::format("{}", fmt::join(parts, "; ")));
    return table;
  }

  Status settle_time(const ChosenColumn& chosen, std::vector<double>& values) {
    const auto said =
        stamps_.any() ? stamps_.settle(values) : settle_counter(chosen, run_.index(), values);
    if (!said) return bad(said.error().message);
    choice_.says.insert(choice_.says.end(), said->begin(), said->end());
    return {};
  }

  const std::filesystem::path& file_;
  const ReadOptions& options_;
  std::optional<LineReader> lines_;
  std::size_t size_ = 0, line_number_ = 0, rows_ = 0;
  std::size_t most_rows_, stored_ = 0, rows_averaged_ = 1;
  bool out_of_order_ = false;
  std::vector<std::uint32_t> counts_;  ///< rows of the file in each row, once there are more
  std::vector<Column> columns_;
  TextBuilder run_, segment_;
  std::string field_;
  Dialect dialect_;
  Choice choice_;
  TextStamps stamps_;
  std::vector<std::string> says_;  ///< how the file is written
};

}  // namespace

Result<Table> read_text_table(const std::filesystem::path& file, OpenedBytes opened,
                              const ReadOptions& options) {
  TextReader reader(file, options);
  auto table = reader.read(std::move(opened));
  if (!reader.averaged_in_vain()) return table;
  auto again = open_bytes(file);
  if (!again) return again.error();
  ReadOptions every_row = options;
  every_row.most_rows = kEveryRow;
  return TextReader(file, every_row).read(std::move(*again));
}

}  // namespace fogbench::model
