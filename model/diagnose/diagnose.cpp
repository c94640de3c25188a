#include "model/diagnose/diagnose.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "model/diagnose/adequacy.hpp"
#include "model/diagnose/base_columns.hpp"
#include "model/diagnose/first_look.hpp"
#include "model/diagnose/formula_search.hpp"
#include "model/diagnose/heldout.hpp"
#include "model/diagnose/loop_choice.hpp"
#include "model/diagnose/refit_gates.hpp"
#include "model/diagnose/smooth_library.hpp"
#include "model/diagnose/thermometer.hpp"
#include "model/diagnose/working_table.hpp"
#include "model/effects/catalogue.hpp"
#include "model/fit/design.hpp"
#include "model/fit/gls.hpp"
#include "model/next/next_measurement.hpp"
#include "model/table/bad_rows.hpp"
#include "model/table/row_order.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// What was found explains the table when rows left out are missed by no more than this many noise
// floors: the rest of a fit that was made without them, and chance, take less.
constexpr double kFarFromFloor = 1.6;
// A loop takes the place of a play when rows left out are missed by less than this share, or when
// fewer effects predict them as well.
constexpr double kLoopPays = 0.85;

std::string name_of_parameter(const Candidate& candidate) {
  return candidate.parameter_name.empty() ? std::string(candidate.parameter->name)
                                          : candidate.parameter_name;
}

config::ModelFile extended_by(config::ModelFile model, const Library& library,
                              const std::vector<Found>& found) {
  for (const Found& f : found) {
    const Candidate& candidate = library.candidates[f.candidate];
    for (config::ModelTerm term : candidate.terms) {
      const bool stands = std::any_of(model.terms.begin(), model.terms.end(),
                                      [&](const auto& t) { return t.effect == term.effect; });
      if (stands) continue;
      if (candidate.parameter) {
        term.parameters[name_of_parameter(candidate)] = f.inner;
      }
      model.terms.push_back(std::move(term));
    }
  }
  return model;
}

/// A search, and what it was made with.
struct Searched {
  Searched(Library library, const NoiseShapes& shapes, const WorkingTable& table,
           const BaseColumns& base)
      : tried(std::move(library)),
        whitened(shapes, tried),
        input{whitened, table.windows(), table.bench_rows(), base.columns, base.y} {}

  const Library tried;
  const WhitenedLibrary whitened;
  const SearchInput input;
  SearchResult result;
};

/// The work of one diagnosis, part by part.
class Work {
 public:
  Work(const config::ModelFile& model, const DiagnoseOptions& options)
      : options_(options), model_(unfitted(model)) {
    if (options.quiet != nullptr) know_from(*options.quiet);
    d_.noise_source = prior_.source;
  }

  /// What was found may be all that made a reading look bad: then that one is believed, and all is
  /// asked again.
  Result<Diagnosis> run(const Table& input) {
    auto first = run_without(input, bad_readings(input, model_));
    if (!first || first->left_out.empty() || first->missing.empty()) return first;
    std::vector<LeftOut> still = bad_readings(input, unfitted(first->after.fitted));
    if (still.size() >= first->left_out.size()) return first;
    return Work(model_, options_).run_without(input, std::move(still));
  }

 private:
  std::vector<LeftOut> bad_readings(const Table& input, const config::ModelFile& model) const {
    if (input.rows() > static_cast<std::size_t>(kMostRowsToDoubt)) return {};
    auto fitted = fit(input, model, fit_options(true));
    return fitted ? std::move(fitted->left_out) : std::vector<LeftOut>{};
  }

