#include "tests/support/source_tree.hpp"

namespace fogbench::tests {

std::filesystem::path source_tree() {
  return FOGBENCH_SOURCE_DIR;
}
std::filesystem::path build_tree() {
  return FOGBENCH_BINARY_DIR;
}

}  // namespace fogbench::tests
