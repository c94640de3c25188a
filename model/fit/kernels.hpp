#pragma once
// The inner loops in which fits and diagnoses spend most of their time. They are compiled for any
// processor, for one with AVX2 and for one with AVX-512, and what the machine has is used: the
// results differ by rounding alone.

#include <cstddef>
#include <vector>

namespace fogbench::model {

/// All matrices by columns, without gaps between them.
struct Kernels {
  /// out = a'b. a: n x p, b: n x q, out: p x q.
  void (*scores)(const float* a, const float* b, std::ptrdiff_t n, std::ptrdiff_t p,
                 std::ptrdiff_t q, float* out);
  /// z <- (I - QQ')z. Q: n x r, orthonormal; z: n x c.
  void (*project)(const double* q, std::ptrdiff_t n, std::ptrdiff_t r, double* z, std::ptrdiff_t c);

  /// Of the states behind the noise of each window's mean; a last state, the walk, has
  /// phi = decay = 1. At most kMostStates of them.
  struct States {
    const double *phi, *decay;  ///< terms x windows
    std::ptrdiff_t terms;
  };
  static constexpr std::ptrdiff_t kMostStates = 10;

  /// What rows [first, last) add to the states' covariance P, which begins as `variance` for each
  /// term and 0 for the walk, and from it the filter of a run in its innovations form:
  ///   S = phi'P phi + own,  c = decay P phi + with_end,  gain = c/S,  deviation = sqrt S,
  ///   P <- decay P decay - c c'/S + what decayed, renewed
  struct Noise {
    double variance;                ///< of each term
    const double* own;              ///< of the window's mean, beside what the states bring
    const double* end_covariance;   ///< of mean and next state: terms x windows, per variance
    const double *walk_end, *walk;  ///< the same of the walk; what the walk's variance grows by
  };
  void (*gains)(const States& states, const Noise& noise, std::ptrdiff_t first, std::ptrdiff_t last,
                double* gain, double* deviation);

  /// Rows [first, last) of that filter on `count` data at once (one a row of `data`, in place),
  /// from the states 0:
  ///   v = y - phi's,  out v/deviation,  s <- decay s + gain v
  struct Filter {
    States states;
    const double* gain;       ///< (terms + 1) x windows
    const double* deviation;  ///< one a window
  };
  void (*innovations)(const Filter& filter, std::ptrdiff_t first, std::ptrdiff_t last,
                      std::ptrdiff_t count, double* data);
};

/// The best for this machine.
const Kernels& kernels();
/// Each that this machine can run, the one for any machine first.
std::vector<const Kernels*> all_kernels();

}  // namespace fogbench::model
