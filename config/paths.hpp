#pragma once
// Where the ready benches, devices, procedures, models and scenarios are, and how a short name
// finds its file.

#include <filesystem>
#include <string>

#include "config/result.hpp"

namespace fogbench::config {

/// $FOGBENCH_CONFIG_DIR; else the config folder beside the executable's build tree
/// (<exe>/../../config); else <exe>/../share/fogbench/config. kBadInput when none exists.
Result<std::filesystem::path> config_directory();

/// A file as the user named it: an existing path, or a name in config_directory()/kind
/// ("acceptance" -> procedures/acceptance.json). kBadInput with both places tried, and the names
/// that exist.
Result<std::filesystem::path> find_config(const std::string& kind, const std::string& name);

/// The file of a ready one: never a path. kBadInput with the names that exist.
Result<std::filesystem::path> find_ready(const std::string& kind, const std::string& name);

/// Their names, sorted, with commas between.
std::string ready_names(const std::string& kind);

}  // namespace fogbench::config
