#pragma once
// Two measurements against each other, as one page.

#include <string>
#include <vector>

#include "model/compare/difference.hpp"

namespace fogbench::model {

/// `sentences`: what was found, the first one leads; `names`: of the two.
std::string difference_html(const Difference& difference, const std::vector<std::string>& sentences,
                            const std::string& name_a, const std::string& name_b,
                            const std::string& model);

}  // namespace fogbench::model
