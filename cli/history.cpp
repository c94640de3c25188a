// fogbench history: what happened on a bench, by the calendar, in sentences: from the records
// alone.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "config/output_file.hpp"
#include "drivers/clock.hpp"
#include "model/report/report_page.hpp"
#include "model/report/svg_plot.hpp"
#include "procedures/sentence.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::cli {
namespace {

using record::StoredRun;

struct HistoryOptions {
  std::string store;
  std::string since;
  std::string gyro;
  std::string html;
  bool json = false;
};

/// Something that happened.
struct Happened {
  double unix_s = 0.0;
  std::int64_t run = 0;
  std::string gyro;
  std::string severity;  ///< as of events: info, warning, error
  std::string says;
};

double machine_unix_s() {
  return std::chrono::duration<double>(drivers::SteadyClock().wall_now().time_since_epoch())
      .count();
}

/// From when on: "2026-11-29", "2026-11-29T18:00:00Z", or so long before now: "12h", "7d".
Result<double> since_of(const std::string& text) {
  if (text.empty()) return -std::numeric_limits<double>::infinity();
  const double day = drivers::seconds_of_utc(text + "T00:00:00Z");
  const double instant = drivers::seconds_of_utc(text);
  if (std::isfinite(day)) return day;
  if (std::isfinite(instant)) return instant;
  double count = 0.0;
  const char* const last = text.data() + text.size() - 1;
  const auto [end, error] = std::from_chars(text.data(), last, count);
  const double unit = *last == 'h' ? 3600.0 : *last == 'd' ? 86400.0 : 0.0;
  if (error != std::errc{} || end != last || unit == 0.0 || !(count >= 0.0)) {
    return Error{ErrorCode::kUsage,
                 fmt::format("--since: found \"{}\", expected a date (2026-11-29), a time "
                             "(2026-11-29T18:00:00Z), or so long ago (12h, 7d)",
                             text)};
  }
  return machine_unix_s() - count * unit;
}

std::string begin_of(const StoredRun& run) {
  const procedures::RunHeader& header = run.header;
  std::string says = fmt::format("run {} begins: {}, gyro {}, bench {}", run.run, header.procedure,
                                 header.gyro_serial_number, header.bench);
  if (!header.operator_name.empty()) says += ", asked for by " + header.operator_name;
  if (header.continues) says += fmt::format("; it takes up run {}", header.continues->run);
  return says;
}

/// The last word on a run, and when it was said; `last_s`: of its record.
Happened end_of(const StoredRun& run, double zero_unix_s, double last_s) {
  const std::string points =
      run.points_void == 0 ? fmt::format("{} points", run.points)
                           : fmt::format("{} points, {} of them void", run.points, run.points_void);
  Happened out{zero_unix_s + last_s, run.run, run.header.gyro_serial_number, "info", {}};
  if (!run.end) {
    out.severity = run.under_way ? "info" : "warning";
    out.says = run.under_way
                   ? fmt::format("run {} is under way: {} so far", run.run, points)
                   : fmt::format("run {} was interrupted: {}; nothing is on record after this",
                                 run.run, points);
    return out;
  }
  const double ended = drivers::seconds_of_utc(run.end->ended_at);
  const double began = drivers::seconds_of_utc(run.header.started_at);
  if (std::isfinite(ended)) out.unix_s = ended;
  out.says = fmt::format("run {} {}", run.run, run.outcome());
  if (std::isfinite(ended - began)) {
    out.says += " after " + procedures::duration_text(config::Seconds(ended - began));
  }
  if (!run.end->reason.empty()) out.says += ": " + run.end->reason;
  out.says += fmt::format("; {}; coils and heaters {}", points,
                          run.end->safe_state_reached ? "off, read back" : "NOT KNOWN TO BE OFF");
  if (!run.end->safe_state_reached) out.severity = "error";
  if (run.end->outcome == procedures::RunOutcome::kFailed) out.severity = "error";
  if (run.end->outcome == procedures::RunOutcome::kAborted) out.severity = "warning";
  return out;
}

Result<std::vector<Happened>> happened_in(record::RunLogReader& reader, const StoredRun& run) {
  const auto zero = reader.zero_unix_s(run);
  if (!zero) return zero.error();
  const auto events = reader.events(run.run);
  if (!events) return events.error();
  const auto last = reader.last_time(run.run);
  if (!last) return last.error();
  const std::string& gyro = run.header.gyro_serial_number;
  std::vector<Happened> out{
      {drivers::seconds_of_utc(run.header.started_at), run.run, gyro, "info", begin_of(run)}};
  for (const record::StoredEvent& event : *events) {
    out.push_back({*zero + event.time_s, run.run, gyro, event.severity, event.message});
  }
  out.push_back(end_of(run, *zero, *last));
  return out;
}

Result<std::vector<Happened>> history_of(record::RunLogReader& reader,
                                         const HistoryOptions& options) {
  const auto since = since_of(options.since);
  if (!since) return since.error();
  const auto runs = reader.runs();
  if (!runs) return runs.error();
  std::vector<Happened> all;
  for (const StoredRun& run : *runs) {
    if (!options.gyro.empty() && run.header.gyro_serial_number != options.gyro) continue;
    const auto its = happened_in(reader, run);
    if (!its) return its.error();
    std::copy_if(its->begin(), its->end(), std::back_inserter(all),
                 [&](const Happened& one) { return one.unix_s >= *since; });
  }
  // What one run says stays in its order.
  std::stable_sort(all.begin(), all.end(), [](const Happened& a, const Happened& b) {
    return std::floor(a.unix_s) < std::floor(b.unix_s);
  });
  return all;
}

/// "warning: " where it is one.
std::string said(const Happened& one) {
  return one.severity == "info" ? one.says : one.severity + ": " + one.says;
}

std::string text_of(const std::vector<Happened>& all) {
  std::string text, day;
  for (const Happened& one : all) {
    const std::string at = drivers::utc_text(one.unix_s);  // 2026-11-29T18:00:00Z
    if (at.substr(0, 10) != day) {
      day = at.substr(0, 10);
      text += fmt::format("{}{}, UTC\n", text.empty() ? "" : "\n", day);
    }
    text += fmt::format("  {}  {:>4}  {}\n", at.substr(11, 8), one.run, said(one));
  }
  return text;
}

std::string page_of(const std::vector<Happened>& all, const std::string& store) {
  std::string page = model::page_start("History of " + store);
  page += fmt::format(
      "<h1>History</h1>\n<p class=\"sub\">{}, until {}</p>\n<table>\n"
      "<tr><th>UTC</th><th>run</th><th>gyro</th><th>what happened</th></tr>\n",
      model::escaped(store), drivers::utc_text(machine_unix_s()));
  for (const Happened& one : all) {
    const std::string at = drivers::utc_text(one.unix_s);
    page +=
        fmt::format("<tr><td>{} {}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", at.substr(0, 10),
                    at.substr(11, 8), one.run, model::escaped(one.gyro), model::escaped(said(one)));
  }
  return page + "</table>\n" + model::page_end();
}

Result<ExitStatus> run_history(const HistoryOptions& options) {
  const auto path = store_to_read(options.store);
  if (!path) return path.error();
  auto reader = record::RunLogReader::open(*path);
  if (!reader) return reader.error();
  const auto all = history_of(**reader, options);
  if (!all) return all.error();
  if (!options.html.empty()) {
    const Status written = config::write_file(options.html, page_of(*all, path->string()));
    if (!written) return written.error();
  }
  if (options.json) {
    nlohmann::ordered_json document{{"store", path->string()},
                                    {"history", nlohmann::ordered_json::array()}};
    for (const Happened& one : *all) {
      document["history"].push_back({{"at", drivers::utc_text(one.unix_s)},
                                     {"run", one.run},
                                     {"gyro_serial_number", one.gyro},
                                     {"severity", one.severity},
                                     {"message", one.says}});
    }
    print_json(document);
  } else {
    fmt::print("{}", all->empty() ? "Nothing is on record.\n" : text_of(*all));
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_history(CLI::App& app, Action& action) {
  add_command<HistoryOptions>(
      app, action, "history", "What happened on a bench, by date and time, in sentences",
      "  fogbench history --since 12h\n"
      "  fogbench history --gyro FOG-0117 --html history.html\n"
      "Runs, their events (people, interlocks, gaps, instruments that were gone) and how they "
      "ended;\n"
      "the second column is the run. From the records alone.",
      [](CLI::App& command, HistoryOptions& options) {
        command.add_option(
            "--since", options.since,
            "From when on: 2026-11-29, 2026-11-29T18:00:00Z, or so long ago, 12h, 7d");
        command.add_option("--gyro", options.gyro, "Of this gyro alone, by its serial number");
        command.add_option("--html", options.html, "Write one self-contained page too");
        add_store_option(command, options.store);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_history);
}

}  // namespace fogbench::cli
