// fogbench effects: the catalogue of the error model.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/output.hpp"
#include "model/effects/catalogue.hpp"

namespace fogbench::cli {
namespace {

struct EffectsOptions {
  std::vector<std::string> effects;
  bool json = false;
};

nlohmann::json to_json(const model::EffectInfo& info) {
  nlohmann::json parameters = nlohmann::json::array();
  for (const model::InnerParameter& p : info.parameters) {
    parameters.push_back(
        {{"name", p.name}, {"unit", p.unit}, {"minimum", p.minimum}, {"maximum", p.maximum}});
  }
  return {{"effect", info.id},
          {"formula", info.formula},
          {"columns", info.columns},
          {"units", info.units},
          {"signals", info.signals},
          {"parameters", parameters},
          {"excited_by", info.excited_by},
          {"confused_with", info.confused_with},
          {"source", info.source}};
}

std::string parameters_text(const model::EffectInfo& info) {
  std::vector<std::string> parts;
  for (const model::InnerParameter& p : info.parameters) {
    parts.push_back(fmt::format("{} {:g}..{:g} {}", p.name, p.minimum, p.maximum, p.unit));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

void print_one(const model::EffectInfo& info) {
  fmt::print("{}\n  formula        {}\n  unit           {}\n  needs          {}\n", info.id,
             info.formula, fmt::join(info.units, ", "),
             info.signals.empty() ? "nothing" : fmt::format("{}", fmt::join(info.signals, ", ")));
  if (!info.parameters.empty()) fmt::print("  inner          {}\n", parameters_text(info));
  fmt::print("  excited by     {}\n  confused with  {}\n  source         {}\n", info.excited_by,
             info.confused_with, info.source);
}

Result<ExitStatus> run_effects(const EffectsOptions& options) {
  std::vector<const model::Effect*> chosen;
  for (const std::string& id : options.effects) {
    const model::Effect* effect = model::find_effect(id);
    if (effect == nullptr) return Error{ErrorCode::kBadInput, model::unknown_effect(id)};
    chosen.push_back(effect);
  }
  if (chosen.empty()) {
    const auto all = model::catalogue();
    chosen.assign(all.begin(), all.end());
  }
  if (options.json) {
    nlohmann::json list = nlohmann::json::array();
    for (const model::Effect* effect : chosen) list.push_back(to_json(effect->info()));
    print_json({{"effects", std::move(list)}});
    return ExitStatus::kDone;
  }
  if (!options.effects.empty()) {
    for (const model::Effect* effect : chosen) print_one(effect->info());
    return ExitStatus::kDone;
  }
  using Align = TextTable::Align;
  TextTable table({{"effect", "", Align::kLeft},
                   {"formula", "", Align::kLeft},
                   {"coefficient", "", Align::kLeft},
                   {"inner", "", Align::kLeft},
                   {"needs", "", Align::kLeft}});
  for (const model::Effect* effect : chosen) {
    const model::EffectInfo& info = effect->info();
    table.add_row({std::string(info.id), std::string(info.formula), std::string(info.units[0]),
                   parameters_text(info), fmt::format("{}", fmt::join(info.signals, ", "))});
  }
  fmt::print("{}", table.text());
  fmt::print(
      "\nh = field / 100 uT in the gyro's axes, t = temperature - reference temperature.\n"
      "play_w: backlash of half-width w; LPF(u; tau): first-order lag.\n"
      "Where they are missing, temperature_rate_c_per_h and temperature_acceleration_c_per_h2 are\n"
      "derived from temperature_c and time_s, temperature_gradient_rate_c_per_h from\n"
      "temperature_gradient_c and time_s, time_since_start_s from time_s; coil_heat is\n"
      "current_horizontal_a^2 + current_vertical_a^2, or else from coil_current_a or the fields.\n"
      "Of any further column of the table (a supply voltage, a pressure) by its name:\n"
      "  sensitivity(COLUMN), sensitivity_quadratic(COLUMN), sensitivity_rate(COLUMN) per hour,\n"
      "  sensitivity_lagged(COLUMN) with tau, sensitivity_temperature_rate(COLUMN) times dT/dt,\n"
      "  sensitivity_field_x(COLUMN), _y, _z times h\n"
      "Of a hysteresis whose loop one width does not describe, with N = 1..8 weights of widths up "
      "to\n"
      "`width`: magnetic_loop_x(N), _y, _z, temperature_loop(N), and with saturation at `hs`\n"
      "  magnetic_saturating_loop_x(N), _y, _z\n"
      "`fogbench effects EFFECT` tells what excites one and what it is confused with.\n");
  return ExitStatus::kDone;
}

}  // namespace

void add_effects(CLI::App& app, Action& action) {
  add_command<EffectsOptions>(
      app, action, "effects", "Show the catalogue of physical effects",
      "  fogbench effects\n  fogbench effects magnetic_hysteresis_z\n",
      [](CLI::App& command, EffectsOptions& options) {
        command.add_option("EFFECT", options.effects, "Only these, in full");
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_effects);
}

}  // namespace fogbench::cli
