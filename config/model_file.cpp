#include "config/model_file.hpp"

#include <algorithm>

#include "config/describe_model.hpp"

namespace fogbench::config {

bool Codec<Covariance>::read(const Place& at, Covariance& out, const Rule& /*rule*/) {
  if (!at.value().is_array()) return at.wrong("a list of rows");
  const std::size_t size = at.value().size();
  out.rows.clear();
  for (std::size_t i = 0; i < size; ++i) {
    const Place row = at / i;
    if (!row.value().is_array() || row.value().size() != size) {
      return row.wrong(fmt::format("a list of {}, as many as there are rows", size));
    }
    std::vector<double>& values =
        out.rows.emplace_back(size, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t j = 0; j < size; ++j) {
      const Place entry = row / j;
      if (!entry.value().is_null() && !read_number(entry, values[j], {})) return false;
    }
  }
  return true;
}

ordered_json Codec<Covariance>::schema(const Rule& /*rule*/) {
  const ordered_json entry = {{"type", {"number", "null"}}};
  return {{"type", "array"}, {"items", {{"type", "array"}, {"items", entry}}}};
}

ordered_json Codec<Covariance>::write(const Covariance& covariance) {
  return Codec<std::vector<std::vector<double>>>::write(covariance.rows);
}

namespace {

/// "sensitivity(Supply_v)": a form of effect and the column that it acts through.
bool is_form_of_column(std::string_view effect) {
  const std::size_t open = effect.find('(');
  if (open == std::string_view::npos || !effect.ends_with(')') || open + 2 >= effect.size()) {
    return false;
  }
  const std::string_view column = effect.substr(open + 1, effect.size() - open - 2);
  return is_identifier(effect.substr(0, open)) &&
         std::all_of(column.begin(), column.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '_';
         });
}

}  // namespace

bool check(const Place& at, const ModelTerm& t) {
  if (!is_identifier(t.effect) && !is_form_of_column(t.effect))
    return (at / "effect").wrong(kIdentifier);
  if (t.coefficient && !t.coefficients.empty()) {
    return (at / "coefficients").fail("stands beside \"coefficient\"; expected one of them");
  }
  if (t.fixed && !t.coefficient && t.coefficients.empty()) {
    return (at / "fixed").wrong("a coefficient beside it, that it holds");
  }
  return true;
}

bool check(const Place& at, const FitRecord& f) {
  return f.parameter_names.size() == f.covariance.size() ||
         (at / "covariance")
             .wrong(
                 fmt::format("{} rows, one for each of parameter_names", f.parameter_names.size()));
}

bool check(const Place& at, const ModelFile& m) {
  const Place terms = at / "terms";
  for (std::size_t i = 0; i < m.terms.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (m.terms[i].effect == m.terms[j].effect) {
        return (terms / i / "effect")
            .wrong(fmt::format("an effect once; it stands in term {} already", j));
      }
    }
  }
  return true;
}

Result<ModelFile> load_model(const std::filesystem::path& file) {
  return read_config<ModelFile>(file);
}

std::string to_json_text(const ModelFile& model) {
  return pretty_json(Codec<ModelFile>::write(model));
}

}  // namespace fogbench::config
