#include "model/diagnose/verdict_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "config/rounding.hpp"
#include "config/units.hpp"
#include "model/compare/conclusions.hpp"

namespace fogbench::model {
namespace {

std::string enumerated(const std::vector<std::string>& items, std::string_view between = ", ") {
  return fmt::format("{}", fmt::join(items, between));
}

std::string number(double value) {
  return config::significant(value, 3);
}

std::string names_found(const Diagnosis& d) {
  std::vector<std::string> names;
  for (const MissingEffect& m : d.missing) names.push_back(m.found.effect);
  return enumerated(names);
}

/// "0.012 +- 0.001 deg/h"; without an uncertainty where it is not known.
std::string value_text(const Estimate& e) {
  const double uncertainty = e.coverage_factor * e.standard_error;
  if (!std::isfinite(uncertainty)) return fmt::format("{} {}", number(e.value), e.unit);
  const config::Rounded r = config::rounded(e.value, uncertainty);
  return fmt::format("{} +- {} {}", r.value, r.uncertainty, e.unit);
}

/// "remanence = 0.012 +- 0.001 deg/h, coercive field = 31 +- 2 uT".
std::string loop_text(const LoopFigures& loop) {
  std::vector<std::string> parts;
  for (const Estimate* e : {&loop.remanence, &loop.coercive}) {
    parts.push_back(e->name + " = " +
                    (std::isfinite(e->value) ? value_text(*e) : "not determined"));
  }
  return enumerated(parts);
}

/// Whether the effect is in the model in another form, whose coefficients say nothing to people.
bool in_another_form(const MissingEffect& m) {
  return m.loop && m.terms.front() != m.found.effect;
}

/// "temperature_gradient = -0.269 +- 0.007 deg/h/degC", "bias_step = 0.55 +- 0.05 deg/h, t0 = ...".
std::string estimates_text(const MissingEffect& m) {
  if (in_another_form(m)) {
    return fmt::format("{}, a loop of {}", m.found.effect, loop_text(*m.loop));
  }
  std::vector<std::string> parts;
  for (const Estimate& e : m.estimates) {
    const std::string_view beside = name_beside(m.found.effect, e.name);
    const std::string_view name = parts.empty() ? std::string_view(e.name) : beside;
    if (std::isnan(e.value)) {
      parts.push_back(fmt::format("{} not determined", name));
    } else if (m.inner_open && e.inner) {
      parts.push_back(fmt::format("{} = {} {}, which these data do not determine", name,
                                  number(e.value), e.unit));
    } else {
      parts.push_back(fmt::format("{} = {}", name, value_text(e)));
    }
  }
  return parts.empty() ? m.found.effect : enumerated(parts);
}

/// The set that the effect leads; null: no other effect does as well.
const std::vector<std::string>* set_of(const Diagnosis& d, const std::string& effect) {
  const auto set = std::find_if(d.ambiguous.begin(), d.ambiguous.end(),
                                [&](const auto& s) { return s.front() == effect; });
  return set == d.ambiguous.end() ? nullptr : &*set;
}

std::string missing_sentence(const Diagnosis& d) {
  std::vector<std::string> parts;
  for (const MissingEffect& m : d.missing) {
    const auto* set = set_of(d, m.found.effect);
    parts.push_back(set ? "one of " + enumerated(*set) : estimates_text(m));
  }
  // A slow effect or the noise, and none of them has been fitted.
  for (const auto& set : d.ambiguous) {
    if (d.missing.empty()) parts.push_back("one of " + enumerated(set));
  }
  return fmt::format("Missing: {}{}.", enumerated(parts, "; "),
                     d.ambiguous.empty() ? "" : "; these data cannot say which");
}

/// Does the formula alone predict better than all that was found?
bool formula_leads(const Diagnosis& d) {
  constexpr double kClearlyBetter = 0.5;
  return !d.unexplained.suggestion.empty() && !d.unexplained.beside_found && !d.missing.empty() &&
         d.unexplained.heldout_rms < kClearlyBetter * d.missing.back().heldout_rms_after;
}

std::string unexplained_sentence(const Diagnosis& d) {
  const std::string on =
      d.unexplained.depends_on.empty()
          ? std::string()
          : fmt::format("; what is left depends on {}", enumerated(d.unexplained.depends_on));
  if (formula_leads(d)) {
    return fmt::format(
        "Something is missing that the catalogue does not hold: {} does better than {}.",
        d.unexplained.suggestion, names_found(d));
  }
  if (d.far_from_floor) {
    return fmt::format("Missing: {}, and that is not all{}.", names_found(d), on);
  }
  if (d.missing.empty()) {
    return fmt::format("Something is missing that no effect of the catalogue explains{}.", on);
  }
  return fmt::format(
      "Something is missing that the catalogue does not hold; nearest, but not "
      "enough: {}{}.",
      names_found(d), on);
}

/// Rows that a diagnosis needs beyond those that there are.
std::size_t rows_lacking(const Diagnosis& d) {
  const std::size_t needed =
      d.before.fit.fitted.terms.size() + static_cast<std::size_t>(kFewestFreeRows);
  return needed - std::min(needed, d.table.rows());
}

std::string verdict_sentence(const Diagnosis& d) {
  if (d.verdict == Verdict::kUnexplained) return unexplained_sentence(d);
  if (d.verdict != Verdict::kNothingMissing) return missing_sentence(d);
  if (d.judged) return "Nothing is missing that these data can show.";
  return fmt::format(
      "Cannot tell whether anything is missing: {} rows beside {} terms {}.", d.table.rows(),
      d.before.fit.fitted.terms.size(),
      rows_lacking(d) > 0 ? "are too few" : "hold nothing that varies as an effect would");
}

/// What noise alone leaves. Where something is left over it may stand in the slow part of the
/// estimate: then the white part alone is sure.
std::string beside_noise(const Diagnosis& d) {
  const bool unsure =
      d.verdict == Verdict::kUnexplained || (d.verdict == Verdict::kAmbiguous && d.missing.empty());
  const double floor = unsure ? d.floor.white : d.noise_floor;
  if (!std::isfinite(floor)) return "";
  return fmt::format(", where {} leaves {}", unsure ? "white noise alone" : "noise alone",
                     number(floor));
}

std::string evidence_sentence(const Diagnosis& d) {
  // What a comparison says is all that can be said.
  if (!d.judged && d.missing.empty()) return d.before.sentences[1];
  const std::string_view unit = config::unit_of(d.before.fit.fitted.observable);
  const bool ladder = !d.ladder.empty();
  const double rms = ladder ? d.ladder.front().rms : d.before.fit.rms;
  const auto held_out = [](const std::string& numbers) {
    return fmt::format(", and {} on rows held out of the fit", numbers);
  };
  std::string text;
  if (formula_leads(d)) {
    text = fmt::format(
        "On rows held out of the fit the formula leaves {} {} RMS, what is nearest in the "
        "catalogue {}, the model as it came {}",
        number(d.unexplained.heldout_rms), unit, number(d.missing.back().heldout_rms_after),
        number(d.heldout_rms));
  } else if (d.missing.empty() || !ladder) {
    text = fmt::format("The model leaves {} {} RMS", number(rms), unit);
    if (std::isfinite(d.heldout_rms)) text += held_out(number(d.heldout_rms));
  } else {
    text = fmt::format("With {} the RMS residual falls from {} to {} {}",
                       d.missing.size() > 1 ? "them" : d.missing.front().found.effect, number(rms),
                       number(d.ladder.back().rms), unit);
    if (std::isfinite(d.heldout_rms) && std::isfinite(d.ladder.back().heldout_rms)) {
      text += held_out(
          fmt::format("from {} to {}", number(d.heldout_rms), number(d.ladder.back().heldout_rms)));
    }
  }
  text += fmt::format("{}; chance that noise alone looks so: {}.", beside_noise(d),
                      probability_text(d.p_adequate));
  if (d.walk_beyond > 0.0) {
    text += fmt::format(
        " A random walk that explains it would be {:.0f} times what nine of ten such gyros stay "
        "below.",
        d.walk_beyond);
  }
  if (!d.explained_by_thermometer.empty()) {
    text += fmt::format(" What else the model misses, {} explains.", d.explained_by_thermometer);
  }
  return text;
}

std::string few_rows_to_do(const Diagnosis& d) {
  if (const std::size_t lacking = rows_lacking(d); lacking > 0) {
    return fmt::format("Measure: {} more rows at least, at other temperatures, fields or times.",
                       lacking);
  }
  return "Measure: the same with temperature, field or azimuth varied, and recorded.";
}

std::string to_do_sentence(const Diagnosis& d, const std::string& next_command) {
  if (!d.judged && d.missing.empty()) return few_rows_to_do(d);
  // Beside effects that were found it mends what they leave, and those come first.
  if (!d.unexplained.suggestion.empty() && !d.unexplained.beside_found) {
    return fmt::format(
        R"(Try: {{"effect": "new", "expression": "{}"}} as a term of the model, a guess; held-out RMS {}.)",
        d.unexplained.suggestion, number(d.unexplained.heldout_rms));
  }
  if (const NextMeasurement* next = proposed_measurement(d)) {
    return fmt::format("Measure: {}.", next->action);
  }
  if (d.verdict == Verdict::kAmbiguous && d.walk_beyond > 0.0) {
    return "Measure: the gyro at rest for as long (static-record), and give that run as --quiet: "
           "it decides whether this is noise.";
  }
  return "Next: " + next_command;
}

/// What the verdict does not say of an effect that was found.
std::string effect_sentence(const Diagnosis& d, const MissingEffect& m) {
  const bool said = d.verdict == Verdict::kMissingEffect ||
                    (d.verdict == Verdict::kAmbiguous && !set_of(d, m.found.effect));
  std::string line = fmt::format("{}: {}", said ? m.found.effect : estimates_text(m),
                                 probability_text(m.found.p_value));
  if (m.loop && !in_another_form(m)) line += "; a loop of " + loop_text(*m.loop);
  if (in_another_form(m)) line += fmt::format("; in the model as {}", m.terms.front());
  const HeldoutVote& vote = m.found.heldout;
  if (vote.folds > 0) {
    line += fmt::format("; {} of {} parts of the data are predicted better with it than without",
                        vote.better, vote.folds);
  }
  if (!m.found.more.empty() && !in_another_form(m)) {
    line += "; more than one value of its inner parameter is at work";
  }
  if (!m.found.rivals.empty()) {
    std::vector<std::string> rivals;
    for (const Rival& r : m.found.rivals) {
      rivals.push_back(fmt::format("{} ({:.0f} %)", r.effect, 100.0 * r.probability));
    }
    line += fmt::format("; probability {:.0f} %, or else {}", 100.0 * m.found.probability,
                        enumerated(rivals));
  }
  if (!m.found.or_shape.empty()) {
    line += fmt::format("; or another effect of this shape ({})", m.found.or_shape);
  }
  return line + ".";
}

std::string refusal_sentence(const Found& refused) {
  switch (refused.refusal) {
    case Refusal::kAtEdge:
      return fmt::format("{} is not named: it fits best with its inner parameter beyond its range.",
                         refused.effect);
    case Refusal::kNotDistinguished:
      return fmt::format("{} is not named: its coefficient cannot be distinguished from zero.",
                         refused.effect);
    case Refusal::kComesAndGoes:
      return fmt::format("{} is not named: a second jump follows it, what came has gone again.",
                         refused.effect);
    case Refusal::kNotPredicting:
      return fmt::format("{} is not named: it does not predict held-out parts better.",
                         refused.effect);
    case Refusal::kNone:
      break;
  }
  return {};
}

}  // namespace

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kNothingMissing:
      return "adequate";
    case Verdict::kMissingEffect:
      return "missing_effect";
    case Verdict::kAmbiguous:
      return "ambiguous";
    case Verdict::kUnexplained:
      return "unexplained";
  }
  return "";
}