  Result<Diagnosis> run_without(const Table& input, std::vector<LeftOut> bad) {
    tell("reading the table", 0.0);
    // A bad reading is not built on. Its other columns stay: histories run through the row.
    std::optional<Table> cleared;
    d_.left_out = std::move(bad);
    if (!d_.left_out.empty()) cleared = without_readings(input, model_.observable, d_.left_out);
    auto table = WorkingTable::make(cleared ? *cleared : input, model_, options_.quiet);
    if (!table) return table.error();
    table_ = std::move(*table);
    d_.table = table_.bench();
    d_.rows_per_bin = table_.rows_per_bin();
    d_.notes = table_.notes();
    d_.false_alarm_rate = options_.false_alarm_rate;

    tell("fitting the model and looking where it fails", 0.05);
    auto before = compare(table_.bench_with_history(), model_, fit_options(), options_.seed,
                          LookForEffects::kNo);
    if (!before) return before.error();
    d_.before = std::move(*before);

    const Signals signals(table_.fine(), model_.reference_temperature_c);
    if (has_calendar_time(signals)) d_.notes.emplace_back(kCalendarNote);
    config::ModelFile before_search = d_.before.fit.fitted;
    if (table_.has_quiet_record()) before_search.terms.push_back(quiet_bias());
    const auto base = base_columns(table_, signals, before_search);
    if (!base) return base.error();
    const auto shapes = NoiseShapes::make(table_.windows(), search_prior());
    if (!shapes) return shapes.error();

    const LibrarySource source{table_, signals, model_, options_.candidates};
    auto searched = search_in(source, *shapes, *base);
    if (!searched) return searched.error();
    look_for_loops(source, *shapes, *base, *searched);
    const SearchInput& input_of_search = (*searched)->input;
    const SearchResult& found = (*searched)->result;
    take_over(found);
    d_.not_testable = (*searched)->tried.not_testable;
    d_.judged = !found.p_of_step.empty() || found.p_outside < 1.0;
    if (!found.p_of_step.empty()) d_.p_adequate = found.p_of_step.front();
    doubt_the_thermometer(found);

    tell("looking for what has no name", 0.9);
    const MatrixXd last = base_with(input_of_search, found.found);
    if (!d_.judged) explain_by_change_of_scale();
    // On the search's own windows: a fit of few rows, or of rows without a duration, has no noise
    // coefficients.
    if (const auto noise = gls(*shapes, last, base->y);
        noise && (d_.judged || d_.missing.empty())) {
      const NoiseCoefficients& left = noise->noise.noise;
      d_.floor = noise_floor(*shapes, noise->noise, last, table_.bench_rows(), options_.seed);
      d_.noise_floor = d_.floor.beside(std::fmin(d_.after.rms, d_.ladder.back().rms));
      if (d_.table.has("time_s")) d_.noise = left;
    }
    const Library smooth = make_smooth_library(source);
    const Adequacy adequacy = check_adequacy(*shapes, last, base->y, smooth, options_.seed);
    conclude(found, adequacy);
    if (d_.verdict == Verdict::kUnexplained) suggest(source, base->columns, last, base->y);
    doubt_walk(input_of_search, smooth);
    drop_bounds_of_rivals();
    d_.next_measurements = next_measurements({d_.table, d_.after.fitted, noise_to_plan_with(),
                                              d_.ambiguous, d_.not_testable, options_.reach});
    std::erase_if(d_.notes, [&](const std::string& note) {
      const auto& said = d_.after.warnings;
      return std::find(said.begin(), said.end(), note) != said.end();
    });
    for (FitResult* fit : {&d_.before.fit, &d_.after}) fit->rows = table_.bench_rows_of(fit->rows);
    tell("done", 1.0);
    return std::move(d_);
  }

