#pragma once
// At which temperatures and fields a result was measured: where its limit holds.

#include <span>
#include <string>
#include <string_view>

#include "model/compare/conformity.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::acceptance {

/// Of a fitted coefficient ("magnetic_linear_x", "earth_rate_projection.cos") or "K_x": the points
/// of its test that excite it. Of an effect of the field these are the points with field along its
/// axes, else those outside sweeps.
model::Conditions conditions_of(std::string_view quantity,
                                std::span<const procedures::Point> points);

/// Of all these points, without a field.
model::Conditions conditions_at_rest(std::span<const procedures::Point> points);

/// "21 degC, OX -300..300 uT" or "31..55 degC, 0 uT", with the units given; empty: not known.
std::string conditions_text(const model::Conditions& conditions, std::string_view celsius,
                            std::string_view microtesla);

/// Whether a result of an acceptance may be called so, measured or not.
bool is_quantity(std::string_view name);

}  // namespace fogbench::acceptance
