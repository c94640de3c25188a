#include "model/fit/design.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/effects/catalogue.hpp"

namespace fogbench::model {
namespace {

/// Rows that are evaluated at once when no term has a history.
constexpr std::size_t kBlock = 8192;

Error bad_term(const config::ModelTerm& term, const std::string& what) {
  return {ErrorCode::kBadInput, fmt::format("term {}: {}", term.effect, what)};
}

/// Names that any expression term of the model declares: they are shared between those terms.
std::set<std::string> declared_parameters(const config::ModelFile& model) {
  std::set<std::string> names;
  for (const config::ModelTerm& term : model.terms) {
    if (!term.expression) continue;
    for (const auto& [name, value] : term.parameters) names.insert(name);
  }
  return names;
}

/// A times b's step: small enough that the fourth-order formula is exact to rounding.
double derivative_step(double value) {
  return value != 0.0 ? 1e-4 * std::abs(value) : 1e-4;
}

}  // namespace

Result<Design> Design::make(const Signals& signals, const config::ModelFile& model,
                            bool hold_given) {
  Design design(signals);
  if (model.terms.empty()) {
    return Error{ErrorCode::kBadInput, "the model has no terms, expected at least one"};
  }
  for (const config::ModelTerm& term : model.terms) {
    const Effect* effect = find_effect(term.effect);
    if (term.expression && effect != nullptr) {
      return bad_term(term,
                      "is an effect of the catalogue, expected another name beside an "
                      "expression");
    }
    if (!term.expression && effect == nullptr) {
      return bad_term(term, unknown_effect(term.effect) + "; a new one needs an expression");
    }
    design.terms_.push_back({term.effect, effect, {}, {}});
    Status added =
        term.expression ? design.add_expression(term, model) : design.add_effect(term, *effect);
    if (!added) return added.error();
    if (term.expression) {
      added = design.add_column(term, "", term.unit, hold_given);
      if (!added) return added.error();
      continue;
    }
    const EffectInfo& info = effect->info();
    const bool of_the_catalogue =
        term.unit.empty() ||
        std::find(info.units.begin(), info.units.end(), term.unit) != info.units.end();
    if (!of_the_catalogue) {
      return bad_term(term, fmt::format("has the unit \"{}\", expected the catalogue's \"{}\"",
                                        term.unit, fmt::join(info.units, "\", \"")));
    }
    for (std::size_t i = 0; i < info.columns.size(); ++i) {
      added = design.add_column(term, std::string(info.columns[i]), std::string(info.units[i]),
                                hold_given);
      if (!added) return added.error();
    }
  }
  design.own_columns_ = design.columns_.size();
  design.add_starts();
  return design;
}

void Design::add_starts() {
  for (std::size_t term = 0; term < terms_.size(); ++term) {
    if (!has_history(term)) continue;
    const EffectInfo& info = std::get<const Effect*>(terms_[term].what)->info();
    std::vector<double> somewhere;
    for (const InnerParameter& parameter : info.parameters) somewhere.push_back(parameter.maximum);
    const Eigen::Index count =
        std::get<const Effect*>(terms_[term].what)->starts(*signals_, somewhere).cols();
    for (Eigen::Index i = 0; i < count; ++i) {
      DesignColumn column;
      column.name = fmt::format("start {} of {}", i + 1, terms_[term].name);
      column.unit = info.units.front();
      column.term = term;
      column.column = static_cast<Eigen::Index>(terms_[term].columns.size());
      column.start = true;
      terms_[term].columns.push_back(columns_.size());
      columns_.push_back(std::move(column));
    }
  }
}

Status Design::add_column(const config::ModelTerm& term, std::string key, std::string unit,
                          bool hold_given) {
  DesignColumn column;
  column.name = key.empty() ? term.effect : term.effect + "." + key;
  column.unit = std::move(unit);
  column.term = terms_.size() - 1;
  column.column = static_cast<Eigen::Index>(terms_.back().columns.size());
  if (key.empty()) {
    column.given = term.coefficient;
    if (!term.coefficients.empty()) {
      return bad_term(term, "found coefficients by name, expected one coefficient");
    }
  } else {
    const auto found = term.coefficients.find(key);
    if (found != term.coefficients.end()) column.given = found->second;
    if (term.coefficient) {
      return bad_term(term, fmt::format("found one coefficient, expected coefficients by name "
                                        "({})",
                                        key));
    }
  }
  column.key = std::move(key);
  if (term.fixed && !column.given) {
    return bad_term(term, fmt::format("is fixed, but {} has no coefficient", column.name));
  }
  column.held = column.given && (term.fixed || hold_given);
  terms_.back().columns.push_back(columns_.size());
  columns_.push_back(std::move(column));
  return {};
}

Status Design::add_effect(const config::ModelTerm& term, const Effect& effect) {
  const EffectInfo& info = effect.info();
  const std::vector<std::string> missing = signals_->missing_for(info);
  if (!missing.empty()) return bad_term(term, signals_->table().why_missing(missing.front()));
  for (const auto& [name, value] : term.coefficients) {
    if (std::find(info.columns.begin(), info.columns.end(), name) == info.columns.end()) {
      return bad_term(term, fmt::format("found the coefficient '{}', expected {}", name,
                                        fmt::join(info.columns, ", ")));
    }
  }
  for (const auto& [name, value] : term.parameters) {
    const bool known =
        std::any_of(info.parameters.begin(), info.parameters.end(),
                    [&name = name](const InnerParameter& p) { return p.name == name; });
    if (!known && info.parameters.empty()) {
      return bad_term(term, fmt::format("found the parameter '{}', expected none", name));
    }
    if (!known) {
      return bad_term(term, fmt::format("found the parameter '{}', expected {}", name,
                                        info.parameters.front().name));
    }
  }
  for (const InnerParameter& inner : info.parameters) {
    DesignParameter parameter;
    parameter.key = std::string(inner.name);
    parameter.name = term.effect + "." + parameter.key;
    parameter.unit = std::string(inner.unit);
    parameter.range = inner;
    parameter.terms = {terms_.size() - 1};
    if (!inner.within.empty()) {
      const Signals::View observed = signals_->signal(inner.within);
      parameter.range->minimum = observed.minCoeff<Eigen::PropagateNumbers>();
      parameter.range->maximum = observed.maxCoeff<Eigen::PropagateNumbers>();
    }
    const auto found = term.parameters.find(parameter.key);
    if (found != term.parameters.end()) {
      parameter.start = found->second;
      if (inner.logarithmic && !(found->second > 0.0)) {
        return bad_term(term, fmt::format("parameter {}: found {}, expected a positive number",
                                          parameter.key, found->second));
      }
    }
    terms_.back().parameters.push_back(parameters_.size());
    parameters_.push_back(std::move(parameter));
  }
  return {};
}

Status Design::add_expression(const config::ModelTerm& term, const config::ModelFile& model) {
  Result<Expression> expression =
      Expression::parse(term.effect, *term.expression, declared_parameters(model), *signals_);
  if (!expression) return expression.error();
  for (const std::string& key : expression->parameters()) {
    // The first declaration of a shared name gives its start, wherever in the model it stands.
    const auto declares = [&](const config::ModelTerm& t) {
      return t.expression && t.parameters.contains(key);
    };
    const auto owner = std::find_if(model.terms.begin(), model.terms.end(), declares);
    const std::string name = owner->effect + "." + key;
    auto known = std::find_if(parameters_.begin(), parameters_.end(),
                              [&](const DesignParameter& p) { return p.name == name; });
    if (known == parameters_.end()) {
      DesignParameter parameter;
      parameter.key = key;
      parameter.name = name;
      parameter.start = owner->parameters.at(key);
      known = parameters_.insert(parameters_.end(), std::move(parameter));
    }
    known->terms.push_back(terms_.size() - 1);
    terms_.back().parameters.push_back(static_cast<std::size_t>(known - parameters_.begin()));
  }
  for (const auto& [key, value] : term.parameters) {
    const auto& used = expression->parameters();
    if (std::find(used.begin(), used.end(), key) == used.end()) {
      return bad_term(term, fmt::format("declares the parameter {}, which its expression does not "
                                        "use",
                                        key));
    }
  }
  terms_.back().what = std::move(*expression);
  return {};
}

std::vector<std::string> Design::signals_needed() const {
  std::set<std::string> needed;
  for (const Term& term : terms_) {
    if (const auto* effect = std::get_if<const Effect*>(&term.what)) {
      for (const std::string_view name : (*effect)->info().signals) needed.emplace(name);
    } else {
      const auto& names = std::get<Expression>(term.what).signals();
      needed.insert(names.begin(), names.end());
    }
  }
  return {needed.begin(), needed.end()};
}

Eigen::MatrixXd Design::regressor(std::size_t term, const Eigen::VectorXd& inner) const {
  return regressor(term, inner, *signals_);
}

Eigen::MatrixXd Design::regressor(std::size_t term, const Eigen::VectorXd& inner,
                                  const Signals& block) const {
  std::vector<double> values;
  for (const std::size_t parameter : terms_[term].parameters) {
    values.push_back(inner[static_cast<Eigen::Index>(parameter)]);
  }
  if (const auto* effect = std::get_if<const Effect*>(&terms_[term].what)) {
    const Eigen::MatrixXd own = (*effect)->regressor(block, values);
    if (!(*effect)->info().has_history) return own;
    const Eigen::MatrixXd starts = (*effect)->starts(block, values);
    Eigen::MatrixXd both(own.rows(), own.cols() + starts.cols());
    both << own, starts;
    return both;
  }
  return std::get<Expression>(terms_[term].what).evaluate(block, values);
}

bool Design::has_history(std::size_t term) const {
  const auto* effect = std::get_if<const Effect*>(&terms_[term].what);
  return effect != nullptr && (*effect)->info().has_history;
}

std::vector<Eigen::Index> Design::free_columns() const {
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (!columns_[i].held) free.push_back(static_cast<Eigen::Index>(i));
  }
  return free;
}

