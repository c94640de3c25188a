#include "cli/compare_pair.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/noise_option.hpp"
#include "cli/output.hpp"
#include "cli/page_file.hpp"
#include "cli/shell_word.hpp"
#include "config/paths.hpp"
#include "config/rounding.hpp"
#include "model/compare/compare.hpp"
#include "model/compare/conclusions.hpp"
#include "model/compare/difference.hpp"
#include "model/report/difference_report.hpp"
#include "model/table/row_order.hpp"

namespace fogbench::cli {
namespace {

using nlohmann::ordered_json;

/// One of the two.
struct Side {
  DataOptions data;
  std::string name, gyro;
  model::Table table;
  std::optional<model::Comparison> comparison;

  bool adequate() const { return comparison->p_adequate >= model::kAdequate; }
};

Result<Side> load_side(const PairOptions& options, std::size_t which) {
  Side side{.data = options.data, .name = {}, .gyro = {}, .table = {}, .comparison = {}};
  side.data.data = {options.data.data[which]};
  side.name = data_name(side.data);
  auto gyro = gyro_of(side.data.data.front(), side.data);
  if (!gyro) return gyro.error();
  side.gyro = std::move(*gyro);
  auto table = load_table(side.data);
  if (!table) return table.error();
  side.table = std::move(*table);
  return side;
}

bool any(const model::Table& table, const char* column, bool (*is)(double)) {
  if (!table.has(column)) return false;
  const auto values = table.column(column);
  return std::any_of(values.begin(), values.end(), is);
}

struct ChosenModel {
  config::ModelFile file;
  std::string name;  ///< as --model takes it; empty: a bias, which is no file
};

/// The one that was named, else the ready one of what either excited (what the other did not is
/// left out of its fit); a bias where that is nothing.
Result<ChosenModel> model_for(const std::string& named, const Side& a, const Side& b) {
  const auto either = [&](const char* column, bool (*is)(double)) {
    return any(a.table, column, is) || any(b.table, column, is);
  };
  const bool heated = either("heater_w", [](double watts) { return watts > 0.0; });
  const bool swept = either("field_set_ut", [](double level) { return std::isfinite(level); });
  std::string name = named;
  if (name.empty())
    name = heated && swept ? "general" : heated ? "thermal" : swept ? "magnetic" : "";
  if (name.empty()) {
    ChosenModel still;
    still.file.name = "bias";
    still.file.terms.emplace_back().effect = "bias";
    return still;
  }
  const auto file = config::find_config("models", name);
  if (!file) return file.error();
  auto model = config::load_model(*file);
  if (!model) return model.error();
  return ChosenModel{std::move(*model), std::move(name)};
}

Status fit_side(Side& side, const config::ModelFile& model, const PairOptions& options) {
  const std::vector<std::string> notes = model::mend_stamps(side.table, model.observable);
  const auto noise = chosen_noise(options.noise, side.data);
  if (!noise) return noise.error();
  auto result = model::compare(side.table, model,
                               {.noise = noise->kind,
                                .weight_by = options.weight_by,
                                .as_is = false,
                                .prior = noise->prior});
  if (!result) {
    const Error error = with_notes(result.error(), notes);
    return Error{error.code, side.name + ": " + error.message};
  }
  for (const std::string& note : notes) print_note(side.name + ": " + note);
  side.comparison = std::move(*result);
  return {};
}

std::string gyros_text(const Side& a, const Side& b) {
  if (a.gyro.empty() || b.gyro.empty()) return "Whether one gyro made both is not on record.";
  if (a.gyro == b.gyro) return fmt::format("One gyro, {}, made both.", a.gyro);
  return fmt::format("Two gyros: {} is of {}, {} of {}.", a.name, a.gyro, b.name, b.gyro);
}

std::string with_expanded(double value, double expanded, const std::string& unit) {
  const config::Rounded r = config::rounded(value, expanded);
  return fmt::format("{} +- {} {}", r.value, r.uncertainty, unit);
}

std::string difference_text(const model::Difference& d) {
  if (d.coefficients.empty()) return "No coefficient is determined in both: nothing to compare.";
  const std::string chance = fmt::format("chance that noise alone makes them differ so: {}",
                                         model::probability_text(d.p_same));
  std::vector<const model::CoefficientDifference*> apart;
  for (const auto& c : d.coefficients) {
    if (c.differs()) apart.push_back(&c);
  }
  if (apart.empty()) {
    return fmt::format("No coefficient differs by more than noise explains{}; {}.",
                       d.differs() ? ", but together they do" : "", chance);
  }
  std::stable_sort(apart.begin(), apart.end(), [](const auto* x, const auto* y) {
    return std::abs(x->difference) / x->expanded_uncertainty >
           std::abs(y->difference) / y->expanded_uncertainty;
  });
  const model::CoefficientDifference& first = *apart.front();
  return fmt::format(
      "{} of {} coefficients differ{} by more than noise explains, {}{} by {}; {}.", apart.size(),
      d.coefficients.size(), apart.size() == 1 ? "s" : "", apart.size() == 1 ? "" : "above all ",
      first.name, with_expanded(first.difference, first.expanded_uncertainty, first.unit), chance);
}

std::vector<std::string> sentences_on(const model::Difference& d, const Side& a, const Side& b) {
  std::vector<std::string> out{difference_text(d), gyros_text(a, b)};
  if (!a.gyro.empty() && a.gyro == b.gyro &&
      std::any_of(d.coefficients.begin(), d.coefficients.end(),
                  [](const auto& c) { return c.name == "bias" && c.differs(); })) {
    out.emplace_back("A bias may change from one switching-on to the next.");
  }
  for (const Side* side : {&a, &b}) {
    if (side->adequate()) continue;
    out.push_back(fmt::format(
        "The model misses {} by more than noise explains ({}): its coefficients carry what the "
        "model lacks.",
        side->name, model::probability_text(side->comparison->p_adequate)));
  }
  if (!d.not_in_both.empty()) {
    out.push_back(fmt::format("Not determined in both, so not compared: {}.",
                              fmt::join(d.not_in_both, ", ")));
  }
  return out;
}

/// Empty: nothing.
std::string next_step(const PairOptions& options, const std::string& model, bool differs,
                      const Side& a, const Side& b) {
  for (const Side* side : {&a, &b}) {
    if (side->adequate() || model.empty()) continue;
    return fmt::format("fogbench diagnose {} --model {}   # says which effect the model lacks",
                       data_arguments(side->data), shell_word(model));
  }
  if (options.report.empty()) {
    std::string same = "fogbench compare " + data_arguments(options.data);
    if (!options.model.empty()) same += " --model " + shell_word(options.model);
    return same + " --report page.html";
  }
  if (a.gyro != b.gyro || model.empty()) return "";
  return differs ? fmt::format("fogbench diagnose {} --model {}   # says what changed",
                               data_arguments(options.data), shell_word(model))
                 : fmt::format("fogbench fit {} --model {} -o fitted.json",
                               data_arguments(options.data), shell_word(model));
}

void print_text(const model::Difference& d, const std::vector<std::string>& sentences,
                const std::string& next, const Side& a, const Side& b) {
  using Align = TextTable::Align;
  TextTable table({{"term", "", Align::kLeft},
                   {a.name, ""},
                   {"+- U", ""},
                   {b.name, ""},
                   {"+- U", ""},
                   {"difference", ""},
                   {"+- U", ""},
                   {"p of all", ""},
                   {"unit", "", Align::kLeft}});
  for (const model::CoefficientDifference& c : d.coefficients) {
    const config::Rounded first = config::rounded(c.a, c.expanded_a),
                          second = config::rounded(c.b, c.expanded_b),
                          apart = config::rounded(c.difference, c.expanded_uncertainty);
    table.add_row({c.name, first.value, first.uncertainty, second.value, second.uncertainty,
                   apart.value, apart.uncertainty,
                   c.p_of_all < 1e-4 ? "< 0.0001" : fmt::format("{:.2g}", c.p_of_all), c.unit});
  }
  for (const std::string& sentence : sentences) fmt::print("{}\n", sentence);
  if (!next.empty()) fmt::print("Next: {}\n", next);
  fmt::print("\n{}", table.text());
  fmt::print(
      "\nU: expanded uncertainty, 95.45 %. p of all: chance that noise lets any of the "
      "coefficients\ndiffer so much.\n");
}

ordered_json to_json(const model::Difference& d, const std::vector<std::string>& sentences,
                     const std::string& next, const std::string& model, const Side& a,
                     const Side& b) {
  ordered_json same, coefficients = ordered_json::array();
  if (!a.gyro.empty() && !b.gyro.empty()) same = a.gyro == b.gyro;
  for (const model::CoefficientDifference& c : d.coefficients) {
    coefficients.push_back({{"name", c.name},
                            {"unit", c.unit},
                            {"values", {c.a, c.b}},
                            {"expanded_uncertainties", {c.expanded_a, c.expanded_b}},
                            {"difference", c.difference},
                            {"expanded_uncertainty", c.expanded_uncertainty},
                            {"p_of_all", c.p_of_all},
                            {"differs", c.differs()}});
  }
  return {{"data", {a.name, b.name}},
          {"gyros", {a.gyro, b.gyro}},
          {"same_gyro", same},
          {"model", model},
          {"differs", d.differs()},
          {"p_same", d.p_same},
          {"coefficients", coefficients},
          {"not_in_both", d.not_in_both},
          {"p_adequate", {a.comparison->p_adequate, b.comparison->p_adequate}},
          {"sentences", sentences},
          {"next", next.empty() ? ordered_json() : ordered_json(next)}};
}

}  // namespace

Result<ExitStatus> compare_pair(const PairOptions& options) {
  std::optional<PageFile> page;
  if (!options.report.empty()) {
    auto opened = PageFile::open(options.report);
    if (!opened) return opened.error();
    page = std::move(*opened);
  }
  auto a = load_side(options, 0), b = load_side(options, 1);
  if (!a) return a.error();
  if (!b) return b.error();
  const auto model = model_for(options.model, *a, *b);
  if (!model) return model.error();
  for (Side* side : {&*a, &*b}) {
    if (const Status fitted = fit_side(*side, model->file, options); !fitted) return fitted.error();
  }
  const model::Difference d = model::difference_between(a->comparison->fit, b->comparison->fit);
  const std::vector<std::string> sentences = sentences_on(d, *a, *b);
  const std::string next = next_step(options, model->name, d.differs(), *a, *b);
  if (page) {
    const Status written =
        page->write(model::difference_html(d, sentences, a->name, b->name, model->file.name));
    if (!written) return written.error();
  }
  if (options.json) {
    print_json(to_json(d, sentences, next, model->file.name, *a, *b));
  } else {
    print_text(d, sentences, next, *a, *b);
    if (page) fmt::print("\nReport: {}\n", options.report);
  }
  return options.check && d.differs() ? ExitStatus::kNo : ExitStatus::kDone;
}

}  // namespace fogbench::cli
