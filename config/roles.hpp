#pragma once
// The instruments that procedures need, by role. A bench's description, its transports, its drivers
// and its far ends each have a member of each of these names.

namespace fogbench::config {

/// use("thermostat", the member `thermostat` of each of `benches`...), and so for every role.
template <class Use, class... Benches>
void for_each_role(Use&& use, Benches&&... benches) {
  use("thermostat", benches.thermostat...);
  use("coil_horizontal", benches.coil_horizontal...);
  use("coil_vertical", benches.coil_vertical...);
  use("magnetometer", benches.magnetometer...);
  use("turntable", benches.turntable...);
  use("gyro", benches.gyro...);
}

/// What describes an instrument; null for one that the bench does without (a magnetometer that is
/// not fitted, a turntable that is turned by hand).
template <class Instrument>
auto device_of(const Instrument& its) {
  if constexpr (requires { its.device.has_value(); }) {
    return its.device ? &*its.device : nullptr;
  } else if constexpr (requires { its.fitted; }) {
    return its.fitted ? &its.device : nullptr;
  } else {
    return &its.device;
  }
}

}  // namespace fogbench::config
