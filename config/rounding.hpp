#pragma once
// A measured value as it is printed: the uncertainty to two significant digits, the value to the
// same place (GUM 7.2.6), so that no printed digit claims more than is known.

#include <string>

namespace fogbench::config {

struct Rounded {
  std::string value;
  std::string uncertainty;
};

/// Without a usable uncertainty (zero, not finite) the value has six digits. NaN is "-".
Rounded rounded(double value, double uncertainty);

/// A number without an uncertainty, to so many significant digits: "1070" where "%.3g" has a power
/// of ten, and the same elsewhere. "-" where it is not finite.
std::string significant(double value, int digits);

}  // namespace fogbench::config
