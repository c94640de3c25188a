#pragma once
// A device file states its numbers in the units of its instrument; everything behind the reader
// reckons in the house's (stated_unit.hpp). Scales, offsets and limits are taken over once, here,
// so that driver and simulated instrument, which share the description, speak the instrument's unit
// on the wire and the house's to everybody else.

#include "config/device.hpp"
#include "config/place.hpp"

namespace fogbench::config {

/// Where a unit is not stated it is the house's already. An unknown unit, one of another kind of
/// number, and one of a count are errors at their key.
bool take_to_house_units(const Place& at, ModbusDevice& device);
bool take_to_house_units(const Place& at, ScpiDevice& device);
bool take_to_house_units(const Place& at, HidDevice& device);
bool take_to_house_units(const Place& at, FrameDevice& device);

}  // namespace fogbench::config
