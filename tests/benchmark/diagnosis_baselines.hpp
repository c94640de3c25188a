#pragma once
// What is usually done instead of a diagnosis, on the same tables and with the catalogue's own
// regressors: regression methods that pick columns.
//
//   library: every effect that the table has the signals for and excites, inner parameters on 8
//            values (instants: 40); columns cleared of the base model and scaled to length 1
//   stepwise, independent  forward selection while BIC = n log(RSS/n) + k log n falls
//   stepwise, coloured     the same after whitening with the noise estimated under the base model
//   LASSO                  coordinate descent on 40 penalties, the one of least BIC
//   thresholding           ridge, drop small coefficients, repeat (STLSQ as in SINDy), least BIC

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "config/model_file.hpp"
#include "model/table/table.hpp"

namespace fogbench::tests {

inline constexpr std::array<std::string_view, 4> kBaselines{
    "stepwise BIC", "stepwise BIC, coloured", "LASSO", "thresholding"};

/// The effects that each of kBaselines names, in its order; empty: nothing is missing.
/// Precondition: the model's terms are effects without inner parameters, the table has no gaps.
std::array<std::vector<std::string>, kBaselines.size()> baseline_answers(
    const model::Table& table, const config::ModelFile& model);

}  // namespace fogbench::tests