  /// All that the library offers; leaves the ladder of what was found.
  Result<std::unique_ptr<Searched>> search_in(const LibrarySource& source,
                                              const NoiseShapes& shapes, const BaseColumns& base) {
    tell("evaluating the candidates", 0.2);
    auto library = make_library(source);
    if (!library) return library.error();
    tell("searching for what is missing", 0.3);
    auto out = std::make_unique<Searched>(std::move(*library), shapes, table_, base);
    SearchOptions options;
    options.first_level = kShareOfEffects * options_.false_alarm_rate;
    options.outside_level = kShareOfShapes * options_.false_alarm_rate;
    options.seed = options_.seed;
    options.refit = [&](const std::vector<Found>& named) {
      climb_ladder(out->tried, named);
      return refused_by_refit(d_.missing, d_.ladder, out->tried);
    };
    out->result = search(out->input, options);
    return out;
  }

  /// Where rows left out pay for more than one play, searches again with that form of the loop in
  /// the play's place, and keeps what is found where it pays there too. Once more when something
  /// is found beside the loop, which its form was chosen without.
  /// A search that found one effect in one shape, and nothing beside it or in its place, has seen
  /// no such loop.
  void look_for_loops(LibrarySource source, const NoiseShapes& shapes, const BaseColumns& base,
                      std::unique_ptr<Searched>& searched) {
    if (all_is_said(searched->result)) return;
    for (int turn = 0; turn < 2; ++turn) {
      const std::vector<config::ModelTerm> before = std::exchange(source.forms, {});
      for (const std::string& effect : hystereses_of(searched->result)) {
        tell("looking for the form of a loop", 0.6);
        auto form = best_loop(effect, table_, beside(*searched, effect, turn), fit_options());
        if (form) source.forms.push_back(std::move(*form));
      }
      const auto same = [](const auto& a, const auto& b) { return a.effect == b.effect; };
      if (source.forms.empty() || std::equal(before.begin(), before.end(), source.forms.begin(),
                                             source.forms.end(), same)) {
        return;
      }
      Diagnosis last = d_;
      std::vector<FitResult> fits = fits_;
      auto looped = search_in(source, shapes, base);
      if (!looped || !loops_pay(source.forms, last)) {
        d_ = std::move(last);
        fits_ = std::move(fits);
        return;
      }
      searched = std::move(*looped);
      if (searched->result.found.size() < 2) return;
    }
  }

  bool all_is_said(const SearchResult& result) const {
    return result.refused.empty() && result.outside_shape.empty() && result.found.size() < 2 &&
           std::all_of(result.found.begin(), result.found.end(),
                       [](const Found& f) { return f.more.empty() && f.rivals.empty(); }) &&
           !(d_.ladder.back().heldout_rms > kFarFromFloor * d_.ladder.back().rms);
  }

  /// The model with what was found beside the effect. Of what depends on the same signal only the
  /// first `of_same_signal`: the others may be the rest of the loop.
  config::ModelFile beside(const Searched& searched, const std::string& effect,
                           int of_same_signal) const {
    const std::string_view signal = find_effect(effect)->info().signals.front();
    std::vector<Found> others;
    for (const Found& f : searched.result.found) {
      const Effect* known = find_effect(f.effect);
      if (known == nullptr || f.effect == effect) continue;
      const auto& needed = known->info().signals;
      const bool apart = std::find(needed.begin(), needed.end(), signal) == needed.end();
      if (apart || of_same_signal-- > 0) others.push_back(f);
    }
    return extended_by(model_, searched.tried, others);
  }

  /// A loop stands in the last fit, with weights of one sign, and rows left out are predicted
  /// clearly better than before, or as well with fewer effects.
  bool loops_pay(const std::vector<config::ModelTerm>& forms, const Diagnosis& before) const {
    const bool stands = std::any_of(forms.begin(), forms.end(), [&](const auto& form) {
      return std::any_of(d_.missing.begin(), d_.missing.end(),
                         [&](const MissingEffect& m) { return m.terms.front() == form.effect; });
    });
    const bool one_sign = std::all_of(forms.begin(), forms.end(), [&](const auto& form) {
      return of_one_sign(d_.after, form.effect);
    });
    const double share = d_.missing.size() < before.missing.size() ? 1.0 : kLoopPays;
    return stands && one_sign &&
           d_.ladder.back().heldout_rms < share * before.ladder.back().heldout_rms;
  }