bool found_adequate(const Diagnosis& diagnosis) {
  return diagnosis.judged && diagnosis.verdict == Verdict::kNothingMissing;
}

std::string_view verdict_of(const Diagnosis& diagnosis) {
  const bool unknown = !diagnosis.judged && diagnosis.verdict == Verdict::kNothingMissing;
  return unknown ? "cannot_tell" : name_of(diagnosis.verdict);
}

const NextMeasurement* proposed_measurement(const Diagnosis& d) {
  if (d.verdict != Verdict::kAmbiguous) return nullptr;
  const auto next =
      std::find_if(d.next_measurements.begin(), d.next_measurements.end(),
                   [](const auto& n) { return n.purpose == NextMeasurement::Purpose::kTellApart; });
  return next == d.next_measurements.end() ? nullptr : &*next;
}

std::string_view name_beside(const std::string& effect, const std::string& estimate) {
  if (estimate == effect) return "";
  const std::string_view name = estimate;
  return name.starts_with(effect + ".") ? name.substr(effect.size() + 1) : name;
}

std::vector<std::string> VerdictWords::sentences() const {
  std::vector<std::string> out{verdict, evidence, to_do};
  out.insert(out.end(), details.begin(), details.end());
  return out;
}

VerdictWords verdict_in_words(const Diagnosis& d, const std::string& next_command) {
  VerdictWords out{.verdict = verdict_sentence(d),
                   .evidence = evidence_sentence(d),
                   .to_do = to_do_sentence(d, next_command),
                   .details = {}};
  std::vector<std::string>& more = out.details;
  for (const MissingEffect& m : d.missing) more.push_back(effect_sentence(d, m));
  if (d.verdict == Verdict::kUnexplained) {
    for (const Found& refused : d.refused) more.push_back(refusal_sentence(refused));
    if (!d.unexplained.shape.empty()) {
      more.push_back(fmt::format("What is left resembles {}.", d.unexplained.shape));
    }
    if (d.unexplained.beside_found) {
      more.push_back(fmt::format(
          "A formula to start from (a guess, as the expression of a term beside {}): {}; held-out "
          "RMS {}.",
          names_found(d), d.unexplained.suggestion, number(d.unexplained.heldout_rms)));
    } else if (d.unexplained.suggestion.empty()) {
      more.emplace_back("No short formula of the recorded columns predicts held-out rows better.");
    }
  }
  for (const LeftOut& row : d.left_out) more.push_back(row.says + ".");
  if (!d.judged) {
    for (const std::string& sentence : d.before.sentences) {
      if (sentence != out.evidence) more.push_back(sentence);
    }
  }
  return out;
}

}  // namespace fogbench::model
