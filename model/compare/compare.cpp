#include "model/compare/compare.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "config/rounding.hpp"
#include "config/units.hpp"
#include "model/compare/conclusions.hpp"
#include "model/compare/partition.hpp"
#include "model/compare/region_noise.hpp"
#include "model/diagnose/first_look.hpp"

namespace fogbench::model {
namespace {

// Of what was measured: a misfit that is smaller is rounding.
constexpr double kRoundingOfMeasured = 1e-12;

/// Regions of the residual, as sums over their rows.
struct Cells {
  std::vector<Partition> partitions;
  std::vector<Eigen::Index> first;  ///< each partition's first region
  std::vector<Region> regions;
};

std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;  // splitmix64
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// Two variables often cut the rows alike (each field axis by segment); one of them is enough.
/// A partition of which every range is another's is left out.
void drop_repeated(std::vector<Partition>& partitions) {
  std::set<std::uint64_t> seen;
  std::erase_if(partitions, [&](const Partition& partition) {
    std::vector<std::uint64_t> hash(partition.ranges.size(), 0);
    for (std::size_t i = 0; i < partition.index.size(); ++i) {
      if (partition.index[i] >= 0) hash[static_cast<std::size_t>(partition.index[i])] += mix(i);
    }
    bool repeated = true;
    for (std::uint64_t h : hash) repeated = !seen.insert(h).second && repeated;
    return repeated;
  });
}

Cells make_cells(const Table& table, const FitResult& fit) {
  Cells cells;
  cells.partitions = partition_rows(table, fit.rows, fit.fitted.reference_temperature_c);
  drop_repeated(cells.partitions);
  for (const Partition& partition : cells.partitions) {
    cells.first.push_back(static_cast<Eigen::Index>(cells.regions.size()));
    const std::size_t first = cells.regions.size();
    for (const Range& range : partition.ranges) {
      cells.regions.push_back({.where = range.where,
                               .variable = partition.variable,
                               .from = range.from,
                               .to = range.to});
    }
    for (std::size_t i = 0; i < partition.index.size(); ++i) {
      if (partition.index[i] < 0) continue;
      Region& region = cells.regions[first + static_cast<std::size_t>(partition.index[i])];
      const auto row = static_cast<Eigen::Index>(i);
      ++region.rows;
      region.residual += fit.residual[row];
      region.observed += fit.residual[row] + fit.predicted[row];
    }
  }
  for (Region& region : cells.regions) {
    if (region.rows == 0) continue;
    region.residual /= static_cast<double>(region.rows);
    region.observed /= static_cast<double>(region.rows);
    region.offset = region.residual;
  }
  return cells;
}

std::string describe(const Region& region, std::string_view unit, bool noise_known) {
  const Range range{region.where, region.from, region.to};
  std::string text = fmt::format("{} the model is {} {} {} the measurements{}",
                                 place_in_words(region.variable, range),
                                 config::significant(std::abs(region.offset), 3), unit,
                                 region.offset < 0.0 ? "above" : "below",
                                 region.drift_allowed ? ", slow drift allowed for" : "");
  if (noise_known) {
    text += fmt::format(" (z = {:.1f}, {})", std::abs(region.z),
                        probability_text(region.p_family_wise));
  }
  return text + fmt::format(", {} row{}.", region.rows, region.rows == 1 ? "" : "s");
}

}  // namespace

std::string place_of(const Region& region) {
  return place_name(region.variable, {region.where, region.from, region.to});
}

Result<Comparison> compare(const Table& table, const config::ModelFile& model,
                           const FitOptions& options, std::uint64_t seed, LookForEffects look) {
  auto fitted = fit(table, model, options);
  if (!fitted) return fitted.error();
  Comparison out;
  out.fit = std::move(*fitted);
  out.as_is = options.as_is;

  Cells cells = make_cells(table, out.fit);
  auto noise = RegionNoise::make(table, options, out.fit, cells.partitions);
  if (!noise) return noise.error();
  out.noise_known = noise->known();
  out.noise_floor = kMissing;
  if (noise->known() && !noise->size_from_residual()) {
    out.floor = noise->floor();
  }

  if (noise->known()) {
    Eigen::VectorXd residual(static_cast<Eigen::Index>(cells.regions.size()));
    for (Eigen::Index g = 0; g < residual.size(); ++g) {
      residual[g] = cells.regions[static_cast<std::size_t>(g)].residual;
    }
    const Eigen::VectorXd error = noise->standard_errors();
    const RegionScores scores = noise->scores(residual, seed);
    for (Eigen::Index g = 0; g < residual.size(); ++g) {
      Region& region = cells.regions[static_cast<std::size_t>(g)];
      region.standard_error = error[g];
      region.z = scores.z[g];
      region.drift_allowed = scores.offset.size() > 0;
      if (region.drift_allowed) region.offset = scores.offset[g];
      region.p_family_wise = scores.family_wise[g];
      const double off = region.drift_allowed ? region.offset : region.residual;
      if (std::abs(off) <= kRoundingOfMeasured * std::abs(region.observed)) {
        region.z = 0.0;
        region.p_family_wise = 1.0;
      }
    }
  }
  std::erase_if(cells.regions, [](const Region& region) { return region.rows == 0; });
  std::stable_sort(cells.regions.begin(), cells.regions.end(),
                   [&](const Region& a, const Region& b) {
                     if (out.noise_known) return std::abs(a.z) > std::abs(b.z);
                     return std::abs(a.residual) > std::abs(b.residual);
                   });
  const std::string_view unit = config::unit_of(model.observable);
  for (Region& region : cells.regions) region.says = describe(region, unit, out.noise_known);
  out.regions = std::move(cells.regions);
  if (!out.regions.empty()) out.p_adequate = out.regions.front().p_family_wise;
  const bool independent =
      options.noise == FitOptions::Noise::kIndependent || !options.weight_by.empty();
  if (look == LookForEffects::kYes && !out.as_is && !independent) {
    if (const auto first = first_look(table, out.fit, options.prior); first && first->looked) {
      const double p_of_effects = first->p_value();
      const double p_of_regions = std::min(1.0, out.p_adequate / kShareOfRegions);
      if (p_of_effects < p_of_regions) out.looks_like = first->looks_like;
      out.p_adequate = std::min(p_of_effects, p_of_regions);
    }
  }

  // Beside a misfit the slow noise is the misfit's, in part: then the white part alone is sure.
  if (std::isfinite(out.floor.white)) {
    out.noise_floor = out.p_adequate < kAdequate ? out.floor.white : out.floor.beside(out.fit.rms);
  }
  conclude(out, table, model, options, noise->says());
  return out;
}

}  // namespace fogbench::model
