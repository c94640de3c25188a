#pragma once
// A passport as JSON, without a language; acceptance/passport.md describes it.

#include <nlohmann/json_fwd.hpp>

#include "acceptance/passport.hpp"

namespace fogbench::acceptance {

/// The verdict alone.
nlohmann::ordered_json verdict_json(const Passport& passport);
nlohmann::ordered_json passport_json(const Passport& passport);

}  // namespace fogbench::acceptance