std::vector<Eigen::Index> Design::places() const {
  std::vector<Eigen::Index> place(columns_.size(), -1);
  Eigen::Index next = 0;
  for (const Eigen::Index column : free_columns()) place[static_cast<std::size_t>(column)] = next++;
  return place;
}

std::vector<Tangent> Design::tangents() const {
  const std::vector<Eigen::Index> place = places();
  std::vector<Tangent> tangents;
  for (const Term& term : terms_) {
    for (const std::size_t parameter : term.parameters) {
      for (const std::size_t column : term.columns) {
        const double held = columns_[column].held ? *columns_[column].given : 0.0;
        tangents.push_back({static_cast<Eigen::Index>(parameter), place[column], held});
      }
    }
  }
  return tangents;
}

Design::Evaluated Design::evaluate(std::size_t term, const Eigen::VectorXd& inner,
                                   bool with_tangents, const Signals& block) const {
  Evaluated result{regressor(term, inner, block), {}};
  if (!with_tangents) return result;
  for (const std::size_t parameter : terms_[term].parameters) {
    const auto at = static_cast<Eigen::Index>(parameter);
    const auto difference = [&](double h) -> Eigen::MatrixXd {
      Eigen::VectorXd up = inner, down = inner;
      up[at] += h;
      down[at] -= h;
      return (regressor(term, up, block) - regressor(term, down, block)) / (up[at] - down[at]);
    };
    const double step = derivative_step(inner[at]);
    // Richardson's combination of two central differences: the error is of fourth order.
    result.derivative.emplace_back((4.0 * difference(step / 2.0) - difference(step)) / 3.0);
  }
  return result;
}