  void tell(const std::string& part, double share) const {
    if (options_.progress) options_.progress(part, share);
  }

  /// Fits of the bench's rows alone know the static record by what it says of the noise. Bad rows
  /// have been cleared before; a thermometer that reads late is named beside the effects.
  FitOptions fit_options(bool doubt_rows = false) const {
    return {.weight_by = {}, .prior = prior_, .doubt_rows = doubt_rows, .doubt_lag = false};
  }
  /// The search has the record itself among its rows.
  NoisePrior search_prior() const {
    return prior_.source == NoisePrior::Source::kStaticRecord ? NoisePrior{} : prior_;
  }
  void know_from(const Table& quiet) {
    config::ModelFile still;
    still.observable = model_.observable;
    still.terms.emplace_back().effect = "bias";
    const auto fitted = fit(quiet, still, {.noise = FitOptions::Noise::kColoured, .weight_by = {}});
    if (fitted && prior_.source != NoisePrior::Source::kGiven) {
      prior_ = NoisePrior::recorded(fitted->noise);
    }
  }

  double heldout(const FitResult& fit) const {
    return heldout_rms(table_.bench_with_history(), table_.windows(), fit.fitted, fit.noise.noise);
  }

  /// Refits and predicts held-out blocks with one effect more each time. The RMS is that of least
  /// squares, so that it never rises with a term more.
  void climb_ladder(const Library& library, const std::vector<Found>& found) {
    d_.ladder.clear();
    d_.missing.clear();
    fits_.clear();
    d_.heldout_rms = heldout(d_.before.fit);
    double rms = least_squares_rms(d_.table, d_.before.fit.fitted);
    if (!std::isfinite(rms)) rms = d_.before.fit.rms;
    d_.ladder.push_back({"", rms, d_.heldout_rms});
    d_.after = d_.before.fit;
    std::vector<Found> so_far;
    for (const Found& f : found) {
      so_far.push_back(f);
      MissingEffect missing{.found = f,
                            .estimates = {},
                            .rms_after = rms,
                            .heldout_rms_after = d_.ladder.back().heldout_rms};
      const Candidate& candidate = library.candidates[f.candidate];
      const auto refit =
          fit(table_.bench_with_history(), extended_by(model_, library, so_far), fit_options());
      fits_.push_back(d_.after);
      if (refit) {
        // What this rung's columns leave at the inner values of the rung below: one fit of many.
        const config::ModelFile nested = extended_by(d_.after.fitted, library, {f});
        d_.after = *refit;
        for (const config::ModelFile& model : {refit->fitted, nested}) {
          rms = std::fmin(rms, least_squares_rms(d_.table, model));
        }
        missing.rms_after = rms;
        missing.heldout_rms_after = heldout(*refit);
      }
      d_.ladder.push_back({f.effect, missing.rms_after, missing.heldout_rms_after});
      for (const config::ModelTerm& term : candidate.terms) missing.terms.push_back(term.effect);
      d_.missing.push_back(std::move(missing));
    }
    d_.noise = d_.after.noise.noise;
    for (MissingEffect& missing : d_.missing) {
      missing.loop = loop_figures(d_.after, missing.terms.front(), d_.table);
      take_estimates(d_.after, missing);
    }
  }

  /// What the search says beside what is in the ladder already.
  void take_over(const SearchResult& found) {
    d_.bounds = found.bounds;
    d_.refused = found.refused;
    for (std::size_t i = 0; i < d_.missing.size(); ++i) {
      const Found& f = found.found[i];
      d_.missing[i].found = f;
      std::vector<std::string> set{f.effect};
      for (const Rival& r : f.rivals) set.push_back(r.effect);
      if (f.shape_leads) set.push_back(fmt::format("another effect shaped like {}", f.or_shape));
      if (set.size() > 1) d_.ambiguous.push_back(std::move(set));
    }
  }

