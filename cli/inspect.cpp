// fogbench inspect: what would be understood of a file, before anything is fitted to it.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/load_table.hpp"
#include "cli/output.hpp"
#include "config/rounding.hpp"
#include "model/table/inspection.hpp"

namespace fogbench::cli {
namespace {

using nlohmann::ordered_json;

struct InspectOptions {
  DataOptions data;
  bool json = false;
};

std::string stretch_in_words(const char* what, const std::optional<model::Stretch>& stretch) {
  if (!stretch) return {};
  return fmt::format("{} at {:.6g} for {} rows from row {}; ", what, stretch->value, stretch->rows,
                     stretch->row + 1);
}

std::string time_in_words(const model::Inspection& found) {
  const model::StepsOfTime& time = *found.time;
  std::string out = fmt::format("time_s from {:.10g} to {:.10g} s", found.first_s, found.last_s);
  if (time.usual_s > 0.0) {
    out += fmt::format(", a row each {:.4g} s ({:.4g} Hz)", time.usual_s, 1.0 / time.usual_s);
  }
  if (time.gap_count > 0) {
    const model::TimeFall& gap = time.gaps.front();
    out += fmt::format("; {} gap{}, the longest of {:.4g} s before row {}", time.gap_count,
                       time.gap_count > 1 ? "s" : "", gap.to_s - gap.from_s, gap.row + 1);
  }
  if (time.repeated > 0) {
    out += fmt::format("; {} repeated stamp{}, first at row {}", time.repeated,
                       time.repeated > 1 ? "s" : "", time.first_repeated + 1);
  }
  if (time.backwards > 0) {
    out += fmt::format("; {} step{} back, first at row {}", time.backwards,
                       time.backwards > 1 ? "s" : "", time.first_backwards + 1);
  }
  if (time.blank > 0) out += fmt::format("; {} without a stamp", time.blank);
  return out;
}

void print_inspection(const std::string& data, const model::Table& table,
                      const model::Inspection& found) {
  fmt::print("{}: {} rows, {} columns", data, found.rows, found.columns.size());
  if (found.runs.size() > 1) fmt::print(", {} runs", found.runs.size());
  if (!found.segments.empty()) fmt::print(", {} segments", found.segments.size());
  fmt::print("\n");
  for (const std::string& line : table.provenance()) fmt::print("{}\n", line);
  if (found.time) fmt::print("{}\n", time_in_words(found));
  using Align = TextTable::Align;
  TextTable columns({{"column", "", Align::kLeft},
                     {"unit", "", Align::kLeft},
                     {"missing", ""},
                     {"least", ""},
                     {"mean", ""},
                     {"most", ""},
                     {"resolution", ""},
                     {"stands still", "", Align::kLeft}});
  for (const model::ColumnInspection& c : found.columns) {
    std::string still =
        stretch_in_words("saturated", c.saturated) + stretch_in_words("stuck", c.stuck);
    if (still.size() > 2) still.resize(still.size() - 2);
    columns.add_row({c.name, c.unit.empty() ? "?" : c.unit,
                     c.missing > 0 ? std::to_string(c.missing) : "",
                     config::significant(c.least, 6), config::significant(c.mean, 6),
                     config::significant(c.most, 6),
                     c.resolution ? config::significant(*c.resolution, 3) : "", still});
  }
  fmt::print("\n{}", columns.text());
}

ordered_json stretch_json(const std::optional<model::Stretch>& stretch) {
  if (!stretch) return nullptr;
  return {{"row", stretch->row + 1}, {"rows", stretch->rows}, {"value", stretch->value}};
}

ordered_json falls_json(const std::vector<model::TimeFall>& falls) {
  ordered_json out = ordered_json::array();
  for (const model::TimeFall& fall : falls) {
    out.push_back({{"row", fall.row + 1}, {"from_s", fall.from_s}, {"to_s", fall.to_s}});
  }
  return out;
}

ordered_json inspection_json(const std::string& data, const model::Table& table,
                             const model::Inspection& found) {
  ordered_json out{{"data", data},
                   {"rows", found.rows},
                   {"read_as", table.provenance()},
                   {"runs", found.runs},
                   {"segments", found.segments},
                   {"time", nullptr},
                   {"columns", ordered_json::array()}};
  if (found.time) {
    const model::StepsOfTime& time = *found.time;
    out["time"] = {{"first_s", found.first_s},
                   {"last_s", found.last_s},
                   {"usual_step_s", time.usual_s},
                   {"rate_hz", 1.0 / time.usual_s},
                   {"gap_count", time.gap_count},
                   {"longest_gaps", falls_json(time.gaps)},
                   {"repeated", time.repeated},
                   {"backwards", time.backwards},
                   {"restarts", falls_json(time.restarts)},
                   {"blank", time.blank}};
  }
  for (const model::ColumnInspection& c : found.columns) {
    ordered_json column{{"name", c.name},       {"unit", nullptr},      {"values", c.values},
                        {"missing", c.missing}, {"least", c.least},     {"mean", c.mean},
                        {"most", c.most},       {"resolution", nullptr}};
    if (!c.unit.empty()) column["unit"] = c.unit;
    if (c.resolution) column["resolution"] = *c.resolution;
    column["saturated"] = stretch_json(c.saturated);
    column["stuck"] = stretch_json(c.stuck);
    out["columns"].push_back(std::move(column));
  }
  return out;
}

Result<ExitStatus> run_inspect(const InspectOptions& options) {
  const auto table = load_table(options.data);
  if (!table) return table.error();
  const model::Inspection found = model::inspect(*table);
  if (options.json) {
    print_json(inspection_json(data_name(options.data), *table, found));
  } else {
    print_inspection(data_name(options.data), *table, found);
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_inspect(CLI::App& app, Action& action) {
  add_command<InspectOptions>(
      app, action, "inspect", "See what would be understood of a table, and what is odd in it",
      "  fogbench inspect night.csv --unit gyro=deg/s\n"
      "  fogbench inspect log.mat#rig2 --json\n",
      [](CLI::App& command, InspectOptions& options) {
        add_data_options(command, options.data);
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_inspect);
}

}  // namespace fogbench::cli
