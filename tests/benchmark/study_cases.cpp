#include "tests/benchmark/study_cases.hpp"

namespace fogbench::tests {
namespace {

using Ids = std::vector<std::string>;

// What each design excites, one axis standing for the three where they are alike.
const Ids kMagneticEffects{"magnetic_linear_x",
                           "magnetic_quadratic_x",
                           "magnetic_quadratic_z",
                           "magnetic_saturation_x",
                           "magnetic_saturation_z",
                           "magnetic_hysteresis_y",
                           "magnetic_hysteresis_z",
                           "magnetic_settling_x",
                           "magnetic_settling_z",
                           "coil_heating",
                           "bias_step",
                           "drift_linear",
                           "warm_up",
                           "earth_rate_projection"};
const Ids kHeatingEffects{"temperature_linear",
                          "temperature_quadratic",
                          "temperature_cubic",
                          "temperature_rate",
                          "temperature_rate_lagged",
                          "temperature_acceleration",
                          "temperature_rate_cross",
                          "temperature_gradient",
                          "temperature_gradient_rate",
                          "temperature_ripple",
                          "heater_power",
                          "bias_step",
                          "drift_linear",
                          "warm_up",
                          "ambient_temperature"};

Ids joined(Ids a, const Ids& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

struct Asked {
  Design design;
  Ids effects;
};

std::vector<Asked> single_effects() {
  const Ids cooling = joined(kHeatingEffects, {"temperature_hysteresis"});
  const Ids mixed{"temperature_quadratic",  "temperature_rate",
                  "temperature_hysteresis", "temperature_gradient",
                  "magnetic_temperature_x", "magnetic_temperature_y",
                  "magnetic_temperature_z", "magnetic_hysteresis_x",
                  "magnetic_quadratic_y",   "magnetic_saturation_y",
                  "magnetic_settling_y",    "coil_heating",
                  "earth_rate_projection",  "bias_step",
                  "drift_linear",           "warm_up",
                  "ambient_temperature"};
  return {{Design::kMagnetic, kMagneticEffects},
          {Design::kDiagonals, {"magnetic_cross_xy", "magnetic_cross_yz", "magnetic_cross_zx"}},
          {Design::kTurntable, {"earth_rate_projection", "bias_step", "drift_linear"}},
          {Design::kThermal, kHeatingEffects},
          {Design::kThermalCooling, cooling},
          {Design::kMixed, mixed}};
}

void add(std::vector<DiagnosisCase>& out, DiagnosisCase what, const Ids& noises,
         const std::vector<double>& ratios) {
  for (const std::string& noise : noises) {
    for (const double s : ratios) {
      what.noise = noise;
      what.s = s;
      out.push_back(what);
    }
  }
}

void add_nulls(std::vector<DiagnosisCase>& out) {
  const Ids noises = joined(noises_of_the_family(), noises_outside_the_family());
  for (const Design design : {Design::kMagnetic, Design::kThermalCooling, Design::kMixed}) {
    add(out, {.part = "nulls", .design = design}, noises, {0.0});
  }
  for (const Design design : {Design::kMagnetic, Design::kMixed}) {
    add(out, {.part = "nulls", .design = design}, noises_that_differ_by_row(), {0.0});
  }
  for (const Design design : {Design::kDiagonals, Design::kOneAxis, Design::kPlateaus,
                              Design::kThermal, Design::kTurntable, Design::kTwoRuns}) {
    add(out, {.part = "nulls", .design = design}, {"navigation", "walk"}, {0.0});
  }
  add(out, {.part = "nulls", .design = Design::kLong}, {"navigation"}, {0.0});
}

void add_pairs(std::vector<DiagnosisCase>& out) {
  const std::vector<Asked> pairs{
      {Design::kMagnetic, {"magnetic_hysteresis_z", "magnetic_quadratic_x"}},
      {Design::kMagnetic, {"magnetic_saturation_x", "magnetic_settling_z"}},
      {Design::kMagnetic, {"magnetic_linear_y", "magnetic_hysteresis_x"}},
      {Design::kMagnetic, {"magnetic_quadratic_z", "bias_step"}},
      {Design::kThermalCooling, {"temperature_quadratic", "temperature_rate"}},
      {Design::kThermalCooling, {"temperature_hysteresis", "warm_up"}},
      {Design::kThermalCooling, {"temperature_ripple", "temperature_rate_lagged"}},
      {Design::kMixed, {"temperature_rate", "magnetic_hysteresis_z"}},
      {Design::kMixed, {"magnetic_temperature_x", "temperature_quadratic"}},
      {Design::kMixed, {"magnetic_saturation_z", "temperature_hysteresis"}}};
  for (const Asked& pair : pairs) {
    add(out, {.part = "pairs", .design = pair.design, .hidden = pair.effects},
        {"navigation", "tactical"}, {12.0, 20.0});
  }
}

void add_outside(std::vector<DiagnosisCase>& out) {
  const std::vector<Asked> asked{
      {Design::kMagnetic,
       {"outside_sqrt_field_z", "outside_one_sided_x", "outside_direction_cube_y",
        "outside_sine_field_z", "outside_pulse", "outside_dead_zone_y", "outside_ageing_scale_x",
        "outside_exponential_field_z", "outside_sine_in_time", "outside_two_pulses",
        "outside_creep"}},
      {Design::kThermalCooling,
       {"outside_pulse", "outside_temperature_kink", "outside_rate_squared", "outside_heating_only",
        "outside_thermal_switch", "outside_root_of_excess", "outside_sine_in_time"}},
      {Design::kTurntable, {"outside_bias_per_orientation", "outside_pulse"}},
      {Design::kMixed,
       {"outside_sqrt_field_z", "outside_sine_field_z", "outside_temperature_kink",
        "outside_field_times_gradient_z", "outside_ageing_scale_x", "outside_thermal_switch",
        "outside_two_pulses"}}};
  for (const Asked& a : asked) {
    for (const std::string& id : a.effects) {
      add(out, {.part = "outside", .design = a.design, .hidden = {id}}, {"navigation", "tactical"},
          {16.0, 30.0});
    }
  }
}

void add_shapes(std::vector<DiagnosisCase>& out) {
  const std::vector<Asked> asked{
      {Design::kMagnetic,
       {"magnetic_hysteresis_z", "magnetic_hysteresis_x", "magnetic_saturation_z",
        "magnetic_settling_y", "coil_heating", "warm_up", "bias_step"}},
      {Design::kThermalCooling,
       {"temperature_hysteresis", "temperature_rate_lagged", "warm_up", "bias_step"}},
      {Design::kMixed, {"magnetic_hysteresis_z", "temperature_hysteresis", "coil_heating"}}};
  for (const Asked& a : asked) {
    for (const std::string& id : a.effects) {
      add(out, {.part = "shapes", .design = a.design, .hidden = {id}, .shape = Shape::kOther},
          {"navigation", "tactical"}, {12.0, 20.0, 50.0});
    }
  }
}

void add_sizes(std::vector<DiagnosisCase>& out) {
  const std::vector<Asked> asked{
      {Design::kOneAxis,
       {"magnetic_quadratic_z", "magnetic_saturation_z", "magnetic_hysteresis_z", "bias_step"}},
      {Design::kPlateaus, {"temperature_quadratic", "temperature_cubic"}},
      {Design::kTwoRuns, {"magnetic_quadratic_y", "magnetic_hysteresis_z", "warm_up"}},
      {Design::kLong,
       {"magnetic_hysteresis_z", "temperature_rate_lagged", "warm_up", "magnetic_temperature_y"}}};
  for (const Asked& a : asked) {
    for (const std::string& id : a.effects) {
      add(out, {.part = "sizes", .design = a.design, .hidden = {id}}, {"navigation"}, {12.0});
    }
  }
}

void add_columns(std::vector<DiagnosisCase>& out) {
  struct Variant {
    std::string name;
    ForeignColumns columns;
    double quiet_hours;
  };
  const ForeignColumns all;
  const ForeignColumns bare{.standard_error = false,
                            .temperature_rate = false,
                            .gradient = false,
                            .heater = false,
                            .ambient = false};
  ForeignColumns no_error;
  no_error.standard_error = false;
  ForeignColumns no_rate;
  no_rate.temperature_rate = false;
  const std::vector<Variant> variants{{"no_standard_error", no_error, 0.0},
                                      {"no_temperature_rate", no_rate, 0.0},
                                      {"fewest_columns", bare, 0.0},
                                      {"static_record", all, 8.0}};
  const std::vector<Asked> asked{
      {Design::kMagnetic, {"", "magnetic_hysteresis_z", "drift_linear", "warm_up"}},
      {Design::kThermalCooling, {"", "temperature_rate", "temperature_rate_lagged", "bias_step"}}};
  for (const Variant& variant : variants) {
    for (const Asked& a : asked) {
      for (const std::string& id : a.effects) {
        DiagnosisCase what{.part = "columns",
                           .design = a.design,
                           .hidden = id.empty() ? Ids{} : Ids{id},
                           .columns = variant.columns,
                           .variant = variant.name,
                           .quiet_hours = variant.quiet_hours};
        add(out, what, {"navigation"}, {id.empty() ? 0.0 : 12.0});
      }
    }
  }
}

}  // namespace

std::vector<DiagnosisCase> study_cases() {
  std::vector<DiagnosisCase> out;
  add_nulls(out);
  for (const Asked& asked : single_effects()) {
    for (const std::string& id : asked.effects) {
      add(out, {.part = "effects", .design = asked.design, .hidden = {id}},
          {"navigation", "tactical"}, {8.0, 12.0, 16.0});
    }
  }
  add_pairs(out);
  add_outside(out);
  add_shapes(out);
  add_sizes(out);
  add_columns(out);
  return out;
}

}  // namespace fogbench::tests