  /// What a thermometer may do as well as an effect: read in steps, or late.
  void doubt_the_thermometer(const SearchResult& found) {
    const Table& table = table_.bench_with_history();
    if (!table.has("temperature_c")) return;
    const auto error = StepsError::of(table, d_.before.fit, table_.resolution_c());
    if (!error) return;
    if (table_.resolution_c() > 0.0) {
      blame_the_steps(*error, found);
      within_steps_ = error->explains(d_.after.residual, true);
    }
    // The run log's temperatures are freed of their sensors' lag.
    if (!table.has("temperature_start_c")) doubt_rates(error->mean_slope());
  }

  /// A thermometer that reads late makes of the model's own slope an effect of the rate.
  void doubt_rates(double slope) {
    for (const MissingEffect& m : d_.missing) {
      const Effect* known = find_effect(m.found.effect);
      if (known == nullptr || !known->info().like_a_late_thermometer) continue;
      if (m.estimates.empty()) continue;
      const auto lag_s = lag_that_does_the_same(m.estimates.front().value, slope);
      if (!lag_s) continue;
      auto set = std::find_if(d_.ambiguous.begin(), d_.ambiguous.end(),
                              [&](const auto& s) { return s.front() == m.found.effect; });
      if (set == d_.ambiguous.end()) set = d_.ambiguous.insert(set, {m.found.effect});
      set->emplace_back("thermometer_lag");
      d_.notes.push_back(
          fmt::format("A thermometer that reads {:.0f} s late would look the same as {}.", *lag_s,
                      m.found.effect));
    }
  }

  /// Drops effects, the last first, that do no more than readings which are off by half a step.
  void blame_the_steps(const StepsError& error, const SearchResult& found) {
    const double step = table_.resolution_c();
    d_.notes.push_back(
        fmt::format("The thermometer's resolution of {:g} degC is worth up to {:.2g} deg/h at the "
                    "model's slope.",
                    step, 0.5 * error.of_one_step()));
    error.widen(d_.before.regions);
    while (!d_.missing.empty() && fits_.size() == d_.missing.size() &&
           d_.after.predicted.size() == fits_.back().predicted.size()) {
      const std::string effect = d_.missing.back().found.effect;
      const Effect* known = find_effect(effect);
      const bool thermal = known != nullptr && acts_through_temperature(known->info());
      if (!error.explains(d_.after.predicted - fits_.back().predicted, thermal)) break;
      std::erase_if(d_.ambiguous, [&](const auto& set) { return set.front() == effect; });
      d_.missing.pop_back();
      d_.ladder.pop_back();
      d_.after = std::move(fits_.back());
      fits_.pop_back();
      d_.noise = d_.after.noise.noise;
      if (d_.missing.empty()) d_.p_adequate = found.p_of_step.back();
      d_.explained_by_thermometer = fmt::format("the thermometer's resolution of {:g} degC", step);
    }
  }

  /// Too few rows for a search, but two runs whose magnetic coefficients differ by one factor: the
  /// comparison's test of that needs no more than the coefficients.
  void explain_by_change_of_scale() {
    if (d_.before.changes.size() != 1 || !d_.before.changes.front().scale_changed) return;
    const std::string id = "magnetic_change_between_runs";
    std::string sum;
    for (const Estimate& e : d_.before.fit.estimates) {
      if (!is_field_sensitivity(e.name)) continue;
      sum += fmt::format("{}({:.6g}) * {} / 100", sum.empty() ? "" : " + ", e.value,
                         find_effect(e.name)->info().signals.front());
    }
    config::ModelFile wider = model_;
    config::ModelTerm term;
    term.effect = id;
    term.expression = fmt::format("(run_index >= 1) * ({})", sum);
    term.unit = "relative";
    wider.terms.push_back(std::move(term));
    const auto refit = fit(table_.bench_with_history(), wider, fit_options());
    if (!refit) return;
    d_.after = *refit;
    MissingEffect missing{.found = {.effect = id}, .terms = {id}, .estimates = {}};
    missing.found.p_value = d_.before.changes.front().p_repeat;
    missing.estimates.push_back(refit->estimates.back());
    missing.rms_after = refit->rms;
    missing.heldout_rms_after = heldout(*refit);
    d_.ladder.push_back({id, missing.rms_after, missing.heldout_rms_after});
    d_.p_adequate = missing.found.p_value;
    d_.missing.push_back(std::move(missing));
  }

