#pragma once
// The same physics in other shapes. A real loop relaxes where the play operator has corners, a real
// saturation is no hyperbolic tangent, and a temperature rate may be averaged differently from how
// the physics acts: these shapes count as the effect itself, lest their difference from the
// catalogue's formula be taken for a second effect, or for none of the catalogue.

#include <vector>

#include "model/effects/effect.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {

/// The catalogue's own shape first, each with the columns of how its memory began after its own.
/// Both arguments must outlive the shapes.
std::vector<Shape> shapes_of(const Effect& effect, const Signals& signals);
/// Those of a form of an effect (EffectInfo::form_of), its further inner parameters near `further`.
std::vector<Shape> shapes_of_form(const Effect& form, const Signals& signals,
                                  const std::vector<double>& further);

}  // namespace fogbench::model
