#include "cli/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "acceptance/results.hpp"
#include "cli/output.hpp"
#include "procedures/channel_values.hpp"
#include "procedures/sentence.hpp"
#include "record/store.hpp"

namespace fogbench::cli {
using acceptance::Deviation;
using acceptance::Figure;
using acceptance::SweepResult;
using nlohmann::ordered_json;
using Align = TextTable::Align;

namespace {

std::string text_of(const Figure& figure) {
  return with_error(figure.value, figure.standard_error);
}

ordered_json to_json(const Figure& figure) {
  return {{"value", figure.value}, {"standard_error", figure.standard_error}};
}

Result<acceptance::RunResults> results_of(record::RunLogReader& reader, std::int64_t run) {
  const auto stored = reader.chain_points(run);
  if (!stored) return stored.error();
  std::vector<procedures::Point> points;
  for (const auto& point : *stored) {
    if (point.void_because.empty()) points.push_back(point.point);
  }
  return acceptance::derive_results(points);
}

std::string temperature_table(const std::vector<Deviation>& rows) {
  TextTable table({{"test", "", Align::kLeft},
                   {"segment", "", Align::kLeft},
                   {"set", "degC"},
                   {"temperature", "degC"},
                   {"rate", "deg/h"},
                   {"deviation +- std error", "deg/h"}});
  for (const Deviation& row : rows) {
    table.add_row({std::to_string(row.test), row.segment, fixed(row.target_c, 1),
                   fixed(row.temperature_c, 3), fixed(row.rate_deg_per_h, 4),
                   text_of(row.deviation_deg_per_h)});
  }
  return table.empty() ? "" : "\nDeviation from the baseline, by temperature\n\n" + table.text();
}

std::string magnetic_table(const std::vector<Deviation>& rows) {
  TextTable table({{"test", "", Align::kLeft},
                   {"segment", "", Align::kLeft},
                   {"set", "uT"},
                   {"field", "uT"},
                   {"rate", "deg/h"},
                   {"deviation +- std error", "deg/h"}});
  for (const Deviation& row : rows) {
    table.add_row({std::to_string(row.test), row.segment, fixed(row.field_set_ut, 0),
                   fixed(row.field_ut, 2), fixed(row.rate_deg_per_h, 4),
                   text_of(row.deviation_deg_per_h)});
  }
  return table.empty() ? "" : "\nDeviation from the baseline, by field\n\n" + table.text();
}

std::string sweep_tables(const std::vector<SweepResult>& sweeps) {
  if (sweeps.empty()) return "";
  TextTable coefficients({{"test", "", Align::kLeft},
                          {"sweep", "", Align::kLeft},
                          {"axis", "", Align::kLeft},
                          {"levels", ""},
                          {"K +- std error", "deg/h per 100 uT"},
                          {"slope +- std error", "deg/h per 100 uT"},
                          {"at zero field", "deg/h"}});
  TextTable closures({{"test", "", Align::kLeft},
                      {"sweep", "", Align::kLeft},
                      {"first", "deg/h"},
                      {"middle", "deg/h"},
                      {"last", "deg/h"},
                      {"drift +- std error", "deg/h"},
                      {"closure +- std error", "deg/h"}});
  for (const SweepResult& row : sweeps) {
    const std::string test = std::to_string(row.test);
    coefficients.add_row({test, row.sweep, std::string(1, row.axis), std::to_string(row.points),
                          text_of(row.k_deg_per_h), text_of(row.slope_deg_per_h),
                          text_of(row.intercept_deg_per_h)});
    closures.add_row({test, row.sweep, fixed(row.zero_first_deg_per_h, 4),
                      fixed(row.zero_middle_deg_per_h, 4), fixed(row.zero_last_deg_per_h, 4),
                      text_of(row.drift_deg_per_h), text_of(row.closure_deg_per_h)});
  }
  return "\nMagnetic coefficients: K from the extreme set levels, slope by least squares on the "
         "measured field\n\n" +
         coefficients.text() +
         "\nZero-field readings of each sweep: a linear drift closes to 0 (first - 2 middle + "
         "last), a remanence\nof +-r leaves -3r\n\n" +
         closures.text();
}

std::string results_text_of(const acceptance::RunResults& results, bool every_level) {
  const std::string tables = temperature_table(results.temperature) +
                             (every_level ? magnetic_table(results.magnetic) : "") +
                             sweep_tables(results.sweeps);
  if (tables.empty()) return "\nNo results: the run has no averages to report.\n";
  return tables + "\nStandard errors are those of white noise within the averages: lower bounds.\n";
}

/// What the run's bench file, or its thermostat's device file, says of the sensors' lag, s; 0 when
/// neither does. Both texts are in the record.
double sensor_lag_s(const std::string& bench_json) {
  double of_device = 0.0;
  const nlohmann::json texts = nlohmann::json::parse(bench_json, nullptr, false);
  for (const nlohmann::json& text : texts) {
    if (!text.is_string()) continue;
    const auto file = nlohmann::json::parse(text.get_ref<const std::string&>(), nullptr, false);
    if (!file.is_object()) continue;
    const nlohmann::json& holder = file.contains("thermostat") ? file["thermostat"] : file;
    const auto lag = holder.is_object() ? holder.find("sensor_lag_s") : holder.end();
    if (lag == holder.end() || !lag->is_number()) continue;
    if (&holder != &file) return lag->get<double>();
    of_device = lag->get<double>();
  }
  return of_device;
}

ordered_json to_json(const record::StoredRun& run) {
  const procedures::RunHeader& header = run.header;
  ordered_json json{{"run", run.run},
                    {"procedure", header.procedure},
                    {"bench", header.bench},
                    {"seed", header.seed ? ordered_json(*header.seed) : ordered_json()},
                    {"gyro_serial_number", header.gyro_serial_number},
                    {"operator", header.operator_name},
                    {"software_version", header.software_version},
                    {"started_at", header.started_at},
                    {"outcome", run.outcome()},
                    {"points", run.points},
                    {"points_void", run.points_void},
                    {"frame_rate_hz", header.frame_rate_hz},
                    {"sensor_lag_s", sensor_lag_s(header.bench_json)},
                    {"reference_rate_deg_per_h", header.reference_rate_deg_per_h},
                    {"frames_stored", run.frames_stored}};
  if (header.continues) json["takes_up"] = header.continues->run;
  if (run.taken_up_by != 0) json["taken_up_by"] = run.taken_up_by;
  if (!run.end) return json;
  const drivers::StreamStatistics& stream = run.end->stream;
  json["reason"] = run.end->reason;
  json["safe_state_reached"] = run.end->safe_state_reached;
  json["ended_at"] = run.end->ended_at;
  json["stream"] = {{"frames_good", stream.frames_good},
                    {"frames_bad_checksum", stream.frames_bad_checksum},
                    {"frames_invalid", stream.frames_invalid},
                    {"frames_repeated", stream.frames_repeated},
                    {"frames_missing", stream.frames_missing},
                    {"bytes_skipped", stream.bytes_skipped}};
  json["raw_sha256"] = run.raw_sha256;
  return json;
}

ordered_json to_json(const record::StoredPoint& stored) {
  ordered_json json{{"kind", name_of(stored.point.kind)},
                    {"test", stored.point.test},
                    {"segment", stored.point.segment},
                    {"frames", stored.point.count},
                    {"frames_dropped", stored.point.dropped}};
  for (const auto& column : procedures::point_channels()) {
    json[std::string(column.name)] = stored.point.*column.value;
  }
  for (const auto& [name, value] : stored.point.auxiliary) json[name] = value;
  if (!stored.void_because.empty()) json["void_because"] = stored.void_because;
  return json;
}

ordered_json to_json(const Deviation& row) {
  return {{"test", row.test},
          {"segment", row.segment},
          {"time_s", row.time_s},
          {"target_c", row.target_c},
          {"temperature_c", row.temperature_c},
          {"field_set_ut", row.field_set_ut},
          {"field_ut", row.field_ut},
          {"rate_deg_per_h", row.rate_deg_per_h},
          {"deviation_deg_per_h", to_json(row.deviation_deg_per_h)}};
}

ordered_json to_json(const SweepResult& row) {
  return {{"test", row.test},
          {"sweep", row.sweep},
          {"axis", std::string(1, row.axis)},
          {"points", row.points},
          {"k_deg_per_h_per_100_ut", to_json(row.k_deg_per_h)},
          {"slope_deg_per_h_per_100_ut", to_json(row.slope_deg_per_h)},
          {"intercept_deg_per_h", to_json(row.intercept_deg_per_h)},
          {"zero_first_deg_per_h", row.zero_first_deg_per_h},
          {"zero_middle_deg_per_h", row.zero_middle_deg_per_h},
          {"zero_last_deg_per_h", row.zero_last_deg_per_h},
          {"drift_deg_per_h", to_json(row.drift_deg_per_h)},
          {"closure_deg_per_h", to_json(row.closure_deg_per_h)}};
}

template <class T>
ordered_json array_of(const std::vector<T>& rows) {
  ordered_json array = ordered_json::array();
  for (const T& row : rows) array.push_back(to_json(row));
  return array;
}

std::string heading(const record::StoredRun& run) {
  const procedures::RunHeader& header = run.header;
  std::string text = fmt::format("Run {}: {} on bench {}, {}\n", run.run, header.procedure,
                                 header.bench, run.outcome());
  const auto line = [&text](const char* name, const std::string& value) {
    if (!value.empty()) text += fmt::format("  {:<15} {}\n", name, value);
  };
  line("started", header.started_at);
  if (run.end) {
    line("ended", run.end->ended_at);
    line("reason", run.end->reason);
    line("safe state", run.end->safe_state_reached ? "reached, read back" : "NOT REACHED");
  } else {
    line("ended", run.under_way ? "not yet" : "never");
  }
  if (header.continues)
    line("takes up", fmt::format("run {}; the results are of both", header.continues->run));
  if (run.taken_up_by != 0) line("taken up by", fmt::format("run {}", run.taken_up_by));
  line("gyro", header.gyro_serial_number);
  line("operator", header.operator_name);
  line("seed", header.seed ? std::to_string(*header.seed) : "");
  line("software", "fogbench " + header.software_version);
  line("points", run.points_void == 0
                     ? fmt::format("{}", run.points)
                     : fmt::format("{}, {} of them void", run.points, run.points_void));
  line("frames", fmt::format("{} stored, {:g} Hz", run.frames_stored, header.frame_rate_hz));
  if (const double lag_s = sensor_lag_s(header.bench_json); lag_s > 0.0) {
    line("sensor lag", fmt::format("{:g} s, which the points' temperatures are freed of", lag_s));
  }
  if (run.end) {
    const drivers::StreamStatistics& stream = run.end->stream;
    line("stream",
         fmt::format("{} good, {} missing ({} bad checksum, {} invalid), {} repeated",
                     stream.frames_good, stream.frames_missing, stream.frames_bad_checksum,
                     stream.frames_invalid, stream.frames_repeated));
  }
  line("raw SHA-256", run.raw_sha256);
  return text;
}

std::string instrument_table(const std::vector<procedures::InstrumentRecord>& instruments) {
  TextTable table({{"instrument", "", Align::kLeft},
                   {"identity", "", Align::kLeft},
                   {"serial number", "", Align::kLeft},
                   {"calibrated", "", Align::kLeft},
                   {"due", "", Align::kLeft}});
  for (const auto& row : instruments) {
    table.add_row(
        {row.role, row.identity, row.serial_number, row.calibrated_on, row.calibration_due});
  }
  return table.empty() ? "" : "\n" + table.text();
}

std::string event_list(const std::vector<record::StoredEvent>& events, double zero_unix_s) {
  std::string text;
  for (const auto& event : events) {
    text += fmt::format("  {}  {:>12}  {:<7}  {}\n", drivers::utc_text(zero_unix_s + event.time_s),
                        procedures::duration_text(config::Seconds(event.time_s)), event.severity,
                        event.message);
  }
  return text.empty() ? "" : "\nEvents, by date and by time since power-on\n\n" + text;
}

}  // namespace

Result<std::string> results_text(record::RunLogReader& reader, std::int64_t run) {
  const auto results = results_of(reader, run);
  if (!results) return results.error();
  return results_text_of(*results, false);
}

Result<std::string> run_text(record::RunLogReader& reader, std::int64_t run) {
  const auto stored = reader.run(run);
  if (!stored) return stored.error();
  const auto instruments = reader.instruments(run);
  if (!instruments) return instruments.error();
  const auto results = results_of(reader, run);
  if (!results) return results.error();
  const auto events = reader.events(run);
  if (!events) return events.error();
  const auto zero = reader.zero_unix_s(*stored);
  if (!zero) return zero.error();
  return heading(*stored) + instrument_table(*instruments) + results_text_of(*results, true) +
         event_list(*events, *zero);
}

Result<ordered_json> run_json(record::RunLogReader& reader, std::int64_t run) {
  const auto stored = reader.run(run);
  if (!stored) return stored.error();
  const auto instruments = reader.instruments(run);
  if (!instruments) return instruments.error();
  const auto points = reader.chain_points(run);
  if (!points) return points.error();
  const auto results = results_of(reader, run);
  if (!results) return results.error();
  const auto events = reader.events(run);
  if (!events) return events.error();
  const auto zero = reader.zero_unix_s(*stored);
  if (!zero) return zero.error();

  ordered_json json = to_json(*stored);
  json["instruments"] = ordered_json::array();
  for (const auto& row : *instruments) {
    json["instruments"].push_back({{"role", row.role},
                                   {"identity", row.identity},
                                   {"serial_number", row.serial_number},
                                   {"calibrated_on", row.calibrated_on},
                                   {"calibration_due", row.calibration_due}});
  }
  json["results"] = {{"temperature", array_of(results->temperature)},
                     {"magnetic", array_of(results->magnetic)},
                     {"sweeps", array_of(results->sweeps)}};
  json["measured"] = array_of(*points);
  json["events"] = ordered_json::array();
  for (const auto& event : *events) {
    json["events"].push_back({{"at", drivers::utc_text(*zero + event.time_s)},
                              {"time_s", event.time_s},
                              {"severity", event.severity},
                              {"message", event.message}});
  }
  return json;
}

}  // namespace fogbench::cli