void Design::visit(const Eigen::VectorXd& inner, bool with_tangents, const Signals::View& observed,
                   const Visit& visit) const {
  std::vector<std::optional<Evaluated>> whole(terms_.size());
  for (std::size_t term = 0; term < terms_.size(); ++term) {
    if (has_history(term)) whole[term] = evaluate(term, inner, with_tangents, *signals_);
  }
  const std::vector<Eigen::Index> place = places();
  const auto free = static_cast<Eigen::Index>(free_columns().size());
  const auto width = free + (with_tangents ? static_cast<Eigen::Index>(tangents().size()) : 0) + 1;
  for (std::size_t begin = 0; begin < signals_->rows(); begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, signals_->rows());
    const Signals block = signals_->block(begin, end);
    const auto first = static_cast<Eigen::Index>(begin);
    const auto count = static_cast<Eigen::Index>(end - begin);
    Eigen::MatrixXd rows(count, width);
    rows.col(width - 1) = observed.segment(first, count);
    Eigen::Index next_tangent = free;
    for (std::size_t term = 0; term < terms_.size(); ++term) {
      std::optional<Evaluated> local;
      if (!whole[term]) local = evaluate(term, inner, with_tangents, block);
      const Evaluated& values = whole[term] ? *whole[term] : *local;
      const Eigen::Index from = whole[term] ? first : 0;
      for (const std::size_t at : terms_[term].columns) {
        const DesignColumn& column = columns_[at];
        const auto value = values.value.col(column.column).segment(from, count);
        if (column.held) {
          rows.col(width - 1) -= *column.given * value;
        } else {
          rows.col(place[at]) = value;
        }
      }
      for (const Eigen::MatrixXd& derivative : values.derivative) {
        for (Eigen::Index c = 0; c < derivative.cols(); ++c) {
          rows.col(next_tangent++) = derivative.col(c).segment(from, count);
        }
      }
    }
    visit(begin, rows);
  }
}

Eigen::VectorXd Design::predict(const Eigen::VectorXd& coefficients,
                                const Eigen::VectorXd& inner) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(signals_->rows()));
  for (std::size_t term = 0; term < terms_.size(); ++term) {
    const Eigen::MatrixXd values = regressor(term, inner);
    for (const std::size_t at : terms_[term].columns) {
      sum += coefficients[static_cast<Eigen::Index>(at)] * values.col(columns_[at].column);
    }
  }
  return sum;
}

}  // namespace fogbench::model
