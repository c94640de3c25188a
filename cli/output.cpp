#include "cli/output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "config/rounding.hpp"

namespace fogbench::cli {

TextTable::TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

void TextTable::add_row(std::vector<std::string> cells) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t blank = std::min(text.find(' ', at), text.size());
    const std::size_t length = blank - at;
    if (!lines.back().empty() && lines.back().size() + 1 + length > width) lines.emplace_back();
    if (!lines.back().empty()) lines.back() += ' ';
    lines.back().append(text, at, length);
    at = blank + 1;
  }
  return lines;
}

std::string wrapped(const std::string& text, const std::string& indent) {
  std::string out;
  for (const std::string& line : wrapped(text, kTextWidth - indent.size() - 2)) {
    out += fmt::format("{}{}{}\n", indent, out.empty() ? "" : "  ", line);
  }
  return out;
}

std::string TextTable::text(std::size_t width) const {
  std::vector<std::string> titles, units;
  for (const Column& column : columns_) {
    titles.push_back(column.title);
    units.push_back(column.unit);
  }
  const bool any_unit = std::any_of(units.begin(), units.end(), [](auto& u) { return !u.empty(); });

  std::vector<std::size_t> widths(columns_.size(), 0);
  const auto widen = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) widths[i] = std::max(widths[i], cells[i].size());
  };
  widen(titles);
  widen(units);
  for (const auto& row : rows_) widen(row);
  std::size_t total = columns_.empty() ? 0 : 2 * (columns_.size() - 1);
  for (const std::size_t w : widths) total += w;
  if (width > 0 && total > width && !columns_.empty()) {
    constexpr std::size_t kLeast = 20;
    const std::size_t others = total - widths.back();
    widths.back() = std::max(kLeast, width - std::min(width, others));
    total = others + widths.back();
  }

  std::string out;
  const auto write = [&](const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) line += "  ";
      line += columns_[i].align == Align::kRight ? fmt::format("{:>{}}", cells[i], widths[i])
                                                 : fmt::format("{:<{}}", cells[i], widths[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  };
  write(titles);
  if (any_unit) write(units);
  out += std::string(total, '-') + '\n';
  for (const auto& row : rows_) {
    if (width == 0 || row.empty() || row.back().size() <= widths.back()) {
      write(row);
      continue;
    }
    auto cells = row;
    for (const std::string& line : wrapped(row.back(), widths.back())) {
      cells.back() = line;
      write(cells);
      std::fill(cells.begin(), cells.end(), "");
    }
  }
  return out;
}

std::string fixed(double value, int decimals) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, decimals);
}

std::string with_error(double value, double standard_error) {
  const config::Rounded r = config::rounded(value, standard_error);
  if (!std::isfinite(standard_error) || standard_error <= 0.0) return r.value;
  return fmt::format("{} +- {}", r.value, r.uncertainty);
}

void print_json(const nlohmann::ordered_json& document) {
  fmt::print("{}\n",
             document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void print_error(const std::string& message) {
  std::string line = message;
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  // fmt::print would throw when standard error is closed or full.
  std::fputs(fmt::format("fogbench: {}\n", line).c_str(), stderr);
}

void print_note(const std::string& message) {
  print_error("note: " + message);
}

namespace {

std::vector<std::string>& notes_beside_result() {
  static std::vector<std::string> notes;
  return notes;
}

}  // namespace

void note_beside_result(std::string message) {
  notes_beside_result().push_back(std::move(message));
}

void print_notes_beside_result() {
  for (const std::string& note : notes_beside_result()) print_note(note);
}

Error with_notes(Error error, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) error.message += "; " + note;
  return error;
}

bool progress_wanted() {
  return isatty(STDERR_FILENO) == 1;
}

}  // namespace fogbench::cli
