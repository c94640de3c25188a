#pragma once
// Fits and diagnoses take large matrices and give them back thousands of times. Asked anew of the
// kernel each time, every page of them costs a fault: a fifth of a verdict's time.

#include <malloc.h>

namespace fogbench::model {

/// The process keeps the memory that it has freed, for its next matrix. For an executable's main().
inline void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // bytes; the most that glibc takes
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  mallopt(M_TOP_PAD, 16 << 20);
}

}  // namespace fogbench::model
