#pragma once
// The JSON shape of procedures (procedure.hpp): steps, keys, sentences, bounds.

#include "config/codec.hpp"
#include "config/procedure.hpp"

namespace fogbench::config {

constexpr std::array<EnumName<HeatingMode>, 3> enum_names(HeatingMode /*mode*/) {
  return {{{"off", HeatingMode::kOff},
           {"boost", HeatingMode::kBoost},
           {"normal", HeatingMode::kNormal}}};
}
constexpr std::array<EnumName<Axis>, 4> enum_names(Axis /*axis*/) {
  return {{{"x", Axis::kX}, {"y", Axis::kY}, {"z", Axis::kZ}, {"north", Axis::kNorth}}};
}

/// A number, a list, a range, or "$name" of a parameter. Bounds hold for what stands there
/// literally; the value of a parameter is checked when it is known.
template <>
struct Codec<Number> {
  static bool read(const Place& at, Number& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const Number& number);
};
template <>
struct Codec<NumberList> {
  static bool read(const Place& at, NumberList& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const NumberList& list);
};
template <>
struct Codec<Argument> {
  static bool read(const Place& at, Argument& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const Argument& argument);
};
template <>
struct Codec<ParameterValue> {
  static bool read(const Place& at, ParameterValue& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const ParameterValue& value);
};

/// The value of the key "step".
constexpr std::string_view step_name(const SetTemperature& /*step*/) {
  return "set_temperature";
}
constexpr std::string_view step_name(const Ramp& /*step*/) {
  return "ramp";
}
constexpr std::string_view step_name(const SettleTemperature& /*step*/) {
  return "settle_temperature";
}
constexpr std::string_view step_name(const Wait& /*step*/) {
  return "wait";
}
constexpr std::string_view step_name(const Average& /*step*/) {
  return "average";
}
constexpr std::string_view step_name(const Baseline& /*step*/) {
  return "baseline";
}
constexpr std::string_view step_name(const CompensateField& /*step*/) {
  return "compensate_field";
}
constexpr std::string_view step_name(const Sweep& /*step*/) {
  return "sweep";
}
constexpr std::string_view step_name(const Rotate& /*step*/) {
  return "rotate";
}
constexpr std::string_view step_name(const Prompt& /*step*/) {
  return "prompt";
}
constexpr std::string_view step_name(const Call& /*step*/) {
  return "call";
}
constexpr std::string_view step_name(const ForEach& /*step*/) {
  return "for_each";
}
constexpr std::string_view step_name(const Repeat& /*step*/) {
  return "repeat";
}
constexpr std::string_view step_name(const Indivisible& /*step*/) {
  return "indivisible";
}

/// One step, by its key "step". Its schema refers to /definitions/step: steps hold steps.
template <>
struct Codec<Step> {
  static bool read(const Place& at, Step& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  /// What stands under /definitions/step.
  static ordered_json definition();
};

template <class Visitor>
void describe(Visitor& v, NumberRange& r) {
  v.required("from", r.from, "The first value.");
  v.required("to", r.to, "Where it ends: the last value does not pass it.");
  v.optional("step", r.step, "From one value to the next, whichever way it goes.", above(0));
}

template <class Visitor>
void describe(Visitor& v, SetTemperature& s) {
  v.tag("step", step_name(s));
  v.required("mode", s.mode, "Heating mode: boost, normal, or off.");
  v.optional("target_c", s.target_c, "Set point; needed unless the mode is off.");
}

template <class Visitor>
void describe(Visitor& v, Ramp& s) {
  v.tag("step", step_name(s));
  v.required("to_c", s.to_c, "Temperature at its end.");
  v.required("rate_c_per_h", s.rate_c_per_h, "How fast, up or down; 60 is 1 degC/min.", above(0));
  v.optional("mode", s.mode, "Heaters on the way up: boost or normal.");
  v.optional("settle", s.settle,
             "Wait at its end until the temperature has settled, as settle_temperature does.");
  v.optional("segment", s.segment, "Records averages under this name meanwhile.");
  v.optional("window_s", s.window_s, "Length of these averages.", above(0));
}

template <class Visitor>
void describe(Visitor& v, SettleTemperature& s) {
  v.tag("step", step_name(s));
  v.optional("band_c", s.band_c, "How near to the target.", above(0));
  v.optional("dwell_s", s.dwell_s, "How long without a break.", at_least(0));
  v.optional("slope_c_per_h", s.slope_c_per_h, "Largest slope over the dwell.", above(0));
  v.optional("timeout_s", s.timeout_s, "When to give up.", above(0));
  v.optional("segment", s.segment, "Records averages under this name meanwhile.");
  v.optional("window_s", s.window_s, "Length of these averages.", above(0));
}

template <class Visitor>
void describe(Visitor& v, Wait& s) {
  v.tag("step", step_name(s));
  v.optional("duration_s", s.duration_s, "How long.", at_least(0));
  v.optional("operating_time_s", s.operating_time_s,
             "Until so much time has passed since the gyro's power-on.", at_least(0));
  v.optional("segment", s.segment, "Records averages under this name meanwhile.");
  v.optional("window_s", s.window_s, "Length of these averages.", above(0));
}

template <class Visitor>
void describe(Visitor& v, Average& s) {
  v.tag("step", step_name(s));
  v.required("duration_s", s.duration_s, "Length of the average.", above(0));
  v.optional("segment", s.segment, "Name of the point.");
}

template <class Visitor>
void describe(Visitor& v, Baseline& s) {
  v.tag("step", step_name(s));
  v.required("duration_s", s.duration_s, "Length of the average.", above(0));
  v.optional("segment", s.segment, "Name of the point.");
}

template <class Visitor>
void describe(Visitor& v, CompensateField& s) {
  v.tag("step", step_name(s));
  v.optional("tolerance_ut", s.tolerance_ut, "Largest field that may be left on a coil axis.",
             above(0));
}

template <class Visitor>
void describe(Visitor& v, Sweep& s) {
  v.tag("step", step_name(s));
  v.required("axis", s.axis, "Axis of the gyro, or north at any azimuth.");
  v.required("levels_ut", s.levels_ut, "Fields above the compensated zero, in their order.",
             not_empty());
  v.optional("other_pair_ut", s.other_pair_ut,
             "Field that the other pair of coils holds meanwhile.");
  v.optional("duration_s", s.duration_s, "Length of the average at each level.", above(0));
  v.optional("settle_s", s.settle_s, "Wait before each average.", at_least(0));
  v.required("segment", s.segment, "Name of the sweep: coil_x; the branch is appended.");
}

template <class Visitor>
void describe(Visitor& v, Rotate& s) {
  v.tag("step", step_name(s));
  v.required("azimuth_deg", s.azimuth_deg, "Where to turn the gyro to.", between(-360, 360));
}

template <class Visitor>
void describe(Visitor& v, Prompt& s) {
  v.tag("step", step_name(s));
  v.required("text", s.text, "What the operator is asked to do or confirm.");
}

template <class Visitor>
void describe(Visitor& v, Call& s) {
  v.tag("step", step_name(s));
  v.required("procedure", s.procedure, "Name of another procedure.");
  v.optional("parameters", s.parameters, "Values in place of its defaults.");
  v.optional("pass", s.pass,
             "Parameters of it that are this procedure's too, with the defaults that they have "
             "there.");
  v.optional("test", s.test, "Marks its points as test 1, 2...", at_least(1));
}

template <class Visitor>
void describe(Visitor& v, ForEach& s) {
  v.tag("step", step_name(s));
  v.required("variable", s.variable, "Name under which the steps know the value.");
  v.required("in", s.in, "The values.", not_empty());
  v.required("steps", s.steps, "What is done for each.", not_empty());
}

template <class Visitor>
void describe(Visitor& v, Repeat& s) {
  v.tag("step", step_name(s));
  v.required("times", s.times, "How often.", at_least(0));
  v.required("steps", s.steps, "What is done each time.", not_empty());
}

template <class Visitor>
void describe(Visitor& v, Indivisible& s) {
  v.tag("step", step_name(s));
  v.required("steps", s.steps, "Restarted from the first one after any interruption.", not_empty());
}

template <class Visitor>
void describe(Visitor& v, ProcedureConfig& p) {
  v.required("name", p.name, "Short name.");
  v.optional("description", p.description, "What it measures, in a sentence.");
  v.optional("parameters", p.parameters, "Defaults: a number, a list of numbers or a range each.");
  v.optional(
      "needs", p.needs,
      "Channels of the bench's auxiliary sensors without which a point is void; without this "
      "list what such a sensor does not say is missing, and the point counts.");
  v.required("steps", p.steps, "What is done, in order.", not_empty());
}

bool check(const Place& at, const SetTemperature& step);
bool check(const Place& at, const Ramp& step);
bool check(const Place& at, const Wait& step);
bool check(const Place& at, const ForEach& step);
bool check(const Place& at, const ProcedureConfig& procedure);

}  // namespace fogbench::config
