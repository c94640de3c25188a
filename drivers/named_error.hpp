#pragma once

#include <string>
#include <string_view>

#include "config/result.hpp"

namespace fogbench::drivers {

/// "coil_horizontal: no answer"; the name is put in front unless it stands there already.
inline std::string named(std::string_view name, const std::string& message) {
  const std::string front = std::string(name) + ": ";
  return message.starts_with(front) ? message : front + message;
}
/// The error with the name of whatever it happened to in front.
inline Error named(std::string_view name, const Error& error) {
  return {error.code, named(name, error.message)};
}
inline Status named(std::string_view name, const Status& status) {
  return status ? status : Status(named(name, status.error()));
}

}  // namespace fogbench::drivers