  /// Without a time the noise has no coefficients: that of white noise with the same scatter in
  /// windows of three minutes, which is what a bench measures next.
  NoiseCoefficients noise_to_plan_with() const {
    constexpr double kWindowH = 180.0 / 3600.0;
    NoiseCoefficients out = d_.noise;
    const double scatter = d_.after.residual_standard_deviation;
    if (!d_.table.has("time_s") && std::isfinite(scatter)) {
      out.angle_random_walk_deg_per_sqrt_h = scatter * std::sqrt(kWindowH);
    }
    return out;
  }

  void conclude(const SearchResult& found, const Adequacy& adequacy) {
    d_.unexplained.p_value = adequacy.p_value;
    const double level =
        d_.missing.empty() ? kShareOfSmooth * options_.false_alarm_rate : kLeftBesideFound;
    const bool rough = adequacy.p_value <= level;
    const bool outside = !found.outside_shape.empty() && !within_steps_;
    const bool uneven = rough && !within_steps_;
    if (rough != uneven) {
      d_.explained_by_thermometer =
          fmt::format("the thermometer's resolution of {:g} degC", table_.resolution_c());
    }
    d_.far_from_floor = !d_.missing.empty() && !within_steps_ && std::isfinite(d_.noise_floor) &&
                        d_.missing.back().heldout_rms_after > kFarFromFloor * d_.noise_floor;
    if (uneven) d_.unexplained.depends_on = adequacy.depends_on;
    if (outside) {
      d_.unexplained.p_value = std::min(d_.unexplained.p_value, found.p_outside);
      d_.unexplained.shape = found.outside_shape;
    }
    // A range that misses by more than chance allows is left, whatever the search makes of it.
    const double p_region = d_.before.p_adequate / kShareOfRegions;
    const bool missed =
        d_.judged && d_.missing.empty() && !within_steps_ && p_region <= options_.false_alarm_rate;
    if (missed) {
      d_.unexplained.p_value = std::min(d_.unexplained.p_value, p_region);
      const std::string& variable = d_.before.regions.front().variable;
      auto& on = d_.unexplained.depends_on;
      if (!variable.empty() && std::find(on.begin(), on.end(), variable) == on.end()) {
        on.insert(on.begin(), variable);
      }
    }
    if (uneven || outside || missed || d_.far_from_floor) {
      d_.verdict = Verdict::kUnexplained;
      d_.p_adequate = std::min(d_.p_adequate, d_.unexplained.p_value);
    } else if (!d_.ambiguous.empty()) {
      d_.verdict = Verdict::kAmbiguous;
    } else if (!d_.missing.empty()) {
      d_.verdict = Verdict::kMissingEffect;
    }
  }

