#ifdef FOGBENCH_KERNELS
// Templates of the several builds must not be taken for each other by the linker.
#define FOGBENCH_JOINED(a, b) a##b
#define FOGBENCH_NAME(a, b) FOGBENCH_JOINED(a, b)
#define Eigen FOGBENCH_NAME(Eigen, FOGBENCH_KERNELS)
#endif

#include "model/fit/kernels.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace fogbench::model {
namespace {

using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using std::ptrdiff_t;

constexpr ptrdiff_t kMostStates = Kernels::kMostStates;

void scores(const float* a, const float* b, ptrdiff_t n, ptrdiff_t p, ptrdiff_t q, float* out) {
  Map<MatrixXf>(out, p, q).noalias() =
      Map<const MatrixXf>(a, n, p).transpose() * Map<const MatrixXf>(b, n, q);
}

void project(const double* q, ptrdiff_t n, ptrdiff_t r, double* z, ptrdiff_t c) {
  const Map<const MatrixXd> basis(q, n, r);
  Map<MatrixXd> columns(z, n, c);
  const MatrixXd inside = basis.transpose() * columns;
  columns.noalias() -= basis * inside;
}

/// The number of states is known to the compiler: the loops over them are unrolled.
template <ptrdiff_t kStates>
void gains_of(const Kernels::States& states, const Kernels::Noise& noise, ptrdiff_t first,
              ptrdiff_t last, double* __restrict gain, double* __restrict deviation) {
  constexpr ptrdiff_t kTerms = kStates - 1;
  double p[kStates][kStates] = {};
  double phi[kStates], decay[kStates], p_phi[kStates], cross[kStates];
  phi[kTerms] = decay[kTerms] = 1.0;
  for (ptrdiff_t j = 0; j < kTerms; ++j) p[j][j] = noise.variance;
  for (ptrdiff_t i = first; i < last; ++i) {
    const double* end_covariance = noise.end_covariance + i * kTerms;
    for (ptrdiff_t j = 0; j < kTerms; ++j) {
      phi[j] = states.phi[i * kTerms + j];
      decay[j] = states.decay[i * kTerms + j];
      cross[j] = noise.variance * end_covariance[j];
    }
    cross[kTerms] = noise.walk_end[i];
    for (ptrdiff_t k = 0; k < kStates; ++k) p_phi[k] = 0.0;
    for (ptrdiff_t j = 0; j < kStates; ++j) {
      for (ptrdiff_t k = 0; k < kStates; ++k) p_phi[k] += phi[j] * p[j][k];
    }
    double s = noise.own[i];
    for (ptrdiff_t j = 0; j < kStates; ++j) s += phi[j] * p_phi[j];
    double* const g = gain + i * kStates;
    for (ptrdiff_t k = 0; k < kStates; ++k) {
      cross[k] += decay[k] * p_phi[k];
      g[k] = cross[k] / s;
    }
    for (ptrdiff_t j = 0; j < kStates; ++j) {
      for (ptrdiff_t k = 0; k < kStates; ++k) {
        p[j][k] = decay[j] * decay[k] * p[j][k] - cross[j] * g[k];
      }
    }
    for (ptrdiff_t j = 0; j < kTerms; ++j) p[j][j] += noise.variance * (1.0 - decay[j] * decay[j]);
    p[kTerms][kTerms] += noise.walk[i];
    deviation[i] = std::sqrt(s);
  }
}

/// One row of the filter on `kLanes` data; the states of all data lie `stride` apart.
template <ptrdiff_t kStates, ptrdiff_t kLanes>
void innovate(const double* phi, const double* decay, const double* gain, double scale, double* y,
              double* s, ptrdiff_t stride) {
  using Lanes = Eigen::Array<double, kLanes, 1>;
  Lanes states[kStates];
  Map<Lanes> data(y);
  Lanes v = data;
  for (ptrdiff_t j = 0; j < kStates; ++j) {
    states[j] = Map<const Lanes>(s + j * stride);
    v -= phi[j] * states[j];
  }
  for (ptrdiff_t j = 0; j < kStates; ++j) {
    Map<Lanes>(s + j * stride) = decay[j] * states[j] + gain[j] * v;
  }
  data = v * scale;
}

template <ptrdiff_t kStates>
void innovations_of(const Kernels::Filter& filter, ptrdiff_t first, ptrdiff_t last, ptrdiff_t count,
                    double* data) {
  constexpr ptrdiff_t kTerms = kStates - 1, kLanes = 8;
  MatrixXd states = MatrixXd::Zero(count, kStates);
  double phi[kStates], decay[kStates];
  phi[kTerms] = decay[kTerms] = 1.0;
  for (ptrdiff_t i = first; i < last; ++i) {
    std::copy_n(filter.states.phi + i * kTerms, kTerms, phi);
    std::copy_n(filter.states.decay + i * kTerms, kTerms, decay);
    const double* gain = filter.gain + i * kStates;
    const double scale = 1.0 / filter.deviation[i];
    double *y = data + i * count, *s = states.data();
    ptrdiff_t k = 0;
    for (; k + kLanes <= count; k += kLanes) {
      innovate<kStates, kLanes>(phi, decay, gain, scale, y + k, s + k, count);
    }
    for (; k < count; ++k) innovate<kStates, 1>(phi, decay, gain, scale, y + k, s + k, count);
  }
}

template <ptrdiff_t... kStates>
constexpr auto gains_for(std::integer_sequence<ptrdiff_t, kStates...>) {
  return std::array{gains_of<kStates + 1>...};
}
template <ptrdiff_t... kStates>
constexpr auto innovations_for(std::integer_sequence<ptrdiff_t, kStates...>) {
  return std::array{innovations_of<kStates + 1>...};
}
constexpr auto kCounts = std::make_integer_sequence<ptrdiff_t, kMostStates>();

void gains(const Kernels::States& states, const Kernels::Noise& noise, ptrdiff_t first,
           ptrdiff_t last, double* gain, double* deviation) {
  static constexpr auto kFor = gains_for(kCounts);
  kFor[static_cast<std::size_t>(states.terms)](states, noise, first, last, gain, deviation);
}

void innovations(const Kernels::Filter& filter, ptrdiff_t first, ptrdiff_t last, ptrdiff_t count,
                 double* data) {
  static constexpr auto kFor = innovations_for(kCounts);
  kFor[static_cast<std::size_t>(filter.states.terms)](filter, first, last, count, data);
}

constexpr Kernels kBuilt = {scores, project, gains, innovations};

}  // namespace

#ifdef FOGBENCH_KERNELS
extern const Kernels FOGBENCH_NAME(kKernels, FOGBENCH_KERNELS);
const Kernels FOGBENCH_NAME(kKernels, FOGBENCH_KERNELS) = kBuilt;
#else
#ifdef FOGBENCH_WIDE_KERNELS
extern const Kernels kKernelsAvx2, kKernelsAvx512;
#endif

std::vector<const Kernels*> all_kernels() {
  std::vector<const Kernels*> out = {&kBuilt};
#ifdef FOGBENCH_WIDE_KERNELS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) out.push_back(&kKernelsAvx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    out.push_back(&kKernelsAvx512);
  }
#endif
  return out;
}

const Kernels& kernels() {
  static const Kernels& best = *all_kernels().back();
  return best;
}
#endif

}  // namespace fogbench::model
