#pragma once
// The plots of a passport's page: deviation by temperature, and by the field along each axis.

#include <string>

#include "acceptance/acceptance.hpp"
#include "acceptance/passport_texts.hpp"

namespace fogbench::acceptance {

/// With their legend; empty where there is nothing to draw.
std::string passport_plots(const Acceptance& acceptance, Language language);

}  // namespace fogbench::acceptance
