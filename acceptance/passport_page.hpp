#pragma once
// The page of a passport. One file, nothing from outside; prints on A4.

#include <string>

#include "acceptance/passport.hpp"

namespace fogbench::acceptance {

std::string passport_html(const Passport& passport, Language language);

}  // namespace fogbench::acceptance
