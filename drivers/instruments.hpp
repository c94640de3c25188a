#pragma once
// What a bench can do, whatever the make of its instruments. Implementations are in drivers/ and
// speak through the transports; nothing here may be called from two threads at once, and only the
// run engine commands.
//
// Errors of every call: kTimeout, kDevice, kBusy, kProtocol, kStale, kLimit for a request outside
// the instrument's stated limits, which is refused before it reaches the wire.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/procedure.hpp"
#include "config/result.hpp"
#include "config/sensor.hpp"
#include "config/units.hpp"
#include "drivers/clock.hpp"

namespace fogbench::drivers {

using config::Ampere;
using config::Celsius;
using config::DegPerHour;
using config::Degree;
using config::HeatingMode;
using config::Microtesla;
using config::Watt;

/// Instruments cannot be copied: there is one of each on the bench.
class Instrument {
 public:
  Instrument() = default;
  Instrument(const Instrument&) = delete;
  Instrument& operator=(const Instrument&) = delete;
  virtual ~Instrument() = default;
  /// Reaches it, checks who it is and readies it. May be repeated until it succeeds: an instrument
  /// may be plugged in later.
  virtual Status begin() { return {}; }
  /// What it says it is, for the record ("KEPCO,BOP ...", or the map's name where it cannot say).
  virtual Result<std::string> identity() = 0;
};

/// What was attached to its transport, begun.
template <class Driver>
Result<std::unique_ptr<Driver>> begun(Result<std::unique_ptr<Driver>> attached) {
  if (!attached) return attached;
  if (const Status ready = (*attached)->begin(); !ready) return ready.error();
  return attached;
}

/// An instrument that can do harm, and how that is ended: whoever is at the other end, healthy or
/// not, begun or not. Neither call asks for an identity or a valid sensor.
class Actuator : public Instrument {
 public:
  /// Sends what switches it off, and waits for no more than the wire itself asks for. kUnplugged
  /// when it cannot be reached; after any other error it may have been obeyed.
  virtual Status switch_off() = 0;
  /// Whether it is off, by what it reads back.
  virtual Status confirm_off() = 0;
};

struct ThermostatReading {
  Clock::Instant taken_at{};
  Celsius working_1, working_2;  ///< the two working sensors on the coil carrier
  Celsius control;               ///< the third sensor: checks the other two
  Celsius ambient;
  Celsius target;
  HeatingMode mode = HeatingMode::kOff;
  Watt boost_power, normal_power;
};

class Thermostat : public Actuator {
 public:
  /// Both are read back; a difference is kDevice.
  virtual Status set_target(Celsius target) = 0;
  virtual Status set_mode(HeatingMode mode) = 0;
  virtual Result<ThermostatReading> read() = 0;
};

struct CoilReading {
  Clock::Instant taken_at{};
  Ampere set;
  Ampere measured;
};

/// One pair of coils' bipolar current source. Switched off: 0 A, then the output off.
class CoilSupply : public Actuator {
 public:
  /// Programs 0 A, then switches the output on.
  virtual Status enable() = 0;
  /// Waits for the output to settle and reads it back; kDevice when it does not follow.
  virtual Status set_current(Ampere current) = 0;
  virtual Result<CoilReading> read() = 0;
  /// For a process that ends now: 0 A once more, past whatever is under way and without waiting.
  /// Any thread may call it, once; nobody can say whether it arrives.
  virtual void send_last_zero() noexcept {}
};

struct FieldReading {
  Clock::Instant taken_at{};
  std::array<Microtesla, 3> field;  ///< calibrated, gyro axes x, y, z
};

class Magnetometer : public Instrument {
 public:
  virtual Result<FieldReading> read() = 0;
};

class Turntable : public Instrument {
 public:
  /// Returns when the gyro stands at the azimuth.
  virtual Status rotate_to(Degree azimuth) = 0;
  virtual Result<Degree> azimuth() = 0;
};

/// Whoever turns the gyro by hand or confirms a step. Returns false when they decline.
class Operator {
 public:
  virtual ~Operator() = default;
  virtual Result<bool> confirm(const std::string& prompt) = 0;
  /// Whether they can resume a run that has paused by itself.
  virtual bool can_resume() const { return false; }
  /// Who answers, for the record; empty: whoever it was puts it there.
  virtual std::string name() const { return {}; }
};

/// Good frames of the stream, one entry each in every vector. `index` counts frames since the
/// stream's start, lost ones too (unwrapped sequence number): a jump in it is a gap.
struct GyroBlock {
  std::vector<std::int64_t> index;
  std::vector<float> rate_deg_per_h;  ///< as the instrument says, no reference rate subtracted
  std::vector<float> temperature_c;   ///< empty when frames carry none
  void clear() {
    index.clear();
    rate_deg_per_h.clear();
    temperature_c.clear();
  }
};

/// What happened on the line since the stream was opened.
struct StreamStatistics {
  std::uint64_t frames_good = 0;
  std::uint64_t frames_bad_checksum = 0;
  std::uint64_t frames_invalid = 0;  ///< status said so, or the rate stood still
  std::uint64_t frames_repeated = 0;
  std::uint64_t frames_missing = 0;  ///< by sequence number (bad and invalid ones included)
  std::uint64_t bytes_skipped = 0;   ///< thrown away while looking for a header

