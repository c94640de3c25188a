#ifdef FOGBENCH_AVX2
// Templates of the two builds must not be taken for each other by the linker.
#define Eigen EigenAvx2
#endif

#include "model/fit/kernels.hpp"

#include <Eigen/Core>

namespace fogbench::model {
namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::MatrixXf;

void scores(const float* a, const float* b, std::ptrdiff_t n, std::ptrdiff_t p, std::ptrdiff_t q,
            float* out) {
  Map<MatrixXf>(out, p, q).noalias() =
      Map<const MatrixXf>(a, n, p).transpose() * Map<const MatrixXf>(b, n, q);
}

void project(const double* q, std::ptrdiff_t n, std::ptrdiff_t r, double* z, std::ptrdiff_t c) {
  const Map<const MatrixXd> basis(q, n, r);
  Map<MatrixXd> columns(z, n, c);
  const MatrixXd inside = basis.transpose() * columns;
  columns.noalias() -= basis * inside;
}

void innovations(const Kernels::Filter& filter, std::ptrdiff_t first, std::ptrdiff_t last,
                 std::ptrdiff_t count, double* data) {
  ArrayXXd states = ArrayXXd::Zero(count, filter.terms + 1);
  ArrayXd v(count);
  for (Index i = first; i < last; ++i) {
    Map<ArrayXd> y(data + i * count, count);
    const double* phi = filter.phi + i * filter.terms;
    const double* decay = filter.decay + i * filter.terms;
    const double* gain = filter.gain + i * (filter.terms + 1);
    v = y - states.col(filter.terms);
    for (Index j = 0; j < filter.terms; ++j) v -= phi[j] * states.col(j);
    for (Index j = 0; j < filter.terms; ++j) states.col(j) = decay[j] * states.col(j) + gain[j] * v;
    states.col(filter.terms) += gain[filter.terms] * v;
    y = v / filter.deviation[i];
  }
}

}  // namespace

#ifdef FOGBENCH_AVX2
extern const Kernels kAvx2Kernels;
const Kernels kAvx2Kernels = {scores, project, innovations};
#else
#ifdef FOGBENCH_HAS_AVX2
extern const Kernels kAvx2Kernels;
#endif

const Kernels& portable_kernels() {
  static const Kernels portable = {scores, project, innovations};
  return portable;
}

const Kernels& kernels() {
#ifdef FOGBENCH_HAS_AVX2
  static const bool wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (wide) return kAvx2Kernels;
#endif
  return portable_kernels();
}
#endif

}  // namespace fogbench::model
