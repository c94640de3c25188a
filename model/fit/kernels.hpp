#pragma once
// The inner loops in which fits and diagnoses spend most of their time. They are compiled twice,
// for any processor and for one with AVX2, and what the machine has is used: the results differ by
// rounding alone.

#include <cstddef>

namespace fogbench::model {

/// All matrices by columns, without gaps between them.
struct Kernels {
  /// out = a'b. a: n x p, b: n x q, out: p x q.
  void (*scores)(const float* a, const float* b, std::ptrdiff_t n, std::ptrdiff_t p,
                 std::ptrdiff_t q, float* out);
  /// z <- (I - QQ')z. Q: n x r, orthonormal; z: n x c.
  void (*project)(const double* q, std::ptrdiff_t n, std::ptrdiff_t r, double* z, std::ptrdiff_t c);
  /// Rows [first, last) of a filter in its innovations form, on `count` data at once (one a row of
  /// `data`, in place), from the states 0:
  ///   v = y - phi's,  out v/deviation,  s <- decay s + gain v
  struct Filter {
    const double *phi, *decay;  ///< terms x windows; a last state has phi = decay = 1
    const double* gain;         ///< (terms + 1) x windows
    const double* deviation;    ///< one a window
    std::ptrdiff_t terms;
  };
  void (*innovations)(const Filter& filter, std::ptrdiff_t first, std::ptrdiff_t last,
                      std::ptrdiff_t count, double* data);
};

/// For this machine, and for any.
const Kernels& kernels();
const Kernels& portable_kernels();

}  // namespace fogbench::model
