#include "model/table/table_choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

namespace fogbench::model {

std::vector<StoredColumn> of_one_length(std::vector<StoredColumn> columns,
                                        std::vector<std::string>& left_out) {
  std::map<std::size_t, std::size_t> counts;
  for (const StoredColumn& column : columns) {
    if (column.rows() > 1) ++counts[column.rows()];
  }
  std::size_t rows = 0, most = 0;
  for (const auto& [length, count] : counts) {
    if (count < most) continue;  // of equally many the longer ones
    rows = length;
    most = count;
  }
  std::vector<StoredColumn> out;
  for (StoredColumn& column : columns) {
    if (rows > 0 && column.rows() == rows) {
      out.push_back(std::move(column));
    } else {
      left_out.push_back(column.source.name);
    }
  }
  return out;
}

Result<StoredColumns> the_table(std::vector<TableCandidate> candidates, const std::string& wanted,
                                const std::string& format, const std::string& nothing) {
  const auto bad = [](std::string message) {
    return Error{ErrorCode::kBadInput, std::move(message)};
  };
  std::erase_if(candidates, [](const TableCandidate& c) { return c.columns.empty(); });
  if (candidates.empty()) {
    return bad(fmt::format("found no table in the {} file, expected {}", format, nothing));
  }
  const bool wide = std::any_of(candidates.begin(), candidates.end(),
                                [](const TableCandidate& c) { return c.columns.size() > 1; });
  if (wide && wanted.empty()) {  // a single column beside a table is a note
    std::erase_if(candidates, [](const TableCandidate& c) { return c.columns.size() < 2; });
  }
  std::vector<std::string> names;
  for (const TableCandidate& candidate : candidates) names.push_back("FILE#" + candidate.name);
  auto chosen = candidates.begin();
  if (!wanted.empty()) {
    chosen = std::find_if(candidates.begin(), candidates.end(),
                          [&](const TableCandidate& c) { return c.name == wanted; });
    if (chosen == candidates.end()) {
      return bad(
          fmt::format("found no {} in it, expected one of {}", wanted, fmt::join(names, ", ")));
    }
  } else if (candidates.size() > 1) {
    return bad(fmt::format("found several tables, expected one of them to be named: {}",
                           fmt::join(names, ", ")));
  }
  std::vector<std::string> left_out;
  StoredColumns out{fmt::format("{}, {}", format, chosen->name),
                    of_one_length(std::move(chosen->columns), left_out)};
  if (out.columns.empty()) {
    return bad(
        fmt::format("found no columns of measurements in {}, expected {}", chosen->name, nothing));
  }
  if (!left_out.empty()) {
    out.how += fmt::format(" without {}", fmt::join(left_out, ", "));
  }
  return out;
}

}  // namespace fogbench::model
