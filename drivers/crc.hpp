#pragma once
// Cyclic redundancy checks of 8, 16 or 32 bits from their parameters, fast enough for a stream of
// millions of frames a second: sixteen bytes a step, one table look-up a byte ("slicing by 16",
// Kounavis and Berry, 2005).

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "config/device.hpp"

namespace fogbench::drivers {

/// Immutable after construction; may be shared between threads. Holds 16 KiB of tables: make one
/// per stream, not one per frame.
class Crc {
 public:
  /// Precondition: spec.width_bits is 8, 16 or 32.
  explicit Crc(const config::CrcSpec& spec);

  /// The check value of these bytes.
  std::uint32_t of(std::span<const std::uint8_t> bytes) const;

  // Of a whole frame, at the places that the specification gives.
  // Precondition: the frame is as long as its description says.
  bool holds(const std::uint8_t* frame) const;
  void store(std::uint8_t* frame) const;

 private:
  /// The register is kept so that the next byte meets its low eight bits, whatever the direction:
  /// a check that is not reflected lives byte-swapped in it and in the tables. So one loop serves
  /// all.
  std::uint32_t finish(std::uint32_t state) const;

  config::CrcSpec spec_;
  std::uint32_t initial_ = 0;
  std::array<std::array<std::uint32_t, 256>, 16> table_{};  ///< [bytes that follow][byte]
};

}  // namespace fogbench::drivers
