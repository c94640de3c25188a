#pragma once
// Keeps watch over the bench while a step waits: drains the gyro's stream, reads the slow
// instruments once a second, and hands everything to the recorder.
//
// A read that fails is harmless: it is warned of once, the value is missing, and the next second
// tries again. An instrument that stays silent for longer than kLongestOutage ends the run, one
// that is unplugged after the bench's absence_maximum. While the coils carry current nobody may
// leave unnoticed: an instrument that is unplugged then interrupts the step at once. A reading that
// repeats an old time stamp is stale and counts as failed: it never enters an average. An auxiliary
// sensor that says nothing is missing, and nothing else comes of it.
//
// The record's times are the gyro's counter over its stated frame rate. Until that rate is
// measured, a few seconds, frames are taken as they come. One that is not as stated ends the run; a
// rate that was right and changes later is warned of, since what was measured before stands.

#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "config/bench.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"
#include "procedures/interlock_gauge.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::procedures {

class BenchWatch {
 public:
  using Instant = drivers::Clock::Instant;
  static constexpr drivers::Clock::Duration kPeriod = std::chrono::seconds{1};
  /// Longer than an instrument's restart, shorter than anything thermal.
  static constexpr config::Seconds kLongestOutage{30.0};
  /// How long the slow readings are kept: a window looks back to just before its start.
  static constexpr double kRecentS = 60.0;

  /// A machine's clock that is set by more than this is on record. A leap second is not, and a time
  /// server that slews the clock slews the steady one with it.
  static constexpr drivers::Clock::Duration kCalendarStep = std::chrono::seconds{1};

  /// How long an auxiliary sensor that did not answer is left alone: what it takes to wait for it
  /// must not keep anybody from looking after the bench.
  static constexpr drivers::Clock::Duration kAuxiliaryPause = std::chrono::seconds{10};

  /// How often a sleep looks whether it is to be cut short: what an abort waits for, beyond the
  /// instrument that is being spoken to.
  static constexpr drivers::Clock::Duration kNap = std::chrono::milliseconds{5};

  /// All must outlive the watch. `interrupted` cuts a tick short: it comes back at once, without
  /// the readings that it has not begun.
  BenchWatch(const config::BenchConfig& config, drivers::Bench& bench, drivers::Clock& clock,
             Recorder& recorder, std::function<bool()> interrupted)
      : config_(config),
        bench_(bench),
        clock_(clock),
        recorder_(recorder),
        interrupted_(std::move(interrupted)),
        stream_before_(bench.gyro->statistics()) {}

  /// Waits for the stream's first frame, which is the zero of time: the gyro's power-on as far as
  /// the bench can tell. kTimeout when none comes.
  Status start();

  /// Sleeps until `deadline` or the next second, whichever is first, then drains the stream, and on
  /// the second reads the slow instruments. Errors: kStore from the recorder, the instrument's
  /// for an outage; kUnplugged at once while the field is guarded.
  Status tick(Instant deadline);
  /// What the last tick brought.
  const drivers::GyroBlock& frames() const { return frames_; }
  /// Null when the last tick read no slow instruments.
  const MonitorRow* new_row() const { return has_new_row_ ? &row_ : nullptr; }
  /// The new row and what else the interlocks look at.
  Observation observed(const Commanded& commanded) const;
  /// Of the last kRecentS seconds, the last tick's included.
  const std::deque<MonitorRow>& recent_rows() const { return recent_; }

  /// What happened on the gyro's line since start(): what was lost before, while nobody measured,
  /// is no loss of this run.
  drivers::StreamStatistics stream() const { return bench_.gyro->statistics() - stream_before_; }
  /// The first frame that has not come yet.
  std::int64_t next_frame() const { return next_frame_; }
  Instant power_on() const { return power_on_; }
  Instant now() const { return clock_.now(); }
  double time_s(Instant instant) const { return drivers::to_seconds(instant - power_on_); }
  double now_s() const { return time_s(now()); }

  /// Whether the coils' outputs are on: an instrument that is unplugged then interrupts.
  void guard_field(bool on) { field_guarded_ = on; }
  /// While the record cannot be written nothing is handed to it: what is read then is lost to it.
  void keep_from_record(bool kept) { kept_from_record_ = kept; }
  /// False while an instrument's readings are missing.
  bool all_answer() const;

  /// Auxiliary channels without which a point is void; they must outlive the watch.
  void need(std::span<const std::string> channels) { needed_ = channels; }
  std::span<const std::string> needed() const { return needed_; }

  void set_azimuth(config::Degree azimuth) { azimuth_ = azimuth; }
  Status event(const std::string& severity, const std::string& message,
               const std::string& data_json = {});

 private:
  struct Outage {
    const char* instrument;
    std::optional<Instant> since;
    Instant last_taken{Instant::min()};
  };
  /// Takes what comes meanwhile, while the frame rate is still to be measured.
  Status sleep_until(Instant deadline);
  /// Appends what the stream has brought.
  Status drain();
  Status record_frames();
  Status check_frame_rate();
  Status read_slow_instruments();
  /// What one does not say is missing, said once, and stops nothing.
  Status read_auxiliary();
  /// Keeps count of the outage; an error when it has lasted too long or cannot be recorded.
  Status note(Outage& outage, const Status& outcome);
  static Status check_new(Outage& outage, Instant taken_at);
  Status note_calendar();

  const config::BenchConfig& config_;
  drivers::Bench& bench_;
  drivers::Clock& clock_;
  Recorder& recorder_;
  std::function<bool()> interrupted_;
  drivers::StreamStatistics stream_before_;
  drivers::GyroBlock frames_;
  MonitorRow row_;
  std::deque<MonitorRow> recent_;
  bool has_new_row_ = false;
  std::int64_t next_frame_ = 0;
  /// Whether the frame rate was as stated when it was last measured; nothing before the first time.
  std::optional<bool> rate_as_stated_;
  Instant power_on_{};
  Instant next_reading_{};
  drivers::Clock::Duration calendar_noted_{};  ///< the clock's offset that is on record
  config::Degree azimuth_{0.0};
  std::span<const std::string> needed_;
  bool field_guarded_ = false;
  bool kept_from_record_ = false;
  struct AuxiliaryOutage {
    std::string says;  ///< empty: there is none
    Instant since{}, ask_again{};
  };
  std::vector<AuxiliaryOutage> auxiliary_outages_;
  Outage gyro_{"gyro", {}}, thermostat_{"thermostat", {}}, magnetometer_{"magnetometer", {}},
      coil_horizontal_{"coil_horizontal", {}}, coil_vertical_{"coil_vertical", {}};
};

}  // namespace fogbench::procedures
