#include "config/procedure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "config/describe_procedure.hpp"

namespace fogbench::config {
namespace {

constexpr std::string_view kNumberOrName = "a number or the \"$name\" of a parameter";
constexpr std::string_view kListOrName =
    "a list of numbers, {\"from\", \"to\", \"step\"}, or the \"$name\" of a parameter";

/// "$" and an identifier.
bool is_reference(const nlohmann::json& value) {
  if (!value.is_string()) return false;
  const auto& text = value.get_ref<const std::string&>();
  return text.starts_with('$') && is_identifier(std::string_view(text).substr(1));
}

ordered_json reference_schema() {
  return {{"type", "string"}, {"pattern", "^\\$[a-z][a-z0-9_]*$"}};
}

/// Reads what may be a list or a range, once it is known to be one of them.
template <class Value>
bool read_list(const Place& at, Value& out, const Rule& rule) {
  if (at.value().is_object()) {
    return Codec<NumberRange>::read(at, out.template emplace<NumberRange>(), {});
  }
  return Codec<std::vector<double>>::read(at, out.template emplace<std::vector<double>>(), rule);
}

ordered_json list_or_range(const Rule& rule = {}) {
  return {schema_of<std::vector<double>>(rule), schema_of<NumberRange>()};
}

template <class T>
ordered_json written(const T& value) {
  return ordered_json(value);
}
ordered_json written(const NumberRange& range) {
  return Codec<NumberRange>::write(range);
}

void collect_passed(const std::vector<Step>& steps, std::vector<std::string>& names) {
  for (const Step& step : steps) {
    std::visit(
        [&names](const auto& action) {
          if constexpr (requires { action.pass; }) {
            names.insert(names.end(), action.pass.begin(), action.pass.end());
          } else if constexpr (requires { action.steps; }) {
            collect_passed(action.steps, names);
          }
        },
        step.action);
  }
}

using Action = decltype(Step::action);

/// Reads alternative I when it is the one named, else looks at the next.
template <std::size_t I = 0>
bool read_action(const Place& at, const std::string& name, Action& out,
                 const std::string& known = "") {
  if constexpr (I == std::variant_size_v<Action>) {
    return (at / "step").wrong("one of" + known);
  } else {
    using Alternative = std::variant_alternative_t<I, Action>;
    const std::string_view own_name = step_name(Alternative{});
    if (name == own_name) return Codec<Alternative>::read(at, out.emplace<I>(), {});
    return read_action<I + 1>(at, name, out,
                              fmt::format("{}{}{}", known, I == 0 ? " " : ", ", own_name));
  }
}

template <std::size_t... I>
ordered_json action_schemas(std::index_sequence<I...> /*alternatives*/) {
  ordered_json list = ordered_json::array();
  (list.push_back(schema_of<std::variant_alternative_t<I, Action>>()), ...);
  return list;
}

}  // namespace

bool Codec<Number>::read(const Place& at, Number& out, const Rule& rule) {
  if (is_reference(at.value())) {
    out = at.value().get<std::string>();
    return true;
  }
  if (!at.value().is_number()) return at.wrong(kNumberOrName);
  return read_number(at, out.emplace<double>(), rule);
}

ordered_json Codec<Number>::schema(const Rule& rule) {
  return {{"anyOf", {schema_of<double>(rule), reference_schema()}}};
}

ordered_json Codec<Number>::write(const Number& number) {
  return std::visit([](const auto& value) { return ordered_json(value); }, number);
}

bool Codec<NumberList>::read(const Place& at, NumberList& out, const Rule& rule) {
  if (is_reference(at.value())) {
    out = at.value().get<std::string>();
    return true;
  }
  if (!at.value().is_array() && !at.value().is_object()) return at.wrong(kListOrName);
  return read_list(at, out, rule);
}

ordered_json Codec<NumberList>::schema(const Rule& rule) {
  ordered_json shapes = list_or_range(rule);
  shapes.push_back(reference_schema());
  return {{"anyOf", std::move(shapes)}};
}

bool Codec<Argument>::read(const Place& at, Argument& out, const Rule& /*rule*/) {
  if (is_reference(at.value())) {
    out = at.value().get<std::string>();
    return true;
  }
  if (at.value().is_number()) return read_number(at, out.emplace<double>(), {});
  if (at.value().is_array() || at.value().is_object()) return read_list(at, out, {});
  return at.wrong(fmt::format("a number, {}", kListOrName));
}

ordered_json Codec<Argument>::schema(const Rule& /*rule*/) {
  ordered_json shapes = list_or_range();
  shapes.insert(shapes.begin(), schema_of<double>());
  shapes.push_back(reference_schema());
  return {{"anyOf", std::move(shapes)}};
}

ordered_json Codec<Argument>::write(const Argument& argument) {
  return std::visit([](const auto& value) { return written(value); }, argument);
}

bool Codec<ParameterValue>::read(const Place& at, ParameterValue& out, const Rule& /*rule*/) {
  if (at.value().is_number()) return read_number(at, out.emplace<double>(), {});
  if (at.value().is_object()) {
    NumberRange range;
    if (!Codec<NumberRange>::read(at, range, {})) return false;
    std::array<double, 3> bounds{};
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      const Number& bound = i == 0 ? range.from : i == 1 ? range.to : range.step;
      const double* const number = std::get_if<double>(&bound);
      if (number == nullptr) return at.wrong("numbers in the default of a parameter");
      bounds[i] = *number;
    }
    auto values = range_values(bounds[0], bounds[1], bounds[2]);
    if (!values) return at.fail(values.error().message);
    out = std::move(*values);
    return true;
  }
  if (!at.value().is_array()) {
    return at.wrong("a number, a list of numbers or {\"from\", \"to\", \"step\"}");
  }
  return Codec<std::vector<double>>::read(at, out.emplace<std::vector<double>>(), {});
}

