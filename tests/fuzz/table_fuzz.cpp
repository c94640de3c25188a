// A file of another program that holds anything at all, read as a table: text in any encoding and
// dialect, packed or not, MATLAB or HDF5, as its first bytes say.

#include <sys/mman.h>
#include <unistd.h>

#include <cmath>

#include "model/table/doubts.hpp"
#include "model/table/inspection.hpp"
#include "model/table/read_table.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;  // NOLINT(google-build-using-namespace)
  const int memory = memfd_create("table", 0);
  fuzz::require(memory >= 0 && ::write(memory, data, size) == static_cast<ssize_t>(size));
  // Not /proc/self: a reader in a process of its own has another self.
  const std::string path = "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(memory);
  for (const std::size_t most_rows : {model::kEveryRow, std::size_t{8}}) {
    const auto table = model::read_table(path, {.most_rows = most_rows});
    if (!table) {
      fuzz::require(table.error().message.find('\n') == std::string::npos);
      fuzz::require(table.error().message.starts_with(path));
      continue;
    }
    fuzz::require(table->rows() > 0);
    for (const std::string& name : table->column_names()) {
      for (const double value : table->column(name)) fuzz::require(!std::isinf(value));
    }
    (void)model::doubts(*table);
    (void)model::inspect(*table);
  }
  ::close(memory);
  return 0;
}
