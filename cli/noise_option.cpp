#include "cli/noise_option.hpp"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <map>

#include "config/scenario.hpp"

namespace fogbench::cli {
namespace {

using NoiseKind = model::FitOptions::Noise;

Error refused(const std::string& noise, const std::string& because,
              ErrorCode code = ErrorCode::kBadInput) {
  return Error{
      code, fmt::format("--noise {}: {}; expected auto, independent, coloured, a grade, N,B,K, or "
                        "a static record",
                        noise, because)};
}

/// "0.001,0.003,0.003"; the last ones may be left out.
std::optional<config::NoiseCoefficients> data_sheet(const std::string& text) {
  double values[3] = {};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (double& value : values) {
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc{}) return {};
    at = stop;
    if (at == end) return config::NoiseCoefficients{values[0], values[1], values[2], 0.0};
    if (*at++ != ',') return {};
  }
  return {};
}

/// The noise that the record leaves around its mean.
Result<ChosenNoise> recorded(const std::string& noise, DataOptions data) {
  if (!run_in_store(noise, data) && !std::filesystem::exists(noise)) {
    return refused(noise, "no such file", ErrorCode::kUsage);
  }
  data.data = {noise};
  data.segment.clear();
  data.tests.clear();
  auto table = load_table(data);
  if (!table) return refused(noise, table.error().message);
  config::ModelFile still;
  still.terms.emplace_back().effect = "bias";
  const auto fitted = model::fit(*table, still, {.noise = NoiseKind::kColoured, .weight_by = {}});
  if (!fitted) return refused(noise, fitted.error().message);
  return ChosenNoise{NoiseKind::kAuto, model::NoisePrior::recorded(fitted->noise),
                     std::move(*table)};
}

}  // namespace

void add_noise_option(CLI::App& command, std::string& noise) {
  command.add_option("--noise", noise,
                     "What is known of the noise: a static record, a grade (tactical, navigation), "
                     "N,B,K of the data sheet (deg/sqrt(h), deg/h, deg/h/sqrt(h)); or how to take "
                     "it from DATA: auto (the default), independent, coloured");
}

Result<ChosenNoise> chosen_noise(const std::string& noise, const DataOptions& data) {
  static const std::map<std::string, NoiseKind> kKinds{{"", NoiseKind::kAuto},
                                                       {"auto", NoiseKind::kAuto},
                                                       {"independent", NoiseKind::kIndependent},
                                                       {"coloured", NoiseKind::kColoured}};
  if (const auto kind = kKinds.find(noise); kind != kKinds.end()) {
    return ChosenNoise{kind->second, {}, {}};
  }
  auto stated = data_sheet(noise);
  if (noise.find_first_not_of("0123456789") == std::string::npos) stated.reset();  // a run
  if (const auto grade = config::noise_grade(noise); grade) stated = *grade;
  if (!stated) return recorded(noise, data);
  const auto prior = model::NoisePrior::stated(*stated);
  if (!prior) return refused(noise, prior.error().message);
  return ChosenNoise{NoiseKind::kAuto, *prior, {}};
}

}  // namespace fogbench::cli
