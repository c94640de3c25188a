#include "model/effects/expression.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <numbers>
#include <string_view>

#include "config/nearest_name.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kShown = 200;

void define_constants(mu::Parser& parser) {
  parser.DefineConst("pi", std::numbers::pi);
  parser.DefineConst("e", std::numbers::e);
}

/// Whether a single '=' stands anywhere: the parser would take it for an assignment and write into
/// the table's columns.
bool assigns(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    const bool follows = i > 0 && std::string_view("=<>!").find(text[i - 1]) != text.npos;
    const bool leads = i + 1 < text.size() && text[i + 1] == '=';
    if (!follows && !leads) return true;
  }
  return false;
}

/// A name with "(" behind it that is no function: the parser would call it a variable, or only the
/// bracket unexpected. Empty when there is none.
std::string unknown_function(std::string_view text) {
  const std::vector<std::string>& known = expression_functions();
  const auto of_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
  };
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    while (end < text.size() && of_name(text[end])) ++end;
    const std::string_view name = text.substr(at, end - at);
    at = std::max(end, at + 1);
    while (end < text.size() && text[end] == ' ') ++end;
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) || end == text.size() ||
        text[end] != '(' || std::find(known.begin(), known.end(), name) != known.end()) {
      continue;
    }
    return fmt::format("unknown function {}{}; the functions are {}", name,
                       config::did_you_mean(name, {known.begin(), known.end()}),
                       fmt::join(known, ", "));
  }
  return "";
}

/// For GetUsedVar, which wants an address for every name.
double* any_variable(const char*, void* place) {
  return static_cast<double*>(place);
}

}  // namespace

const std::vector<std::string>& expression_functions() {
  static const std::vector<std::string> kNames = [] {
    const mu::Parser parser;
    std::vector<std::string> names;
    for (const auto& [name, function] : parser.GetFunDef()) names.push_back(name);
    return names;
  }();
  return kNames;
}

Result<Expression> Expression::parse(const std::string& term, const std::string& text,
                                     const std::set<std::string>& parameters,
                                     const Signals& signals) {
  const auto bad = [&](const std::string& what) {
    return Error{ErrorCode::kBadInput, fmt::format("term {}: {}", term, what)};
  };
  // A text of thousands of characters would drown what is said about it.
  const std::string shown = text.size() > kShown ? text.substr(0, kShown) + "..." : text;
  if (assigns(text)) {
    return bad(fmt::format("found an assignment in '{}', expected a formula; equal is ==", shown));
  }
  if (const std::string unknown = unknown_function(text); !unknown.empty()) {
    return bad(fmt::format("{} ('{}')", unknown, shown));
  }
  Expression expression;
  expression.text_ = text;
  std::set<std::string> used;
  try {
    double place = 1.0;
    mu::Parser parser;
    define_constants(parser);
    // A parameter may be called e or pi: then it is the parameter.
    for (const std::string& name : parameters) parser.DefineVar(name, &place);
    parser.SetVarFactory(any_variable, &place);
    parser.SetExpr(text);
    for (const auto& [name, address] : parser.GetUsedVar()) used.insert(name);
    parser.Eval();
    if (parser.GetNumResults() != 1) {
      return bad(
          fmt::format("found {} values in '{}', expected one", parser.GetNumResults(), shown));
    }
  } catch (const mu::ParserError& error) {
    return bad(fmt::format("found '{}', expected a formula: {}", shown, error.GetMsg()));
  }
  for (const std::string& name : used) {
    const bool is_signal = signals.table().has(name) || signals.available(name);
    if (parameters.contains(name)) {
      if (is_signal) {
        return bad(
            fmt::format("found the parameter {} that is also a column, expected two names", name));
      }
      expression.parameters_.push_back(name);
    } else if (is_signal) {
      expression.signals_.push_back(name);
    } else {
      const std::vector<std::string> columns = signals.table().column_names();
      std::vector<std::string_view> known(columns.begin(), columns.end());
      known.insert(known.end(), parameters.begin(), parameters.end());
      return bad(fmt::format(
          "found the name '{}' in '{}', expected a column or one of the term's "
          "parameters ({}){}",
          name, shown, signals.table().why_missing(name), config::did_you_mean(name, known)));
    }
  }
  expression.parser_ = std::make_shared<mu::Parser>();
  define_constants(*expression.parser_);
  return expression;
}

Eigen::VectorXd Expression::evaluate(const Signals& signals, std::span<const double> values) const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(signals.rows()));
  mu::Parser& parser = *parser_;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    parser.DefineConst(parameters_[i], values[i]);
  }
  // Row by row: the parser's bulk mode keeps all processors waiting for each other, for each of
  // thousands of small tables.
  std::vector<double> row(signals_.size());
  std::vector<const double*> columns;
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    columns.push_back(signals.signal(signals_[i]).data());
    parser.DefineVar(signals_[i], &row[i]);
  }
  try {
    parser.SetExpr(text_);
    for (Eigen::Index r = 0; r < result.size(); ++r) {
      for (std::size_t i = 0; i < row.size(); ++i) row[i] = columns[i][r];
      result[r] = parser.Eval();
    }
  } catch (const mu::ParserError&) {  // parse() has tried it: not seen yet
    result.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return result;
}

}  // namespace fogbench::model
