#include "model/table/write_csv.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "config/csv_text.hpp"
#include "config/output_file.hpp"

namespace fogbench::model {
namespace {

/// Text that is handed to the file at once.
constexpr std::size_t kFlushBytes = std::size_t{1} << 20;

bool says_something(const TextColumn& column, const std::string& nothing) {
  for (const std::uint32_t index : column.index) {
    if (column.values[index] != nothing) return true;
  }
  return false;
}

}  // namespace

Status write_csv(const Table& table, const std::filesystem::path& file) {
  Result<std::unique_ptr<config::OutputFile>> out = config::OutputFile::open(file);
  if (!out) return out.error();
  std::vector<const TextColumn*> texts;
  std::vector<std::span<const double>> numbers;
  std::string text;
  const auto add_name = [&](const std::string& name) {
    text += (text.empty() ? "" : ",") + config::csv_text(name);
  };
  if (says_something(table.run(), "1")) {
    texts.push_back(&table.run());
    add_name(table.run_word());
  }
  if (says_something(table.segment(), "")) {
    texts.push_back(&table.segment());
    add_name("segment");
  }
  for (const std::string& name : table.column_names()) {
    numbers.push_back(table.column(name));
    add_name(name);
  }
  for (std::size_t row = 0; row < table.rows(); ++row) {
    char separator = '\n';
    for (const TextColumn* column : texts) {
      text += separator + config::csv_text(column->at(row));
      separator = ',';
    }
    for (const std::span<const double> column : numbers) {
      text += separator;
      if (!std::isnan(column[row])) fmt::format_to(std::back_inserter(text), "{}", column[row]);
      separator = ',';
    }
    if (text.size() < kFlushBytes) continue;
    if (Status written = (*out)->write(text); !written) return written;
    text.clear();
  }
  if (Status written = (*out)->write(text + "\n"); !written) return written;
  return (*out)->commit();
}

}  // namespace fogbench::model
