// How often is the diagnosis right? Asks it thousands of tables with a known truth, beside the
// usual ways to choose terms, and writes the figures as a Markdown page.
//
//   diagnosis_study [--part NAME] [--only TEXT] [--trials N] [--first N] [--threads N]
//                   [--no-baselines] [--records FILE.tsv] [--page FILE.md] [--table FILE.csv]
//   diagnosis_study --from FILE.tsv [--page FILE.md]      the page alone, from kept records
//
// --only keeps the cases whose name holds the text; --first begins at that trial number, so that
// one trial can be repeated; --table writes that trial's table (and FILE.csv.json, its model).

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <thread>

#include "model/fit/heap.hpp"
#include "model/table/write_csv.hpp"
#include "tests/benchmark/study_cases.hpp"
#include "tests/benchmark/study_report.hpp"

namespace {

using namespace fogbench;
using namespace fogbench::tests;

struct Options {
  std::string part, only, records, page, table;
  std::vector<std::string> from;
  std::uint64_t trials = 10, first = 0;
  unsigned threads = 2;
  bool baselines = true;
};

Options parse_options(int argc, char** argv) {
  Options out;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--no-baselines") {
      out.baselines = false;
      continue;
    }
    if (i + 1 == argc) {
      fmt::print(stderr, "{}: a value is expected after it\n", name);
      std::exit(2);
    }
    const std::string value = argv[++i];
    if (name == "--part") {
      out.part = value;
    } else if (name == "--only") {
      out.only = value;
    } else if (name == "--records") {
      out.records = value;
    } else if (name == "--page") {
      out.page = value;
    } else if (name == "--table") {
      out.table = value;
    } else if (name == "--from") {
      out.from.push_back(value);
    } else if (name == "--trials") {
      out.trials = std::strtoull(value.c_str(), nullptr, 10);
    } else if (name == "--first") {
      out.first = std::strtoull(value.c_str(), nullptr, 10);
    } else if (name == "--threads") {
      out.threads = static_cast<unsigned>(std::strtoul(value.c_str(), nullptr, 10));
    } else {
      fmt::print(stderr, "{}: unknown option\n", name);
      std::exit(2);
    }
  }
  return out;
}

struct Task {
  DiagnosisCase what;
  std::uint64_t number;
};

/// Trial by trial, the cases of each in an order of chance: a study that was cut short is a fair
/// sample of the whole.
std::vector<Task> tasks_of(const Options& options) {
  std::vector<Task> out;
  for (std::uint64_t i = 0; i < options.trials; ++i) {
    const std::size_t begin = out.size();
    for (const DiagnosisCase& what : study_cases()) {
      if (!options.part.empty() && what.part != options.part) continue;
      if (what.name().find(options.only) == std::string::npos) continue;
      out.push_back({what, options.first + i});
    }
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(),
              [](const Task& a, const Task& b) {
                return seed_of(a.what, a.number) < seed_of(b.what, b.number);
              });
  }
  return out;
}

void write_table(const Task& task, const std::string& file) {
  TrialMaker maker;
  const Trial trial = maker.make(task.what, task.number);
  std::ofstream(file + ".json") << config::to_json_text(trial.model);
  const Status written = model::write_csv(trial.table, file);
  if (!written) fmt::print(stderr, "{}\n", written.error().message);
  for (const ForeignEffect& effect : trial.hidden) {
    fmt::print("hidden: {} amplitude {:g} inner {:g} phase {:g}\n", effect.id, effect.amplitude,
               effect.inner, effect.phase);
  }
}

std::vector<Record> run(const std::vector<Task>& tasks, const Options& options) {
  TrialMaker maker;
  std::vector<Record> records(tasks.size());
  std::atomic<std::size_t> next = 0;
  std::mutex printing;
  std::ofstream kept;
  if (!options.records.empty()) kept.open(options.records, std::ios::app);
  const auto work = [&] {
    for (std::size_t i = next++; i < tasks.size(); i = next++) {
      records[i] = run_trial(maker, tasks[i].what, tasks[i].number, options.baselines);
      const std::lock_guard lock(printing);
      if (kept) kept << to_line(records[i]) << std::endl;
      fmt::print("{:5}/{} {:5.2f} s  {} #{} ({:.4g}, rho {:.2f})  [{}]  {}\n", i + 1, tasks.size(),
                 records[i].seconds, tasks[i].what.name(), tasks[i].number, records[i].inner,
                 records[i].cosine, name_of(records[i].outcome), records[i].says);
      std::fflush(stdout);
    }
  };
  std::vector<std::thread> workers;
  for (unsigned i = 0; i < options.threads; ++i) workers.emplace_back(work);
  for (std::thread& worker : workers) worker.join();
  return records;
}

}  // namespace

int main(int argc, char** argv) {
  fogbench::model::keep_freed_memory();
  const Options options = parse_options(argc, argv);
  std::vector<Record> records;
  for (const std::string& file : options.from) {
    const auto more = read_records(file);
    if (!more) {
      fmt::print(stderr, "{}\n", more.error().message);
      return 3;
    }
    records.insert(records.end(), more->begin(), more->end());
  }
  if (options.from.empty()) {
    const std::vector<Task> tasks = tasks_of(options);
    if (tasks.empty()) {
      fmt::print(stderr, "no case of that name\n");
      return 2;
    }
    if (!options.table.empty()) {
      write_table(tasks.front(), options.table);
      return 0;
    }
    records = run(tasks, options);
    fmt::print(stderr, "{}", times_text(records));
  }
  std::string command = "diagnosis_study";
  for (int i = 1; i < argc; ++i) command += fmt::format(" {}", argv[i]);
  if (options.page.empty()) {
    fmt::print("{}", study_page(records, command));
  } else {
    std::ofstream(options.page) << study_page(records, command);
  }
}
