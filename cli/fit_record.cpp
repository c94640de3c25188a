#include "cli/fit_record.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <system_error>

#include "cli/common_options.hpp"
#include "drivers/clock.hpp"
#include "record/file_hash.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::cli {

namespace {

/// Of a file its hash, of a run the one of its raw data; empty when it has none yet.
Result<std::string> hash_of_data(const std::string& name, const DataOptions& data) {
  const auto stored = run_in_store(name, data);
  if (!stored) {
    std::error_code ignored;  // a pipe cannot be read twice
    const std::string file = file_of(name);
    if (!std::filesystem::is_regular_file(file, ignored)) return std::string();
    return record::file_sha256(file);
  }
  const auto path = store_to_read(stored->store);
  if (!path) return path.error();
  auto reader = record::RunLogReader::open(*path);
  if (!reader) return reader.error();
  return (*reader)->raw_sha256(stored->run);
}

}  // namespace

Status sign(config::FitRecord& record, const DataOptions& data,
            const std::vector<std::string>& read_as) {
  for (const std::string& name : data.data) {
    record.data += (record.data.empty() ? "" : ", ") + name;
    const Result<std::string> hash = hash_of_data(name, data);
    if (!hash) return hash.error();
    if (hash->empty()) continue;
    record.data_sha256 += (record.data_sha256.empty() ? "" : ", ") + *hash;
  }
  record.read_as = read_as;
  const auto now = std::chrono::floor<std::chrono::seconds>(drivers::SteadyClock().wall_now());
  record.fitted_at = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
  record.software_version = FOGBENCH_VERSION;
  return {};
}

}  // namespace fogbench::cli
