// fogbench allan: Allan deviation of a static record and the noise coefficients
// read from it.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/load_table.hpp"
#include "cli/output.hpp"
#include "config/noise_parts.hpp"
#include "model/noise/allan.hpp"
#include "model/noise/static_record.hpp"

namespace fogbench::cli {
namespace {

struct AllanOptions {
  DataOptions data;
  double interval_s = 0.0;
  bool json = false;
};

void print_text(const std::vector<model::AllanPoint>& curve, const Result<model::AllanFit>& fit) {
  TextTable table({{"tau", "s"}, {"Allan deviation", "deg/h"}, {"std error", "deg/h"}});
  for (const model::AllanPoint& point : curve) {
    table.add_row({fmt::format("{:.6g}", point.tau_s),
                   fmt::format("{:.4g}", point.deviation_deg_per_h),
                   fmt::format("{:.2g}", point.standard_error_deg_per_h)});
  }
  fmt::print("{}\n", table.text());
  if (!fit) {
    fmt::print("No noise coefficients: {}.\n", fit.error().message);
    return;
  }
  for (const config::NoisePart& part : config::kNoiseParts) {
    const double value = fit->noise.*part.value;
    if (value > 0.0) {
      fmt::print("{:<20} {:.3g} +- {:.2g} {}\n", part.name, value, fit->standard_error.*part.value,
                 part.unit);
    } else {
      fmt::print("{:<20} not seen in this record\n", part.name);
    }
  }
}

nlohmann::json to_json(const model::StaticRecord& record,
                       const std::vector<model::AllanPoint>& curve,
                       const Result<model::AllanFit>& fit) {
  nlohmann::json points = nlohmann::json::array();
  for (const model::AllanPoint& point : curve) {
    points.push_back({{"tau_s", point.tau_s},
                      {"deviation_deg_per_h", point.deviation_deg_per_h},
                      {"standard_error_deg_per_h", point.standard_error_deg_per_h},
                      {"count", point.count}});
  }
  nlohmann::json document = {{"samples", record.rate_deg_per_h.size()},
                             {"interval_s", record.interval_s},
                             {"curve", points},
                             {"noise", nullptr}};
  if (fit) {
    document["noise"] = nlohmann::json::object();
    for (const config::NoisePart& part : config::kNoiseParts) {
      document["noise"][part.key] = fit->noise.*part.value;
      document["standard_error"][part.key] = fit->standard_error.*part.value;
    }
  }
  return document;
}

Result<ExitStatus> run_allan(const AllanOptions& options) {
  const auto table = load_table(options.data);
  if (!table) return table.error();
  const auto record = model::static_record(*table, "rate_deg_per_h", options.interval_s);
  if (!record) return record.error();
  const auto curve = model::allan_deviation(record->rate_deg_per_h, record->interval_s);
  if (!curve) return curve.error();
  const auto fit = model::fit_allan(*curve);  // a short record still has its curve
  if (options.json) {
    print_json(to_json(*record, *curve, fit));
  } else {
    print_text(*curve, fit);
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_allan(CLI::App& app, Action& action) {
  add_command<AllanOptions>(
      app, action, "allan", "Allan deviation of a static record, and its N, B, K, Q",
      "  fogbench allan 7 --segment static\n"
      "  fogbench allan record.csv --column rate_deg_per_h=omega --interval "
      "0.01\n",
      [](CLI::App& command, AllanOptions& options) {
        add_data_options(command, options.data);
        command.add_option("--interval", options.interval_s,
                           "Sampling interval in s, where the data have no time_s");
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_allan);
}

}  // namespace fogbench::cli
