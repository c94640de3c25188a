#include "config/paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <vector>

#include "config/nearest_name.hpp"

namespace fogbench::config {
namespace fs = std::filesystem;

namespace {

/// In order of the alphabet.
std::vector<std::string> names_in(const fs::path& folder) {
  std::error_code error;
  std::vector<std::string> known;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == ".json") known.push_back(entry->path().stem().string());
  }
  std::sort(known.begin(), known.end());
  return known;
}

/// "none of the ready scenarios (...)", and which of them was probably meant by `name`.
std::string none_of_ready(const fs::path& folder, std::string_view name) {
  const std::vector<std::string> known = names_in(folder);
  return fmt::format("none of the ready {} ({}){}", folder.filename().string(),
                     fmt::join(known, ", "), did_you_mean(name, {known.begin(), known.end()}));
}

}  // namespace

Result<fs::path> config_directory() {
  if (const char* set = std::getenv("FOGBENCH_CONFIG_DIR")) {  // NOLINT(concurrency-mt-unsafe)
    std::error_code ignored;
    if (fs::is_directory(set, ignored)) return fs::path(set);
    return Error{ErrorCode::kBadInput,
                 fmt::format("FOGBENCH_CONFIG_DIR={}: no such directory", set)};
  }
  std::error_code error;
  const fs::path executable = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    const fs::path folder = executable.parent_path();
    for (const fs::path& candidate :
         {folder / "../../config", folder / "../share/fogbench/config"}) {
      if (!fs::is_directory(candidate / "benches", error)) continue;
      const fs::path plain = fs::weakly_canonical(candidate, error);
      return error ? candidate : plain;
    }
  }
  return Error{ErrorCode::kBadInput,
               "the folder with fogbench's ready configuration was not found beside the program; "
               "name it in FOGBENCH_CONFIG_DIR"};
}

std::string ready_names(const std::string& kind) {
  const auto directory = config_directory();
  if (!directory) return "";
  return fmt::format("{}", fmt::join(names_in(*directory / kind), ", "));
}

Result<fs::path> find_ready(const std::string& kind, const std::string& name) {
  const auto directory = config_directory();
  if (!directory) return directory.error();
  const fs::path folder = *directory / kind;
  const fs::path candidate = folder / (name + ".json");
  std::error_code error;
  const bool plain = name.find('/') == std::string::npos;
  if (plain && fs::is_regular_file(candidate, error)) return candidate;
  return Error{ErrorCode::kBadInput, fmt::format("{}: {}", name, none_of_ready(folder, name))};
}

Result<fs::path> find_config(const std::string& kind, const std::string& name) {
  std::error_code error;
  if (fs::is_regular_file(name, error)) return fs::path(name);
  const auto directory = config_directory();
  if (!directory) return directory.error();
  auto ready = find_ready(kind, name);
  if (ready) return ready;

  if (const fs::file_status status = fs::status(name, error); fs::exists(status)) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: is {}, a file was expected", name,
                             fs::is_directory(status) ? "a directory" : "not a regular file")};
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    return Error{ErrorCode::kBadInput, fmt::format("{}: {}", name, error.message())};
  }

  return Error{ErrorCode::kBadInput, fmt::format("{}: no such file, and {}", name,
                                                 none_of_ready(*directory / kind, name))};
}

}  // namespace fogbench::config