  /// A random walk far beyond what instruments show is not noise, but no effect either: where it
  /// would explain everything, the slow effects and the walk are one set, and a static record
  /// decides.
  void doubt_walk(const SearchInput& input, const Library& smooth) {
    const auto noise = gls(input.shapes(), input.base, input.y);
    if (!noise || !d_.judged || prior_.walk_is_noise(noise->noise) > options_.false_alarm_rate) {
      return;
    }
    NoisePrior wide = search_prior();
    wide.k_over_n = {wide.k_over_n.finding(), 1.0};
    const auto shapes = NoiseShapes::make(input.windows, wide);
    if (!shapes) return;
    if (d_.verdict != Verdict::kNothingMissing) {
      const WhitenedLibrary whitened(*shapes, input.tried());
      const SearchInput beyond{whitened, input.windows, input.bench_rows, input.base, input.y};
      const FirstLook look = look_at(beyond, smooth, options_.seed);
      const double left =
          std::min(look.p_effects / kShareOfEffects,
                   std::min(look.p_shapes / kShareOfShapes, look.p_smooth / kShareOfSmooth));
      if (!look.looked || left <= options_.false_alarm_rate) return;
    }
    const auto walk = gls(*shapes, input.base, input.y);
    if (!walk) return;
    const NoiseCoefficients& its = walk->noise.noise;
    d_.walk_beyond = its.rate_random_walk_deg_per_h_per_sqrt_h /
                     (its.angle_random_walk_deg_per_sqrt_h * prior_.k_over_n.usual_most());
    d_.p_adequate = std::min(d_.p_adequate, prior_.walk_is_noise(noise->noise));
    call_it_slow(input.tried());
  }

  /// The set of the slow effects, those that were found or else all, and the random walk.
  void call_it_slow(const Library& library) {
    d_.verdict = Verdict::kAmbiguous;
    d_.unexplained.depends_on.clear();
    d_.unexplained.suggestion.clear();
    std::erase_if(d_.missing, [&](const MissingEffect& m) {
      return !library.candidates[m.found.candidate].slow;
    });
    std::vector<std::string> set;
    for (const MissingEffect& m : d_.missing) set.push_back(m.found.effect);
    for (const Candidate& c : library.candidates) {
      if (d_.missing.empty() && c.slow && !c.shadow()) set.push_back(c.name);
    }
    set.emplace_back("random_walk");
    if (d_.missing.size() > 1) d_.missing.resize(1);
    for (MissingEffect& m : d_.missing) {
      m.found.probability = 1.0 / static_cast<double>(set.size());
      m.found.rivals.clear();
      for (std::size_t i = 1; i < set.size(); ++i) {
        m.found.rivals.push_back({set[i], m.found.probability});
      }
    }
    d_.ambiguous = {std::move(set)};
  }

  /// What may be missing is not absent.
  void drop_bounds_of_rivals() {
    std::erase_if(d_.bounds, [&](const Bound& bound) {
      return std::any_of(d_.ambiguous.begin(), d_.ambiguous.end(), [&](const auto& set) {
        return std::find(set.begin(), set.end(), bound.effect) != set.end();
      });
    });
  }

  /// A formula beside the model as it came, or beside what was found where that is clearly better.
  void suggest(const LibrarySource& source, const MatrixXd& bare, const MatrixXd& extended,
               const VectorXd& y) {
    constexpr double kClearlyBetter = 0.9;
    auto formula = search_formula(source, bare, y);
    if (!d_.missing.empty()) {
      auto other = search_formula(source, extended, y);
      if (other && (!formula || other->heldout_rms < kClearlyBetter * formula->heldout_rms)) {
        formula = std::move(other);
        d_.unexplained.beside_found = true;
      }
    }
    if (!formula) return;
    d_.unexplained.suggestion = formula->expression;
    d_.unexplained.heldout_rms = formula->heldout_rms;
  }

  const DiagnoseOptions& options_;
  const config::ModelFile model_;
  NoisePrior prior_ = options_.prior;
  WorkingTable table_;
  std::vector<FitResult> fits_;  ///< before each addition
  bool within_steps_ = false;    ///< what is left is no more than the thermometer's steps may hide
  Diagnosis d_;
};

}  // namespace

Result<Diagnosis> diagnose(const Table& table, const config::ModelFile& model,
                           const DiagnoseOptions& options) {
  return Work(model, options).run(table);
}

}  // namespace fogbench::model
