#include "model/diagnose/first_look.hpp"

#include <optional>

#include "model/diagnose/adequacy.hpp"
#include "model/diagnose/base_columns.hpp"
#include "model/diagnose/smooth_library.hpp"
#include "model/diagnose/stage.hpp"
#include "model/fit/gls.hpp"

namespace fogbench::model {

FirstLook look_at(const SearchInput& input, const Library& smooth, std::uint64_t seed) {
  FirstLook out;
  if (input.y.size() - input.base.cols() < kFewestFreeRows) return out;
  const Stage stage(input, input.base, seed);
  out.looked = true;
  if (!stage.effects().empty()) {
    const Eigen::Index leader = stage.leader({});
    out.p_effects = stage.p_value(leader);
    out.looks_like = stage.candidate(leader).name;
  }
  if (!stage.shadows().empty()) {
    const Eigen::Index best = stage.best(stage.shadows());
    out.p_shapes = stage.p_value(best);
    if (out.p_shapes / kShareOfShapes < out.p_effects / kShareOfEffects) {
      out.looks_like = stage.candidate(best).name;
    }
  }
  const Adequacy adequacy = check_adequacy(input.shapes(), input.base, input.y, smooth, seed);
  out.p_smooth = adequacy.p_value;
  const double others = std::min(out.p_effects / kShareOfEffects, out.p_shapes / kShareOfShapes);
  if (out.p_smooth / kShareOfSmooth < others && !adequacy.depends_on.empty()) {
    out.looks_like = "something that depends on " + adequacy.depends_on.front();
  }
  if (const auto noise = gls(input.shapes(), input.base, input.y)) {
    out.p_walk = input.shapes().prior().walk_is_noise(noise->noise);
    constexpr double kStandsOut = 0.05;  // an effect that does is the better hint
    if (out.p_walk < kStandsOut && std::min(others, out.p_smooth / kShareOfSmooth) > kStandsOut) {
      out.looks_like = "a slow effect, or a random walk far beyond that of such gyros";
    }
  }
  return out;
}

Result<FirstLook> first_look(const Table& table, const FitResult& fit, const NoisePrior& prior) {
  const config::ModelFile& fitted = fit.fitted;
  std::optional<Table> believed;
  if (!fit.left_out.empty()) {
    believed = without_readings(table, fitted.observable, fit.left_out);
  }
  const auto working = WorkingTable::make(believed ? *believed : table, fitted, nullptr);
  if (!working) return working.error();
  const Signals signals(working->fine(), fitted.reference_temperature_c);
  const auto base = base_columns(*working, signals, fitted);
  if (!base) return base.error();
  const auto shapes = NoiseShapes::make(working->windows(), prior);
  if (!shapes) return shapes.error();
  const std::vector<config::ModelTerm> none;
  const LibrarySource source{*working, signals, fitted, none};
  const auto library = make_library(source);
  if (!library) return library.error();
  const WhitenedLibrary whitened(*shapes, *library);
  const SearchInput input{whitened, working->windows(), working->bench_rows(), base->columns,
                          base->y};
  return look_at(input, make_smooth_library(source), SearchOptions{}.seed);
}

}  // namespace fogbench::model
