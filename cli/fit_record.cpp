#include "cli/fit_record.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <system_error>

#include "daemon/file_hash.hpp"
#include "drivers/clock.hpp"

namespace fogbench::cli {

Status sign(config::FitRecord& record, const DataOptions& data) {
  for (const std::string& name : data.data) {
    record.data += (record.data.empty() ? "" : ", ") + name;
    std::error_code ignored;  // what is no file is a run of the store
    if (!std::filesystem::is_regular_file(name, ignored)) continue;
    const Result<std::string> hash = daemon::file_sha256(name);
    if (!hash) return hash.error();
    record.data_sha256 += (record.data_sha256.empty() ? "" : ", ") + *hash;
  }
  const auto now = std::chrono::floor<std::chrono::seconds>(drivers::SteadyClock().wall_now());
  record.fitted_at = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
  record.software_version = FOGBENCH_VERSION;
  return {};
}

}  // namespace fogbench::cli
