#pragma once
// Locks on instruments in a folder of the test's own: tests run beside each other, some of them on
// instruments of the same name.

#include <stdlib.h>

#include "tests/support/temporary_folder.hpp"

namespace fogbench::support {

class OwnLocks {
 public:
  OwnLocks() { setenv("FOGBENCH_LOCKS", folder_.path().c_str(), 1); }
  OwnLocks(const OwnLocks&) = delete;
  OwnLocks& operator=(const OwnLocks&) = delete;
  ~OwnLocks() { unsetenv("FOGBENCH_LOCKS"); }

  std::filesystem::path operator/(const std::string& name) const { return folder_.path() / name; }

 private:
  TemporaryFolder folder_;
};

}  // namespace fogbench::support
