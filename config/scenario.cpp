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

constexpr std::array<std::string_view, 6> kInstruments = {
    "thermostat", "coil_horizontal", "coil_vertical", "magnetometer", "turntable", "gyro"};

}  // namespace

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
  return is_identifier(h.effect) || (at / "effect").wrong(kIdentifier);
}

bool check(const Place& at, const FaultSpec& f) {
  return std::find(kInstruments.begin(), kInstruments.end(), f.device) != kInstruments.end() ||
         (at / "device").wrong(fmt::format("one of {}", fmt::join(kInstruments, ", ")));
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
