#include "model/diagnose/verdict_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "config/rounding.hpp"
#include "model/conclusions.hpp"

namespace fogbench::model {
namespace {

std::vector<std::string> names_found(const Diagnosis& d) {
  std::vector<std::string> names;
  for (const MissingEffect& m : d.missing) names.push_back(m.found.effect);
  return names;
}

std::string verdict_sentence(const Diagnosis& d) {
  switch (d.verdict) {
    case Verdict::kNothingMissing:
      if (!d.judged) {
        return fmt::format(
            "Cannot tell whether anything is missing: {} rows beside {} terms, and the noise, "
            "leave "
            "nothing in which an effect could show.",
            d.table.rows(), d.before.fit.fitted.terms.size());
      }
      return fmt::format(
          "Nothing is missing that these data can show ({}): what is left, {:.3g} "
          "deg/h RMS, is noise.",
          probability_text(d.p_adequate),
          d.ladder.empty() ? d.before.fit.rms : d.ladder.back().rms);
    case Verdict::kMissingEffect:
      return fmt::format("Missing: {} ({}).", fmt::join(names_found(d), ", "),
                         probability_text(d.p_adequate));
    case Verdict::kAmbiguous:
      return fmt::format(
          "Something is missing ({}), and these data cannot say which of several "
          "effects it is.",
          probability_text(d.p_adequate));
    case Verdict::kUnexplained:
      if (d.far_from_floor) {
        return fmt::format(
            "Found: {} ({}), but that is not all: rows left out are still missed by {:.3g} deg/h "
            "RMS, where noise alone leaves {:.3g}{}.",
            fmt::join(names_found(d), ", "), probability_text(d.p_adequate),
            d.missing.back().heldout_rms_after, d.noise_floor,
            d.unexplained.depends_on.empty()
                ? std::string()
                : fmt::format("; what is left depends on {}",
                              fmt::join(d.unexplained.depends_on, ", ")));
      }
      return fmt::format(
          "Something is left that no effect of the catalogue explains ({}){}.",
          probability_text(d.unexplained.p_value),
          d.unexplained.depends_on.empty()
              ? std::string()
              : fmt::format("; it depends on {}", fmt::join(d.unexplained.depends_on, ", ")));
  }
  return {};
}

std::string effect_sentence(const MissingEffect& m) {
  std::string line = m.found.effect + ": ";
  for (std::size_t i = 0; i < m.estimates.size(); ++i) {
    const Estimate& e = m.estimates[i];
    if (std::isnan(e.value)) {
      line += fmt::format("{}{} not determined", i > 0 ? ", " : "", e.name);
      continue;
    }
    if (m.inner_open && e.name == m.inner_name) {
      line += fmt::format(" at {} = {:.3g} {}, which these data do not determine", e.name, e.value,
                          e.unit);
      continue;
    }
    const config::Rounded r = config::rounded(e.value, e.coverage_factor * e.standard_error);
    line += fmt::format("{}{} = {} +- {} {}", i > 0 ? ", " : "", e.name, r.value, r.uncertainty,
                        e.unit);
  }
  line += fmt::format("; {}, the RMS residual falls to {:.3g} deg/h",
                      probability_text(m.found.p_value), m.rms_after);
  const HeldoutVote& vote = m.found.heldout;
  if (vote.folds > 0) {
    line += fmt::format("; {} of {} held-out parts are predicted better with it", vote.better,
                        vote.folds);
  }
  if (!m.found.more.empty()) {
    line += "; one value of its inner parameter does not suffice, its shape bends";
  }
  if (!m.found.or_shape.empty()) {
    line += fmt::format("; or another effect of this shape ({})", m.found.or_shape);
  }
  return line + ".";
}

/// What a user can start from.
std::string formula_sentence(const Diagnosis& d) {
  const Unexplained& u = d.unexplained;
  const std::string shape =
      u.shape.empty() ? std::string() : fmt::format("Its shape resembles {}. ", u.shape);
  if (u.suggestion.empty()) {
    return shape + "No short formula of the recorded columns predicts held-out rows better.";
  }
  std::vector<std::string> names;
  for (const MissingEffect& m : d.missing) names.push_back(m.found.effect);
  return fmt::format(
      "{}A formula to start from (a guess, as the expression of a term{}): {}; held-out RMS {:.3g} "
      "deg/h, beside a noise floor of {:.3g}.",
      shape, u.beside_found ? fmt::format(" beside {}", fmt::join(names, ", ")) : std::string(),
      u.suggestion, u.heldout_rms, d.noise_floor);
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

std::vector<std::string> verdict_in_words(const Diagnosis& d) {
  std::vector<std::string> out{verdict_sentence(d)};
  if (!d.explained_by_thermometer.empty()) {
    out.push_back(
        fmt::format("What else the model misses, {} explains.", d.explained_by_thermometer));
  }
  const std::string_view lead = d.verdict == Verdict::kUnexplained && !d.far_from_floor
                                    ? "Nearest of the catalogue, but not enough: "
                                    : "";
  for (const MissingEffect& m : d.missing) {
    out.push_back(fmt::format("{}{}", lead, effect_sentence(m)));
  }
  for (const auto& set : d.ambiguous) {
    out.push_back(fmt::format("Cannot tell apart: {}.", fmt::join(set, ", ")));
  }
  if (d.verdict == Verdict::kUnexplained) {
    for (const Found& refused : d.refused) out.push_back(refusal_sentence(refused));
    out.push_back(formula_sentence(d));
  }
  if (d.walk_beyond > 0.0) {
    out.push_back(fmt::format(
        "A random walk would explain it, but one {:.0f} times what nine of ten such gyros "
        "stay below: a static record (--noise FILE) decides whether it is noise.",
        d.walk_beyond));
  }
  for (const LeftOut& row : d.left_out) out.push_back(row.says + ".");
  // Then what a comparison says is all that can be said.
  if (!d.judged) {
    out.insert(out.end(), d.before.sentences.begin(), d.before.sentences.end());
  }
  return out;
}

}  // namespace fogbench::model
