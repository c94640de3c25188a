#include "model/diagnose/whitened_library.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::size_t kMostBytes = 400'000'000;

}  // namespace

WhitenedLibrary::WhitenedLibrary(const NoiseShapes& shapes, const Library& library)
    : shapes_(shapes), library_(library) {
  std::vector<Index> columns;
  for (const Candidate& candidate : library.candidates) {
    if (candidate.blocks.empty()) continue;
    const std::size_t last = candidate.blocks.size() - 1;
    for (std::size_t i = 0; i <= last; ++i) {
      if (i != 0 && i != last / 2 && i != last) continue;
      Block block = candidate.blocks[i];
      for (Index column = 0; column < block.width; ++column) {
        columns.push_back(block.first + column);
      }
      block.first = std::ssize(columns) - block.width;
      sample_.push_back(block);
    }
  }
  sampled_ = library.columns(Eigen::all, columns);
}

std::shared_ptr<const MatrixXd> WhitenedLibrary::under(const NoiseCoefficients& shape,
                                                       const Whitener& whitener) const {
  const std::pair key{shape.bias_instability_deg_per_h,
                      shape.rate_random_walk_deg_per_h_per_sqrt_h};
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = kept_.find(key); known != kept_.end()) return known->second;
  }
  auto made = std::make_shared<const MatrixXd>(whitener.whiten(library_.columns));
  const std::size_t size = sizeof(double) * static_cast<std::size_t>(made->size());
  const std::lock_guard lock(mutex_);
  if (!kept_.contains(key) && bytes_ + size <= kMostBytes) {
    kept_[key] = made;
    bytes_ += size;
  }
  return made;
}

}  // namespace fogbench::model
