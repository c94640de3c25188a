#include "model/table/read_csv.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

#include "config/channels.hpp"
#include "model/table/condense.hpp"
#include "model/table/csv_fields.hpp"
#include "model/table/dialect.hpp"
#include "model/table/line_reader.hpp"

namespace fogbench::model {
namespace {

/// Reads "-12.345" from the front of a line, correctly rounded: up to 15 digits are exact in a
/// double, and so is the power of ten, which leaves one rounding. Returns where it stopped, or null
/// for what takes more thought (exponents, more digits, no number).
const char* plain_number(const char* at, const char* end, double& value) {
  static constexpr std::array<double, 16> kPowersOfTen = {
      1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint64_t digits = 0;
  const char* const first = at;
  for (; at != end && *at >= '0' && *at <= '9'; ++at) {
    digits = 10 * digits + static_cast<std::uint64_t>(*at - '0');
  }
  auto count = at - first;
  std::ptrdiff_t decimals = 0;
  if (at != end && *at == '.') {
    const char* const point = ++at;
    for (; at != end && *at >= '0' && *at <= '9'; ++at) {
      digits = 10 * digits + static_cast<std::uint64_t>(*at - '0');
    }
    decimals = at - point;
    count += decimals;
  }
  if (count == 0 || count > 15) return nullptr;
  const double magnitude =
      static_cast<double>(digits) / kPowersOfTen[static_cast<std::size_t>(decimals)];
  value = negative ? -magnitude : magnitude;
  return at;
}

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

class CsvReader {
 public:
  CsvReader(const std::filesystem::path& file, const std::map<std::string, std::string>& renames,
            std::size_t most_rows)
      : file_(file),
        renames_(renames),
        open_(file),
        lines_(open_.descriptor()),
        most_rows_(most_rows) {}

  /// Rows were averaged although a later one shows that they are not in the order of time.
  bool averaged_in_vain() const { return rows_averaged_ > 1 && out_of_order_; }

  Result<Table> read() {
    struct stat status {};
    if (open_.descriptor() < 0 || ::fstat(open_.descriptor(), &status) != 0) {
      return bad(fmt::format("{}: cannot be opened: {}", file_.string(), std::strerror(errno)));
    }
    if (S_ISDIR(status.st_mode)) {
      return bad(fmt::format("{}: found a directory, expected a CSV file", file_.string()));
    }
    size_ = static_cast<std::size_t>(std::max<off_t>(status.st_size, 0));
    if (Status known = recognise_dialect(); !known) return known.error();
    if (Status header = read_header(); !header) return header.error();
    if (Status rows = read_rows(); !rows) return rows.error();
    return build();
  }

 private:
  static constexpr std::size_t kLinesLookedAt = 64;

  enum class Kind { kNumber, kOther, kRun, kSegment, kIgnored };
  struct Column {
    std::string name;
    Kind kind = Kind::kOther;
    std::vector<double> values;
    std::string dropped;
  };

  static Error bad(std::string message) { return {ErrorCode::kBadInput, std::move(message)}; }
  Error bad_line(std::string_view what) const {
    return bad(fmt::format("{}:{}: {}", file_.string(), line_number_, what));
  }

  /// The next line with commas between its fields; false at the end of the file.
  Result<bool> next_line(std::string_view& line) {
    if (next_early_ < early_.size()) {
      line = early_[next_early_++];
      ++line_number_;
    } else if (const Result<bool> more = next_line_of_file(line); !more || !*more) {
      return more;
    }
    if (dialect_.plain() || line.empty() || is_comment(line)) return true;
    plain_ = dialect_.plain_line(line);
    line = plain_;
    return true;
  }

  /// As the file has it.
  Result<bool> next_line_of_file(std::string_view& line) {
    const LineReader::Outcome outcome = lines_.next(line);
    if (outcome == LineReader::Outcome::kEnd) return false;
    ++line_number_;
    if (outcome == LineReader::Outcome::kTooLong) {
      return bad_line("found a line longer than 1 MiB, expected comma-separated values");
    }
    if (outcome == LineReader::Outcome::kFailed) {
      return bad_line(fmt::format("cannot be read: {}", std::strerror(errno)));
    }
    return true;
  }

  /// Looks at the file's first lines, which are read again.
  Status recognise_dialect() {
    std::vector<std::string> told;  // the names and some rows
    std::string_view line;
    while (told.size() < kLinesLookedAt) {
      const Result<bool> more = next_line_of_file(line);
      if (!more) break;  // said when it is its turn
      if (!*more) break;
      early_.emplace_back(line);
      if (line_number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
      if (!line.empty() && !is_comment(line)) told.emplace_back(line);
    }
    const std::size_t seen = std::exchange(line_number_, 0);
    if (told.empty()) return {};
    const auto dialect = recognise(told.front(), std::span(told).subspan(1));
    if (!dialect) {
      line_number_ = seen;
      return bad(fmt::format("{}: {}", file_.string(), dialect.error().message));
    }
    dialect_ = *dialect;
    return {};
  }

  Status read_header() {
    std::string_view line;
    do {
      Result<bool> more = next_line(line);
      if (!more) return more.error();
      if (!*more) {
        return bad(fmt::format("{}: found an empty file, expected a line of column names",
                               file_.string()));
      }
      if (line_number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    } while (line.empty() || is_comment(line));
    if (has_control_characters(line)) {
      return bad_line(
          fmt::format("found {}, expected column names (is this a text file?)", shown(line)));
    }
    std::string name;
    for (bool last = false; !last;) {
      if (!take_field(line, name, last)) {
        return bad_line("found a quote that is not closed, expected column names");
      }
      columns_.push_back({name, {}, {}, {}});
    }
    return name_columns();
  }

  Status name_columns() {
    for (const auto& [wanted, found] : renames_) {
      const auto source =
          std::find_if(columns_.begin(), columns_.end(),
                       [&found = found](const Column& c) { return c.name == found; });
      if (source == columns_.end()) {
        return bad_line(
            fmt::format("column {}: not found, expected it because {} is to be read "
                        "from it",
                        found, wanted));
      }
      for (Column& column : columns_) {
        if (column.name == wanted) column.name.clear();
      }
      source->name = wanted;
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      Column& column = columns_[i];
      const bool twice = std::any_of(columns_.begin(), columns_.begin() + static_cast<long>(i),
                                     [&](const Column& c) { return c.name == column.name; });
      if (twice && !column.name.empty()) {
        return bad_line(
            fmt::format("column {}: found twice, expected each name once", column.name));
      }
      column.kind = kind_of(column.name);
    }
    return {};
  }

  static Kind kind_of(const std::string& name) {
    if (name.empty()) return Kind::kIgnored;
    if (name == "run") return Kind::kRun;
    if (name == "segment") return Kind::kSegment;
    return config::is_point_channel(name) ? Kind::kNumber : Kind::kOther;
  }

  Status read_rows() {
    std::string_view line;
    const std::size_t header_bytes = lines_.consumed();
    while (true) {
      Result<bool> more = next_line(line);
      if (!more) return more.error();
      if (!*more) break;
      if (line.empty() || is_comment(line)) continue;
      if (Status row = read_row(line); !row) return row;
      if (++rows_ == 1000) reserve((lines_.consumed() - header_bytes) / rows_);
      if (++stored_ >= most_rows_) average_neighbours();
    }
    if (rows_averaged_ > 1 && !out_of_order()) average_neighbours(rows_averaged_);
    if (rows_ == 0) {
      return bad(fmt::format("{}: found a header and no rows, expected at least one row of data",
                             file_.string()));
    }
    return {};
  }

  /// Room for all rows at once, so that no column is ever copied while it grows.
  void reserve(std::size_t bytes_per_row) {
    const std::size_t expected =
        std::min(size_ / std::max<std::size_t>(bytes_per_row, 2), most_rows_);
    for (Column& column : columns_) {
      if (column.kind == Kind::kNumber || column.kind == Kind::kOther) {
        column.values.reserve(expected + expected / 16);
      }
    }
  }

  Status read_row(std::string_view line) {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      Column& column = columns_[i];
      const bool is_last = i + 1 == columns_.size();
      if (column.kind == Kind::kNumber || column.kind == Kind::kOther) {
        // The common case first: a plain number, directly followed by its comma or the line's end.
        const char* const end = line.data() + line.size();
        double value = 0.0;
        const char* stop = plain_number(line.data(), end, value);
        if (stop == nullptr || (stop != end && *stop != ',')) {
          const auto [at, failure] = std::from_chars(line.data(), end, value);
          stop = failure == std::errc() && !std::isinf(value) ? at : nullptr;
        }
        if (stop != nullptr && (stop == end ? is_last : *stop == ',' && !is_last)) {
          column.values.push_back(value);
          line.remove_prefix(static_cast<std::size_t>(stop - line.data()) + (is_last ? 0 : 1));
          continue;
        }
      }
      bool last = false;
      if (!take_field(line, field_, last)) {
        return bad_line(
            fmt::format("column {}: found a quote that is not closed, expected one "
                        "around the whole field",
                        column.name));
      }
      if (last != is_last) return wrong_width(i, line, last);
      if (Status stored = store(column); !stored) return stored;
    }
    return {};
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
    const std::optional<double> value = to_number(field_);
    if (value) {
      column.values.push_back(*value);
      return {};
    }
    Error error = bad_line(fmt::format("column {}: found {}, expected a finite number or nothing",
                                       column.name, shown(field_)));
    if (column.kind == Kind::kNumber) return error;
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
    const auto time = std::find_if(columns_.begin(), columns_.end(),
                                   [](const Column& c) { return c.name == "time_s"; });
    if (time == columns_.end()) return false;
    for (std::size_t i = 1; i < time->values.size(); ++i) {
      const bool one_run = run_.index().empty() || run_.index()[i] == run_.index()[i - 1];
      out_of_order_ = out_of_order_ || (one_run && time->values[i] < time->values[i - 1]);
    }
    return out_of_order_;
  }

  Error wrong_width(std::size_t column, std::string_view rest, bool line_ended) {
    std::size_t found = column + 1;
    for (bool last = line_ended; !last; ++found) {
      if (!take_field(rest, field_, last)) break;
    }
    return bad_line(fmt::format("found {} fields, expected {} as in the line of names", found,
                                columns_.size()));
  }

  Table build() {
    Table table;
    for (Column& column : columns_) {
      if (column.kind == Kind::kRun) table.set_run(run_.take());
      if (column.kind == Kind::kSegment) table.set_segment(segment_.take());
      if (column.kind == Kind::kNumber || column.kind == Kind::kOther) {
        table.set_column(column.name, std::move(column.values));
      }
      if (!column.dropped.empty()) table.set_dropped(column.name, column.dropped);
    }
    table.set_rows_averaged(rows_averaged_);
    if (!dialect_.plain()) table.set_written(dialect_.says());
    return table;
  }

  const std::filesystem::path& file_;
  const std::map<std::string, std::string>& renames_;
  OpenFile open_;
  LineReader lines_;
  std::size_t size_ = 0, line_number_ = 0, rows_ = 0;
  std::size_t most_rows_, stored_ = 0, rows_averaged_ = 1;
  bool out_of_order_ = false;
  std::vector<std::uint32_t> counts_;  ///< rows of the file in each row, once there are more
  std::vector<Column> columns_;
  TextBuilder run_, segment_;
  std::string field_;
  Dialect dialect_;
  std::vector<std::string> early_;  ///< lines that were looked at before their turn
  std::size_t next_early_ = 0;
  std::string plain_;
};

}  // namespace

Result<Table> read_csv(const std::filesystem::path& file,
                       const std::map<std::string, std::string>& renames, std::size_t most_rows) {
  CsvReader reader(file, renames, most_rows);
  auto table = reader.read();
  if (!reader.averaged_in_vain()) return table;
  return CsvReader(file, renames, kEveryRow).read();
}

}  // namespace fogbench::model
