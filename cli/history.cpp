// fogbench history: what happened on a bench, by the calendar, in sentences: from the records
// alone, those of its runs and that of the bench itself.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "cli/page_file.hpp"
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
  std::int64_t run = 0;  ///< 0: in none
  std::string gyro;
  std::string severity;  ///< as of events: info, warning, error
  std::string says;
};

double machine_unix_s() {
  return std::chrono::duration<double>(drivers::SteadyClock().wall_now().time_since_epoch())
      .count();
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
      fmt::format("{} point{}{}", run.points, run.points == 1 ? "" : "s",
                  run.points_void == 0 ? "" : fmt::format(", {} of them void", run.points_void));
  Happened out{zero_unix_s + last_s, run.run, run.header.gyro_serial_number, "info", {}};
  if (!run.end) {
    out.severity = run.under_way ? "info" : "warning";
    out.says = run.under_way
                   ? fmt::format("run {} is under way: {} so far", run.run, points)
                   : fmt::format("run {} was interrupted: {}; nothing is on record after this",
                                 run.run, points);
    return out;
  }
  if (run.end->outcome == procedures::RunOutcome::kInterrupted) {
    out.severity = "warning";
    out.says = fmt::format("run {} was interrupted: {}; it has no end of its own ({})", run.run,
                           points, run.end->reason);
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

/// A run in a line of its own.
struct Summary {
  const StoredRun* run;
  std::string ended_at;  ///< empty: it has no end of its own
};

struct History {
  std::vector<StoredRun> runs;
  std::vector<Summary> summaries;  ///< of the runs that something is told of
  std::vector<Happened> all;
};

/// An event's sentence; the job that a run was is in its data only.
std::string said_of(const record::StoredEvent& event) {
  const auto data = nlohmann::json::parse(event.data_json, nullptr, /*allow_exceptions=*/false);
  if (!data.is_object() || !data.contains("job")) return event.message;
  return fmt::format("{} (job {})", event.message, data["job"].dump());
}

Result<std::vector<Happened>> happened_in(record::RunLogReader& reader, const StoredRun& run) {
  const auto zero = reader.zero_unix_s(run);
  if (!zero) return zero.error();
  const auto events = reader.events(run.run);
  if (!events) return events.error();
  const auto last = reader.last_time(run.run);
  if (!last) return last.error();
  const std::string& gyro = run.header.gyro_serial_number;
  const double began = drivers::seconds_of_utc(run.header.started_at);
  std::vector<Happened> out{{began, run.run, gyro, "info", begin_of(run)}};
  for (const record::StoredEvent& event : *events) {
    // What is written with the run's begin has no time of its own.
    const double unix_s = std::max(*zero + event.time_s, began);
    out.push_back({unix_s, run.run, gyro, event.severity, said_of(event)});
  }
  out.push_back(end_of(run, *zero, *last));
  return out;
}

Result<History> history_of(record::RunLogReader& reader, const HistoryOptions& options) {
  double since = -std::numeric_limits<double>::infinity();
  if (!options.since.empty()) {
    const auto moment = parse_moment("--since", options.since);
    if (!moment) return moment.error();
    since = *moment;
  }
  auto runs = reader.runs();
  if (!runs) return runs.error();
  History history;
  history.runs = std::move(*runs);
  const auto bench_events = reader.bench_events();
  if (!bench_events) return bench_events.error();
  for (const record::StoredBenchEvent& event : *bench_events) {
    const std::string& gyro = event.gyro_serial_number;
    if (event.unix_s < since || (!options.gyro.empty() && !gyro.empty() && gyro != options.gyro)) {
      continue;
    }
    history.all.push_back({event.unix_s, 0, gyro, event.severity, event.message});
  }
  for (const StoredRun& run : history.runs) {
    if (!options.gyro.empty() && run.header.gyro_serial_number != options.gyro) continue;
    const auto its = happened_in(reader, run);
    if (!its) return its.error();
    const std::size_t before = history.all.size();
    std::copy_if(its->begin(), its->end(), std::back_inserter(history.all),
                 [&](const Happened& one) { return one.unix_s >= since; });
    if (history.all.size() == before) continue;
    history.summaries.push_back({&run, run.end ? run.end->ended_at : std::string()});
  }
  // What one run says stays in its order; what led to a run stands before it.
  std::stable_sort(history.all.begin(), history.all.end(),
                   [](const Happened& a, const Happened& b) {
                     return std::floor(a.unix_s) < std::floor(b.unix_s);
                   });
  return history;
}

/// "warning: " where it is one.
std::string said(const Happened& one) {
  return one.severity == "info" ? one.says : one.severity + ": " + one.says;
}

std::string number_of(std::int64_t run) {
  return run == 0 ? "-" : std::to_string(run);
}

constexpr const char* kSummaryHeads[] = {"run",        "procedure",  "gyro",   "asked for by",
                                         "began, UTC", "ended, UTC", "points", "outcome"};

std::vector<std::string> cells_of(const Summary& summary) {
  const procedures::RunHeader& header = summary.run->header;
  return {std::to_string(summary.run->run),
          header.procedure,
          header.gyro_serial_number,
          header.operator_name.empty() ? "-" : header.operator_name,
          header.started_at,
          summary.ended_at.empty() ? "-" : summary.ended_at,
          std::to_string(summary.run->points - summary.run->points_void),
          summary.run->outcome()};
}

std::string text_of(const History& history) {
  std::string text, day;
  for (const Happened& one : history.all) {
    const std::string at = drivers::utc_text(one.unix_s);  // 2026-11-29T18:00:00Z
    if (at.substr(0, 10) != day) {
      day = at.substr(0, 10);
      text += fmt::format("{}{}, UTC\n", text.empty() ? "" : "\n", day);
    }
    text += fmt::format("  {}  {:>4}  {}\n", at.substr(11, 8), number_of(one.run), said(one));
  }
  if (history.summaries.empty()) return text;
  using Align = TextTable::Align;
  std::vector<TextTable::Column> columns;
  for (const char* head : kSummaryHeads) {
    const std::string name = head;
    columns.push_back({name, "", name == "run" || name == "points" ? Align::kRight : Align::kLeft});
  }
  TextTable table(std::move(columns));
  for (const Summary& summary : history.summaries) table.add_row(cells_of(summary));
  return text + "\n" + table.text();
}

std::string page_of(const History& history, const std::string& store) {
  const auto row = [](const auto& cells, const char* tag) {
    std::string html = "<tr>";
    for (const auto& cell : cells) {
      html += fmt::format("<{0}>{1}</{0}>", tag, model::escaped(cell));
    }
    return html + "</tr>\n";
  };
  using Cells = std::vector<std::string>;
  std::string page = model::page_start("History of " + store);
  page += fmt::format("<h1>History</h1>\n<p class=\"sub\">{}, until {}</p>\n",
                      model::escaped(store), drivers::utc_text(machine_unix_s()));
  if (!history.summaries.empty()) {
    page += "<h2>Runs</h2>\n<table class=\"words\">\n";
    page += row(Cells(std::begin(kSummaryHeads), std::end(kSummaryHeads)), "th");
    for (const Summary& summary : history.summaries) page += row(cells_of(summary), "td");
    page += "</table>\n";
  }
  page += "<h2>What happened</h2>\n<table class=\"words\">\n" +
          row(Cells{"UTC", "run", "gyro", "what"}, "th");
  for (const Happened& one : history.all) {
    const std::string at = drivers::utc_text(one.unix_s);
    page += row(
        Cells{at.substr(0, 10) + " " + at.substr(11, 8), number_of(one.run), one.gyro, said(one)},
        "td");
  }
  return page + "</table>\n" + model::page_end();
}

nlohmann::ordered_json json_of(const History& history, const std::string& store) {
  using nlohmann::ordered_json;
  ordered_json document{
      {"store", store}, {"runs", ordered_json::array()}, {"history", ordered_json::array()}};
  for (const Summary& summary : history.summaries) {
    const procedures::RunHeader& header = summary.run->header;
    document["runs"].push_back(
        {{"run", summary.run->run},
         {"procedure", header.procedure},
         {"gyro_serial_number", header.gyro_serial_number},
         {"operator_name", header.operator_name},
         {"bench", header.bench},
         {"started_at", header.started_at},
         {"ended_at", summary.ended_at.empty() ? ordered_json() : ordered_json(summary.ended_at)},
         {"outcome", summary.run->outcome()},
         {"points", summary.run->points},
         {"points_void", summary.run->points_void}});
  }
  for (const Happened& one : history.all) {
    document["history"].push_back({{"at", drivers::utc_text(one.unix_s)},
                                   {"run", one.run == 0 ? ordered_json() : ordered_json(one.run)},
                                   {"gyro_serial_number", one.gyro},
                                   {"severity", one.severity},
                                   {"message", one.says}});
  }
  return document;
}

Result<ExitStatus> run_history(const HistoryOptions& options) {
  const auto path = store_to_read(options.store);
  if (!path) return path.error();
  auto reader = record::RunLogReader::open(*path);
  if (!reader) return reader.error();
  const auto history = history_of(**reader, options);
  if (!history) return history.error();
  if (!options.html.empty()) {
    auto page = PageFile::open(options.html);
    if (!page) return page.error();
    const Status written = page->write(page_of(*history, path->string()));
    if (!written) return written.error();
  }
  if (options.json) {
    print_json(json_of(*history, path->string()));
  } else {
    fmt::print("{}", history->all.empty() ? "Nothing is on record.\n" : text_of(*history));
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_history(CLI::App& app, Action& action) {
  add_command<HistoryOptions>(
      app, action, "history", "What happened on a bench, by date and time, in sentences",
      "  fogbench history --since 12h\n"
      "  fogbench history --gyro FOG-0117 --html history.html\n"
      "Runs, their events (prompts and answers, people, interlocks, gaps, instruments that were "
      "gone) and\n"
      "how they ended; and what happened in none: the queue, refusals, the daemon's starts and "
      "stops.\n"
      "The second column is the run, the table at the end lists the runs. From the records alone.",
      [](CLI::App& command, HistoryOptions& options) {
        command.add_option(
            "--since", options.since,
            "From when on: 2026-11-29, 2026-11-29T18:00:00Z, or so long ago, 40min, 12h, 7d");
        command.add_option("--gyro", options.gyro, "Of this gyro alone, by its serial number");
        command.add_option(
            "--html", options.html,
            "Write one self-contained page too, or its print when the name ends with "
            ".pdf");
        add_store_option(command, options.store);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_history);
}

}  // namespace fogbench::cli
