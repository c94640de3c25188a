#pragma once
// A model file's terms on a table: which columns of numbers they make, which coefficients are held
// and which inner parameters are free. What fit() and predict() share.

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/effects/effect.hpp"
#include "model/effects/expression.hpp"
#include "model/fit/reduction.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {

/// One coefficient.
struct DesignColumn {
  std::string name;  ///< "bias", "earth_rate_projection.cos"
  std::string key;   ///< in ModelTerm::coefficients; empty: ModelTerm::coefficient
  std::string unit;
  std::size_t term = 0;
  Eigen::Index column = 0;      ///< of the term's regressor
  std::optional<double> given;  ///< the model file's value
  bool held = false;
  /// Of how a memory began (Effect::starts): free in every fit, and no part of the model.
  bool start = false;
};

/// One inner parameter; expression terms may share it.
struct DesignParameter {
  std::string name;  ///< "warm_up.tau"
  std::string key;   ///< in ModelTerm::parameters
  std::string unit;
  std::optional<double> start;
  /// Catalogue effects: the search grid's ends, and the sense of the effect (times stay positive).
  std::optional<InnerParameter> range;
  std::vector<std::size_t> terms;
};

class Design {
 public:
  /// The signals must outlive the design. `hold_given`: every given coefficient is held.
  /// Errors: kBadInput: unknown effect or parameter, missing column, no terms, bad expression.
  static Result<Design> make(const Signals& signals, const config::ModelFile& model,
                             bool hold_given);

  /// The model's own first, then those of the memories' beginnings.
  const std::vector<DesignColumn>& columns() const { return columns_; }
  std::size_t own_columns() const { return own_columns_; }
  const std::vector<DesignParameter>& parameters() const { return parameters_; }
  std::size_t terms() const { return terms_.size(); }
  const std::string& term_name(std::size_t term) const { return terms_[term].name; }
  /// The signals that the terms need, each once.
  std::vector<std::string> signals_needed() const;

  /// A term's regressor on all rows, then its starts; `inner` has one value per parameter of the
  /// design.
  Eigen::MatrixXd regressor(std::size_t term, const Eigen::VectorXd& inner) const;
  /// The same on some rows only. Precondition: the term has no history.
  Eigen::MatrixXd regressor(std::size_t term, const Eigen::VectorXd& inner,
                            const Signals& block) const;
  bool has_history(std::size_t term) const;

  /// The free columns' indices into columns(), in order.
  std::vector<Eigen::Index> free_columns() const;
  /// The derivative columns, for terms with inner parameters.
  std::vector<Tangent> tangents() const;

  /// Rows of the system [X | D | y - held terms] at `inner`, block by block of signal rows
  /// [begin, begin + rows): D only when `with_tangents`.
  using Visit = std::function<void(std::size_t begin, Eigen::Ref<Eigen::MatrixXd> rows)>;
  void visit(const Eigen::VectorXd& inner, bool with_tangents, const Signals::View& observed,
             const Visit& visit) const;

  /// sum of coefficient x regressor on all rows; `coefficients` has one value per column.
  Eigen::VectorXd predict(const Eigen::VectorXd& coefficients, const Eigen::VectorXd& inner) const;

 private:
  struct Term {
    std::string name;
    std::variant<const Effect*, Expression> what;
    std::vector<std::size_t> parameters;  ///< into parameters_, in the order of the regressor
    std::vector<std::size_t> columns;     ///< into columns_
  };

  explicit Design(const Signals& signals) : signals_(&signals) {}
  Status add_effect(const config::ModelTerm& term, const Effect& effect);
  Status add_expression(const config::ModelTerm& term, const config::ModelFile& model);
  Status add_column(const config::ModelTerm& term, std::string key, std::string unit,
                    bool hold_given);
  /// A term's regressor and, per free parameter of it, the derivative, on a block of rows.
  struct Evaluated {
    Eigen::MatrixXd value;
    std::vector<Eigen::MatrixXd> derivative;
  };
  Evaluated evaluate(std::size_t term, const Eigen::VectorXd& inner, bool with_tangents,
                     const Signals& block) const;

  void add_starts();
  /// Of each column: which free one it is; -1: held.
  std::vector<Eigen::Index> places() const;

  const Signals* signals_;
  std::vector<Term> terms_;
  std::vector<DesignColumn> columns_;
  std::size_t own_columns_ = 0;
  std::vector<DesignParameter> parameters_;
};

}  // namespace fogbench::model