  StreamStatistics operator+(const StreamStatistics& more) const {
    return {frames_good + more.frames_good,       frames_bad_checksum + more.frames_bad_checksum,
            frames_invalid + more.frames_invalid, frames_repeated + more.frames_repeated,
            frames_missing + more.frames_missing, bytes_skipped + more.bytes_skipped};
  }
  /// What has come on top of `before`, an earlier state of the same line.
  StreamStatistics operator-(const StreamStatistics& before) const {
    return {
        frames_good - before.frames_good,       frames_bad_checksum - before.frames_bad_checksum,
        frames_invalid - before.frames_invalid, frames_repeated - before.frames_repeated,
        frames_missing - before.frames_missing, bytes_skipped - before.bytes_skipped};
  }
};

/// Frames a second as they come, lost ones counted, by the clock.
struct FrameRate {
  double measured_hz = 0.0;
  bool as_stated = true;  ///< by the instrument's description
};

class Gyro : public Instrument {
 public:
  /// As begin(), for another gyro on the line, or the same one switched on again, at that moment:
  /// from there its frames are counted, and their times.
  virtual Status begin_anew(Clock::Instant /*switched_on*/) { return begin(); }
  /// Appends every good frame that has arrived by now to `out` (nothing new: appends nothing).
  /// kTimeout when the stream has been silent for longer than it may.
  virtual Status read(GyroBlock& out) = 0;
  virtual const StreamStatistics& statistics() const = 0;
  /// When frame `index` was measured (middle of its sample), from the counter, not from arrival.
  virtual Clock::Instant time_of(std::int64_t index) const = 0;
  /// As the description states it.
  virtual double frame_rate_hz() const = 0;
  /// Of the last few seconds in which frames were read; nothing before there were so many.
  virtual std::optional<FrameRate> measured_frame_rate() const = 0;
};

/// A sensor beside the measurement: it commands nothing, and nothing depends on it.
class AuxiliarySensor : public Instrument {
 public:
  /// A reading of each channel, in the order of the description. An error is that channel's, or of
  /// all of them when the sensor cannot be reached: kUnplugged, kTimeout, kDevice, kProtocol,
  /// kStale, kLimit for a value that cannot be.
  virtual std::vector<Result<double>> read() = 0;
  virtual const std::string& name() const = 0;
  virtual const std::vector<config::SensorChannel>& channels() const = 0;
};

/// The instruments of one bench.
struct Bench {
  std::unique_ptr<Thermostat> thermostat;
  std::unique_ptr<CoilSupply> coil_horizontal;
  std::unique_ptr<CoilSupply> coil_vertical;
  std::unique_ptr<Magnetometer> magnetometer;
  std::unique_ptr<Turntable> turntable;
  std::unique_ptr<Gyro> gyro;
  std::vector<std::unique_ptr<AuxiliarySensor>> auxiliary;  ///< in the order of the bench file
};

}  // namespace fogbench::drivers