ordered_json Codec<ParameterValue>::schema(const Rule& /*rule*/) {
  ordered_json shapes = list_or_range();
  shapes.insert(shapes.begin(), schema_of<double>());
  return {{"anyOf", std::move(shapes)}};
}

ordered_json Codec<ParameterValue>::write(const ParameterValue& value) {
  return std::visit([](const auto& v) { return ordered_json(v); }, value);
}

bool Codec<Step>::read(const Place& at, Step& out, const Rule& /*rule*/) {
  if (!at.value().is_object()) return at.wrong("an object");
  out.pointer = at.pointer();
  const Place step = at / "step";
  const bool named = step.present() && step.value().is_string();
  return read_action(at, named ? step.value().get<std::string>() : "", out.action);
}

ordered_json Codec<Step>::schema(const Rule& /*rule*/) {
  return {{"$ref", "#/definitions/step"}};
}

ordered_json Codec<Step>::definition() {
  return {{"oneOf", action_schemas(std::make_index_sequence<std::variant_size_v<Action>>())}};
}

bool check(const Place& at, const SetTemperature& s) {
  const Place target = at / "target_c";
  if (s.mode != HeatingMode::kOff && !target.present()) {
    return target.wrong("a set point, as the mode is not off");
  }
  return true;
}

bool check(const Place& at, const Ramp& s) {
  return s.mode != HeatingMode::kOff ||
         (at / "mode").wrong("\"boost\" or \"normal\": a ramp holds its way with the heaters");
}

bool check(const Place& at, const Wait& /*step*/) {
  return (at / "duration_s").present() || (at / "operating_time_s").present() ||
         at.fail("has neither \"duration_s\" nor \"operating_time_s\"; expected one of them");
}

bool check(const Place& at, const ForEach& s) {
  return is_identifier(s.variable) || (at / "variable").wrong(kIdentifier);
}

Result<std::vector<double>> range_values(double from, double to, double step) {
  if (!std::isfinite(from) || !std::isfinite(to) || !std::isfinite(step) || step <= 0.0) {
    return bad_input(fmt::format(
        "a range from {} to {} in steps of {}; expected a step above 0, whichever way it goes",
        from, to, step));
  }
  // Three times 0.1 is 0.3 too, though not in floating point.
  constexpr double kRounding = 1e-6;
  const double steps = std::floor(std::abs(to - from) / step + kRounding);
  if (steps >= static_cast<double>(kMostValues)) {
    return bad_input(fmt::format("a range from {} to {} in steps of {}; expected {} values at most",
                                 from, to, step, kMostValues));
  }
  std::vector<double> values(static_cast<std::size_t>(steps) + 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = from + std::copysign(step, to - from) * static_cast<double>(i);
  }
  if (std::abs(values.back() - to) <= kRounding * step) values.back() = to;
  return values;
}

std::vector<std::string> passed_parameters(const ProcedureConfig& procedure) {
  std::vector<std::string> names;
  collect_passed(procedure.steps, names);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

bool check(const Place& at, const ProcedureConfig& p) {
  const Place parameters = at / "parameters";
  for (const auto& [name, value] : p.parameters) {
    if (!is_identifier(name)) return (parameters / name).fail(kIdentifierExpected);
  }
  return true;
}

Result<ProcedureConfig> load_procedure(const std::filesystem::path& file) {
  ProcedureConfig procedure;
  auto problems = check_procedure_file(file, procedure);
  if (!problems.empty()) return std::move(problems.front());
  return procedure;
}

std::vector<Error> check_procedure_file(const std::filesystem::path& file, ProcedureConfig& out) {
  out.file = file;
  return read_config(file, out);
}

}  // namespace fogbench::config
