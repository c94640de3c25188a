#include "config/procedure.hpp"

#include "config/describe_procedure.hpp"

namespace fogbench::config {
namespace {

constexpr std::string_view kNumberOrName = "a number or the \"$name\" of a parameter";
constexpr std::string_view kListOrName = "a list of numbers or the \"$name\" of a parameter";

/// "$" and an identifier.
bool is_reference(const nlohmann::json& value) {
  if (!value.is_string()) return false;
  const auto& text = value.get_ref<const std::string&>();
  return text.starts_with('$') && is_identifier(std::string_view(text).substr(1));
}

ordered_json or_reference(ordered_json schema) {
  const ordered_json reference = {{"type", "string"}, {"pattern", "^\\$[a-z][a-z0-9_]*$"}};
  return {{"anyOf", {std::move(schema), reference}}};
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
  return or_reference(schema_of<double>(rule));
}

ordered_json Codec<Number>::write(const Number& number) {
  return std::visit([](const auto& value) { return ordered_json(value); }, number);
}

bool Codec<NumberList>::read(const Place& at, NumberList& out, const Rule& rule) {
  if (is_reference(at.value())) {
    out = at.value().get<std::string>();
    return true;
  }
  if (!at.value().is_array()) return at.wrong(kListOrName);
  return Codec<std::vector<double>>::read(at, out.emplace<std::vector<double>>(), rule);
}

ordered_json Codec<NumberList>::schema(const Rule& rule) {
  return or_reference(schema_of<std::vector<double>>(rule));
}

bool Codec<ParameterValue>::read(const Place& at, ParameterValue& out, const Rule& /*rule*/) {
  if (at.value().is_number()) return read_number(at, out.emplace<double>(), {});
  if (!at.value().is_array()) return at.wrong("a number or a list of numbers");
  return Codec<std::vector<double>>::read(at, out.emplace<std::vector<double>>(), {});
}

ordered_json Codec<ParameterValue>::schema(const Rule& /*rule*/) {
  return {{"anyOf", {schema_of<double>(), schema_of<std::vector<double>>()}}};
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

bool check(const Place& at, const Wait& /*step*/) {
  return (at / "duration_s").present() || (at / "operating_time_s").present() ||
         at.fail("has neither \"duration_s\" nor \"operating_time_s\"; expected one of them");
}

bool check(const Place& at, const ForEach& s) {
  return is_identifier(s.variable) || (at / "variable").wrong(kIdentifier);
}

bool check(const Place& at, const ProcedureConfig& p) {
  const Place parameters = at / "parameters";
  for (const auto& [name, value] : p.parameters) {
    if (!is_identifier(name)) return (parameters / name).fail(kIdentifierExpected);
  }
  return true;
}

Result<ProcedureConfig> load_procedure(const std::filesystem::path& file) {
  auto procedure = read_config<ProcedureConfig>(file);
  if (procedure) procedure->file = file;
  return procedure;
}

}  // namespace fogbench::config
