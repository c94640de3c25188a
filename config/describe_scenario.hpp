#pragma once
// The JSON shape of scenarios (scenario.hpp): keys, sentences, bounds.

#include "config/codec.hpp"
#include "config/scenario.hpp"

namespace fogbench::config {

constexpr std::array<EnumName<FaultKind>, 12> enum_names(FaultKind /*kind*/) {
  return {{{"timeout", FaultKind::kTimeout},
           {"late_answer", FaultKind::kLateAnswer},
           {"silent_execution", FaultKind::kSilentExecution},
           {"bad_checksum", FaultKind::kBadChecksum},
           {"bad_sequence", FaultKind::kBadSequence},
           {"garbage", FaultKind::kGarbage},
           {"nan", FaultKind::kNan},
           {"stuck", FaultKind::kStuck},
           {"exception", FaultKind::kException},
           {"unplug", FaultKind::kUnplug},
           {"slow_answer", FaultKind::kSlowAnswer},
           {"open_circuit", FaultKind::kOpenCircuit}}};
}

template <class Visitor>
void describe(Visitor& v, NoiseCoefficients& n) {
  v.optional("angle_random_walk_deg_per_sqrt_h", n.angle_random_walk_deg_per_sqrt_h,
             "N, white noise of the rate.", at_least(0));
  v.optional("bias_instability_deg_per_h", n.bias_instability_deg_per_h, "B, flicker.",
             at_least(0));
  v.optional("rate_random_walk_deg_per_h_per_sqrt_h", n.rate_random_walk_deg_per_h_per_sqrt_h,
             "K, random walk of the rate.", at_least(0));
  v.optional("quantisation_deg", n.quantisation_deg, "Q, quantisation of the angle.", at_least(0));
}

/// A grade's name, or the four coefficients.
struct NoiseChoice {
  NoiseCoefficients& noise;
};

template <>
struct Codec<NoiseChoice> {
  static bool read(const Place& at, NoiseChoice& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const NoiseChoice& choice);
};

template <class Visitor>
void describe(Visitor& v, HiddenEffect& h) {
  v.required("effect", h.effect, "Identifier of the effect, as in `fogbench effects`.");
  v.required("amplitude", h.amplitude, "deg/h per unit of the effect's regressor.");
  v.rest(h.parameters, "Inner parameter of the effect: width, tau, t0, period, hs, phase_deg.");
}

template <class Visitor>
void describe(Visitor& v, FaultSpec& f) {
  v.required("device", f.device,
             "thermostat, coil_horizontal, coil_vertical, magnetometer, turntable, gyro, or the "
             "name of an auxiliary sensor of the bench.");
  v.required("kind", f.kind, "How it misbehaves.");
  v.optional("at_s", f.at, "From when on, since the start of the run.", at_least(0));
  v.optional("for_s", f.duration, "For how long.", at_least(0));
  v.optional("at_operation", f.at_operation,
             "Instead of at_s and for_s: the first operation of the instrument that it spoils, "
             "counted from 1.",
             at_least(1));
  v.optional("for_operations", f.operations, "How many operations it spoils, from that one on.",
             at_least(1));
  v.optional("operation", f.operation,
             "Spoil and count only the operations of this name: read, set_target, set_mode of a "
             "thermostat; clear, identify, initialise, set, set_query, measure, error_query, "
             "output_on, output_off of a supply or turntable; report; frame.");
}

template <class Visitor>
void describe(Visitor& v, MagneticScaleChange& m) {
  v.required("at_s", m.at, "From when on, since the start of the run.", at_least(0));
  v.required("factor", m.factor, "What all magnetic terms are multiplied by.", at_least(0));
}

template <class Visitor>
void describe(Visitor& v, ScenarioConfig& s) {
  v.optional("name", s.name, "Short name.");
  v.optional("description", s.description, "What this gyro is, in a sentence.");
  NoiseChoice noise{s.noise};
  v.optional("noise", noise,
             "Grade of the gyro (none, navigation, tactical), or its noise coefficients.");
  v.section("gyro", "What the gyro's passport says.", [&](auto& inside) {
    inside.optional("terms", s.terms, "Coefficient of each effect, deg/h per unit.");
  });
  v.optional("hidden", s.hidden, "Effects that the passport does not tell.");
  v.optional("magnetic_scale", s.magnetic_scale, "Changes of the shield's state, in time order.");
  v.optional("faults", s.faults, "Misbehaviour of instruments.");
  v.optional("reference_temperature_c", s.reference_temperature,
             "Temperature that the thermal terms count from.");
}

bool check(const Place& at, const HiddenEffect& hidden);
bool check(const Place& at, const FaultSpec& fault);
bool check(const Place& at, const ScenarioConfig& scenario);

}  // namespace fogbench::config
