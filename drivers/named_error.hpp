#pragma once

#include <string>
#include <string_view>

#include "config/result.hpp"

namespace fogbench::drivers {

/// The error with the name of whatever it happened to in front: "coil_horizontal: ...".
inline Error named(std::string_view name, const Error& error) {
  return {error.code, std::string(name) + ": " + error.message};
}
inline Status named(std::string_view name, const Status& status) {
  return status ? status : Status(named(name, status.error()));
}

}  // namespace fogbench::drivers
