#include "config/scenario.hpp"

#include <algorithm>

#include "config/describe_scenario.hpp"

namespace fogbench::config {
namespace {

struct Grade {
  std::string_view name;
  NoiseCoefficients noise;
};

/// Typical of the literature, not of one gyro: N deg/sqrt(h), B deg/h, K deg/h/sqrt(h), Q deg.
constexpr std::array<Grade, 3> kGrades = {{{"none", {0.0, 0.0, 0.0, 0.0}},
                                           {"navigation", {0.001, 0.003, 0.003, 0.0}},
                                           {"tactical", {0.005, 0.02, 0.02, 0.0}}}};

}  // namespace

std::vector<std::string_view> operations_of(std::string_view device) {
  if (device == "thermostat") return {"read", "set_target", "set_mode"};
  if (device == "magnetometer") return {"report"};
  if (device == "gyro") return {"frame"};
  std::vector<std::string_view> names{"clear",     "identify", "initialise", "set",
                                      "set_query", "measure",  "error_query"};
  if (device == "turntable") return names;
  if (device != "coil_horizontal" && device != "coil_vertical") return {"read"};
  names.insert(names.end(), {"output_on", "output_off"});
  return names;
}

Result<NoiseCoefficients> noise_grade(const std::string& name) {
  std::string known;
  for (const Grade& grade : kGrades) {
    if (grade.name == name) return grade.noise;
    known += fmt::format("{}\"{}\"", known.empty() ? "" : ", ", grade.name);
  }
  return Error{ErrorCode::kBadInput, fmt::format("noise grade \"{}\" is not known; expected one of "
                                                 "{}",
                                                 one_line(name), known)};
}

bool Codec<NoiseChoice>::read(const Place& at, NoiseChoice& out, const Rule& /*rule*/) {
  if (at.value().is_object()) return Codec<NoiseCoefficients>::read(at, out.noise, {});
  if (!at.value().is_string()) return at.wrong("a grade's name or an object");
  const auto grade = noise_grade(at.value().get_ref<const std::string&>());
  if (!grade) return at.fail(grade.error().message);
  out.noise = *grade;
  return true;
}

ordered_json Codec<NoiseChoice>::schema(const Rule& /*rule*/) {
  ordered_json names = ordered_json::array();
  for (const Grade& grade : kGrades) names.push_back(grade.name);
  return {{"anyOf", {{{"type", "string"}, {"enum", names}}, schema_of<NoiseCoefficients>()}}};
}

ordered_json Codec<NoiseChoice>::write(const NoiseChoice& choice) {
  return Codec<NoiseCoefficients>::write(choice.noise);
}

bool check(const Place& at, const HiddenEffect& h) {
  std::string_view name = h.effect;
  if (name.starts_with("sensitivity(") && name.ends_with(")")) {
    name.remove_prefix(name.find('(') + 1);
    name.remove_suffix(1);
  }
  return is_identifier(name) || (at / "effect").wrong(kIdentifier);
}

bool check(const Place& at, const FaultSpec& f) {
  if (!is_identifier(f.device)) return (at / "device").wrong(kIdentifier);
  const auto operations = operations_of(f.device);
  if (!f.operation.empty() &&
      std::find(operations.begin(), operations.end(), f.operation) == operations.end()) {
    return (at / "operation").wrong(fmt::format("one of {}", fmt::join(operations, ", ")));
  }
  const bool counted = (at / "at_operation").present();
  const bool timed = (at / "at_s").present();
  if (counted == timed) return at.fail("expected either at_s and for_s, or at_operation");
  if (timed != (at / "for_s").present()) {
    return at.fail(timed ? "has at_s, but not for_s" : "has for_s, which goes with at_s");
  }
  return counted || !(at / "for_operations").present() ||
         at.fail("has for_operations, which goes with at_operation");
}

bool check(const Place& at, const ScenarioConfig& s) {
  const Place gyro = at / "gyro";
  const Place terms = gyro / "terms";
  for (const auto& [effect, coefficient] : s.terms) {
    if (!is_identifier(effect)) return (terms / effect).fail(kIdentifierExpected);
  }
  for (std::size_t i = 1; i < s.magnetic_scale.size(); ++i) {
    if (s.magnetic_scale[i].at <= s.magnetic_scale[i - 1].at) {
      return (at / "magnetic_scale" / i / "at_s")
          .wrong(fmt::format("a time after {} s", s.magnetic_scale[i - 1].at.count()));
    }
  }
  return true;
}

Result<ScenarioConfig> load_scenario(const std::filesystem::path& file) {
  return read_config<ScenarioConfig>(file);
}

}  // namespace fogbench::config
