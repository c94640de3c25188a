#pragma once
// Options that several commands share.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "daemon/session.hpp"

namespace fogbench::cli {

/// --store FILE.
void add_store_option(CLI::App& command, std::string& store);
/// The store as named, or the default one: where a command writes.
Result<std::filesystem::path> store_path(const std::string& store);
/// The store as named, else the default one if it is there, else that of the daemon that serves
/// here: where a command reads. Says so when a daemon writes elsewhere.
Result<std::filesystem::path> store_to_read(const std::string& store);

/// " --store FILE" for a command that is proposed next; empty when the default one serves.
std::string store_argument(const std::string& store);

/// Why a text is no run's number; empty when it is one.
std::string wrong_run_number(const std::string& text);
/// RUN, the number of one run.
void add_run_option(CLI::App& command, std::int64_t& run);

/// PROCEDURE, --bench and --set name=value.
struct ProcedureOptions {
  std::string procedure;
  std::string bench = daemon::SetupOptions{}.bench;
  std::vector<std::string> set;
};
void add_procedure_options(CLI::App& command, ProcedureOptions& options);

/// The program's arguments; a list that blanks after --set have taken apart, as in
/// --set levels=0, 50, 100, is one again, and so is a length of time, as in --average 60 s.
std::vector<std::string> arguments_with_lists(int argc, char** argv);

/// "name=1.5" or "name=31,35,40", blanks around numbers allowed. kUsage for anything else.
Result<daemon::Parameters> parse_parameters(const std::vector<std::string>& set);

/// --gyro-on-since WHEN, for parse_moment.
CLI::Option* add_gyro_on_since_option(CLI::App& command, std::string& moment);

/// A moment, Unix time in s: "2026-11-29" (its midnight, UTC), "2026-11-29T18:00:00Z", or so long
/// before now: "40min", "12h", "7d". kUsage, which names `option`, for anything else.
Result<double> parse_moment(const std::string& option, const std::string& text);

}  // namespace fogbench::cli
