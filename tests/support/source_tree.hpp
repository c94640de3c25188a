#pragma once

#include <filesystem>

namespace fogbench::tests {

/// The project's folder, for tests that read its files.
std::filesystem::path source_tree();
/// The build folder, where the executables are.
std::filesystem::path build_tree();

}  // namespace fogbench::tests
