// fogbench reveal: opens the seal of a challenge and scores an answer.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "cli/challenge_file.hpp"
#include "cli/command.hpp"
#include "cli/output.hpp"
#include "cli/score.hpp"
#include "model/effects/catalogue.hpp"

namespace fogbench::cli {
namespace {

struct RevealOptions {
  std::string folder;
  std::vector<std::string> answer;
  std::string diagnosis;
  bool json = false;
};

std::string amplitude_unit(const std::string& effect) {
  const model::Effect* known = model::find_effect(effect);
  return known == nullptr ? "" : std::string(known->info().units.front());
}

std::string parameter_unit(const std::string& effect, const std::string& parameter) {
  if (parameter == "phase_deg") return "deg";
  const model::Effect* known = model::find_effect(effect);
  if (known == nullptr) return "";
  for (const model::InnerParameter& inner : known->info().parameters) {
    if (inner.name == parameter) return std::string(inner.unit);
  }
  return "";
}

std::vector<std::string> names_of(const ChallengeSecret& secret) {
  std::vector<std::string> names;
  for (const config::HiddenEffect& effect : secret.scenario.hidden) names.push_back(effect.effect);
  return names;
}

/// Empty when none was given.
Result<std::optional<Answer>> answer_of(const RevealOptions& options) {
  if (options.answer.empty() && options.diagnosis.empty()) return std::optional<Answer>();
  const auto answer =
      options.diagnosis.empty() ? answer_from(options.answer) : read_diagnosis(options.diagnosis);
  if (!answer) return answer.error();
  return std::optional<Answer>(*answer);
}

nlohmann::ordered_json to_json(const RevealOptions& options, const ChallengeSecret& secret,
                               const std::optional<Answer>& answer) {
  nlohmann::ordered_json hidden = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < secret.scenario.hidden.size(); ++i) {
    const config::HiddenEffect& effect = secret.scenario.hidden[i];
    hidden.push_back({{"effect", effect.effect},
                      {"amplitude", effect.amplitude},
                      {"unit", amplitude_unit(effect.effect)},
                      {"parameters", effect.parameters},
                      {"visible_deg_per_h", secret.visible_deg_per_h[i]}});
  }
  nlohmann::ordered_json document{{"folder", options.folder},
                                  {"seed", secret.seed},
                                  {"noise_deg_per_h", secret.noise_deg_per_h},
                                  {"terms", secret.scenario.terms},
                                  {"hidden", hidden}};
  if (answer) {
    const Score scored = score(names_of(secret), *answer);
    document["answered"] = answer->claims;
    document["right"] = scored.right;
    document["in_set"] = scored.in_set;
    document["missed"] = scored.missed;
    document["invented"] = scored.invented;
    document["exact"] = scored.exact();
  }
  return document;
}

void print_hidden(const ChallengeSecret& secret) {
  if (secret.scenario.hidden.empty()) {
    fmt::print("This gyro hides nothing: what the model leaves, {:.3g} deg/h RMS, is noise.\n",
               secret.noise_deg_per_h);
  }
  for (std::size_t i = 0; i < secret.scenario.hidden.size(); ++i) {
    const config::HiddenEffect& effect = secret.scenario.hidden[i];
    fmt::print("This gyro hides {}: amplitude {:g} {}", effect.effect, effect.amplitude,
               amplitude_unit(effect.effect));
    for (const auto& [name, value] : effect.parameters) {
      const std::string unit = parameter_unit(effect.effect, name);
      fmt::print(", {} {:g}{}{}", name, value, unit.starts_with("100 ") ? " x " : " ", unit);
    }
    fmt::print(
        ".\n  The fitted model misses {:.3g} deg/h RMS of it, {:.1f} times what noise alone "
        "leaves.\n",
        secret.visible_deg_per_h[i], secret.visible_deg_per_h[i] / secret.noise_deg_per_h);
  }
}

void print_score(const Score& scored, const Answer& answer, std::size_t hidden) {
  std::vector<std::string> claims;
  for (const Claim& claim : answer.claims) {
    claims.push_back(fmt::format("{}", fmt::join(claim, " or ")));
  }
  if (answer.unnamed) claims.emplace_back("something without a name");
  fmt::print("\nThe answer: {}.\n",
             claims.empty() ? kNothing : fmt::format("{}", fmt::join(claims, ", ")));
  const auto list = [](const char* what, const std::vector<std::string>& names) {
    if (!names.empty()) fmt::print("  {:<14}{}\n", what, fmt::join(names, ", "));
  };
  list("right", scored.right);
  list("in the set", scored.in_set);
  list("missed", scored.missed);
  list("invented", scored.invented);
  if (scored.exact()) {
    fmt::print("{}\n",
               scored.in_set.empty() ? "Exactly right." : "Right, as far as the set tells.");
    return;
  }
  fmt::print("Not right: {} of {} found, {} invented.\n", hidden - scored.missed.size(), hidden,
             scored.invented.size());
}

Result<ExitStatus> run_reveal(const RevealOptions& options) {
  // A wrong answer's name is refused before the seal is opened, so that it may be given again.
  const auto answer = answer_of(options);
  if (!answer) return answer.error();
  const auto secret = open_challenge(options.folder);
  if (!secret) return secret.error();
  const std::vector<std::string> hidden = names_of(*secret);
  if (options.json) {
    print_json(to_json(options, *secret, *answer));
  } else {
    print_hidden(*secret);
    if (*answer) print_score(score(hidden, **answer), **answer, hidden.size());
    fmt::print("\nThe same again: fogbench challenge --seed {}\n", secret->seed);
  }
  const bool right = !*answer || score(hidden, **answer).exact();
  return right ? ExitStatus::kDone : ExitStatus::kNo;
}

}  // namespace

void add_reveal(CLI::App& app, Action& action) {
  add_command<RevealOptions>(
      app, action, "reveal", "Open the seal of a challenge and score an answer",
      "  fogbench reveal challenge-1 --answer magnetic_hysteresis_z\n"
      "  fogbench reveal challenge-1 --answer nothing\n"
      "  fogbench reveal challenge-1 --diagnosis diagnosis.json\n"
      "Exit status 0 when the answer is exactly right, or none was given; 1 when it is not.",
      [](CLI::App& command, RevealOptions& options) {
        command.add_option("FOLDER", options.folder, "What fogbench challenge made")->required();
        auto* answer = command.add_option("--answer", options.answer,
                                          "The effects that hide (see fogbench effects), or "
                                          "nothing");
        command
            .add_option("--diagnosis", options.diagnosis,
                        "The answer as fogbench diagnose --json printed it; an ambiguous set of "
                        "at most 3 names answers for one of them")
            ->excludes(answer);
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_reveal);
}

}  // namespace fogbench::cli
