#pragma once
// Model files (config/models/*.json): the terms of an error model, as a user writes them and as a
// fit returns them. A fitted model file is a valid input again.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "config/scenario.hpp"

namespace fogbench::config {

/// One term. An effect of the catalogue, or an `expression` over the table's columns.
/// Without a coefficient it is fitted; with one it is held when `fixed`, else the coefficient is
/// the published or fitted value. Effects with several columns (cos and sin) give `coefficients`
/// by column name instead.
struct ModelTerm {
  std::string effect;
  std::optional<double> coefficient;
  std::map<std::string, double> coefficients;
  bool fixed = false;
  std::map<std::string, double> parameters;  ///< inner: starting values in, estimates out
  std::optional<std::string> expression;
  std::string unit;
  /// What a fit adds: standard errors by coefficient and inner parameter name.
  std::map<std::string, double> standard_errors;
};

/// What a fit adds to a model file.
struct FitRecord {
  std::string data;  ///< file or run that was fitted
  std::string data_sha256;
  std::vector<std::string> read_as;  ///< what was recognised in it: units, names, dialect
  std::string fitted_at;             ///< ISO 8601, UTC
  std::string software_version;
  std::vector<std::string> parameter_names;  ///< rows and columns of the covariance
  std::vector<std::vector<double>> covariance;
  NoiseCoefficients noise;
  double rms_deg_per_h = 0.0;
  double degrees_of_freedom = 0.0;
  std::size_t rows = 0;
};

struct ModelFile {
  std::string name;
  std::string description;
  std::string observable = "rate_deg_per_h";
  double reference_temperature_c = 21.0;
  std::vector<ModelTerm> terms;
  std::optional<FitRecord> fit;
};

/// Errors: kBadInput, one line with the file and the JSON pointer (unknown keys, an effect twice,
/// wrong types). Whether an effect exists is the catalogue's to say (model/).
Result<ModelFile> load_model(const std::filesystem::path& file);
/// The file's text, keys in the order of the struct, numbers with the shortest exact digits.
std::string to_json_text(const ModelFile& model);

}  // namespace fogbench::config
