#include "record/export.hpp"

#include <fmt/format.h>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"

namespace fogbench::cli {
namespace {

struct ExportOptions {
  std::int64_t run = 0;
  std::string store;
  std::string output = "-";
  bool raw = false;
  bool unfinished = false;
};

Result<ExitStatus> run_export(const ExportOptions& options) {
  const auto path = store_to_read(options.store);
  if (!path) return path.error();
  auto reader = record::RunLogReader::open(*path);
  if (!reader) return reader.error();
  const auto run = (*reader)->run(options.run);
  if (!run) return run.error();
  const auto points = record::valid_points(**reader, options.run, options.unfinished);
  if (!points) return points.error();

  auto out = config::OutputFile::open(options.output);
  if (!out) return out.error();
  const Status written = options.raw ? record::write_gyro(**reader, *run, **out)
                                     : record::write_points(*points, **out);
  if (!written) return written.error();
  if (const Status done = (*out)->commit(); !done) return done.error();
  if (!run->completed()) {
    print_note(fmt::format("run {} was not completed ({}): this is what it has", options.run,
                           run->outcome()));
  }
  if (run->points_void > 0 && !options.raw) {
    print_note(fmt::format("{} void points left out", run->points_void));
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  add_command<ExportOptions>(
      app, action, "export", "Write a run's points, or its raw gyro stream, as CSV",
      "  fogbench export 7 -o run-7.csv\n"
      "  fogbench export 7 --raw -o run-7-raw.csv\n"
      "Numbers read back exactly; missing ones are empty. Column `run` holds the test.",
      [](CLI::App& command, ExportOptions& options) {
        add_run_option(command, options.run);
        command.add_option("-o,--output", options.output,
                           "File to write, whole or not at all (default: stdout)");
        command.add_flag("--raw", options.raw, "Every frame of the gyro instead of the points");
        command.add_flag("--unfinished", options.unfinished,
                         "Also when the run was interrupted, aborted or failed");
        add_store_option(command, options.store);
      },
      run_export);
}

}  // namespace fogbench::cli
