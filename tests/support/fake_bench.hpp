#pragma once
// A bench of fakes behind the capability interfaces, for tests of whatever commands instruments.
// Time is a VirtualClock's; the plant is as simple as it can be: the temperature goes to its target
// at a constant rate, each pair of coils makes a field along its axis, the gyro's rate is a
// function of the frame's index. Any call can be made to fail.

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "config/bench.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"

namespace fogbench::test {

using namespace config;  // NOLINT(google-build-using-namespace): a test's vocabulary
using drivers::Clock;

/// The truth, and the tests' hold on it.
struct FakePlant {
  drivers::VirtualClock clock;

  // Thermostat.
  HeatingMode mode = HeatingMode::kOff;
  double target_c = 21.0, ambient_c = 21.0, carrier_c = 21.0;
  double speed_c_per_s = 0.5;
  double control_offset_c = 0.0;
  bool heaters_stuck = false;  ///< draw power whatever the mode
  // Coils: horizontal (up), vertical (north).
  std::array<double, 2> current_a{}, ut_per_a{89.9, 89.9};
  std::array<bool, 2> output_on{};
  std::array<double, 3> ambient_ut{-48.0, 16.0, 1.0};  ///< up, north, east
  double azimuth_deg = 0.0;
  bool turntable_stuck = false;
  bool operator_agrees = true;
  // Gyro.
  double frame_rate_hz = 100.0;
  double frame_rate_error = 1.0;  ///< frames that are measured for one that is stated
  std::function<double(std::int64_t)> rate = [](std::int64_t) { return 0.0; };
  std::function<bool(std::int64_t)> lost = [](std::int64_t) { return false; };

  // Calls, in order: "thermostat.read", "coil_vertical.set_current", ...
  std::vector<std::string> commands;  ///< only those that change the bench
  int calls = 0;
  /// Asked before every call with its number (from 1) and name: true makes it fail.
  std::function<bool(int, const std::string&)> fails = [](int, const std::string&) {
    return false;
  };

  /// Asked before every call with its name: true makes it fail as one to an unplugged instrument,
  /// or to one that another process has (kHeld).
  std::function<bool(const std::string&)> gone = [](const std::string&) { return false; };
  ErrorCode gone_as = ErrorCode::kUnplugged;

  Status call(const std::string& name, bool changes = false) {
    follow();
    if (gone(name)) return Error{gone_as, name + ": unplugged"};
    if (changes) commands.push_back(name);
    if (fails(++calls, name)) return Error{ErrorCode::kTimeout, name + " did not answer"};
    return {};
  }
  void follow() {
    const double passed_s = drivers::to_seconds(clock.now() - followed_);
    followed_ = clock.now();
    const double goal = mode == HeatingMode::kOff ? ambient_c : target_c;
    const double way = goal - carrier_c;
    carrier_c += std::copysign(std::min(std::abs(way), speed_c_per_s * passed_s), way);
  }
  double heater_w() const { return mode == HeatingMode::kOff && !heaters_stuck ? 0.0 : 5.0; }
  bool safe() const { return heater_w() == 0.0 && current_a[0] == 0.0 && current_a[1] == 0.0; }

 private:
  Clock::Instant followed_{};
};

class FakeThermostat final : public drivers::Thermostat {
 public:
  explicit FakeThermostat(FakePlant& plant) : plant_(plant) {}
  Result<std::string> identity() override {
    if (auto s = plant_.call("thermostat.identity"); !s) return s.error();
    return std::string("fake thermostat");
  }
  Status set_target(Celsius target) override {
    if (auto s = plant_.call("thermostat.set_target", true); !s) return s;
    plant_.target_c = target.value;
    return {};
  }
  Status set_mode(HeatingMode mode) override {
    if (auto s = plant_.call("thermostat.set_mode", true); !s) return s;
    plant_.mode = mode;
    return {};
  }
  Result<drivers::ThermostatReading> read() override {
    if (auto s = plant_.call("thermostat.read"); !s) return s.error();
    drivers::ThermostatReading r;
    r.taken_at = plant_.clock.now();
    r.working_1 = Celsius{plant_.carrier_c + 0.05};
    r.working_2 = Celsius{plant_.carrier_c - 0.05};
    r.control = Celsius{plant_.carrier_c + plant_.control_offset_c};
    r.ambient = Celsius{plant_.ambient_c};
    r.target = Celsius{plant_.target_c};
    r.mode = plant_.mode;
    r.normal_power = Watt{plant_.heater_w()};
    return r;
  }
  Status switch_off() override {
    if (auto s = plant_.call("thermostat.switch_off", true); !s) return s;
    plant_.mode = HeatingMode::kOff;
    return {};
  }
  Status confirm_off() override {
    if (auto s = plant_.call("thermostat.confirm_off"); !s) return s;
    if (plant_.heater_w() == 0.0) return {};
    return Error{ErrorCode::kDevice, "thermostat: the heaters still draw 5.0 W"};
  }

 private:
  FakePlant& plant_;
};

class FakeCoil final : public drivers::CoilSupply {
 public:
  FakeCoil(FakePlant& plant, std::size_t pair)
      : plant_(plant), pair_(pair), name_(pair == 0 ? "coil_horizontal" : "coil_vertical") {}
  Result<std::string> identity() override {
    if (auto s = plant_.call(name_ + ".identity"); !s) return s.error();
    return std::string("fake supply");
  }
  Status enable() override {
    if (auto s = plant_.call(name_ + ".enable", true); !s) return s;
    plant_.current_a[pair_] = 0.0;
    plant_.output_on[pair_] = true;
    return {};
  }
  Status set_current(Ampere current) override {
    if (auto s = plant_.call(name_ + ".set_current", true); !s) return s;
    if (!plant_.output_on[pair_]) return Error{ErrorCode::kDevice, name_ + " output is off"};
    plant_.current_a[pair_] = current.value;
    return {};
  }
  Result<drivers::CoilReading> read() override {
    if (auto s = plant_.call(name_ + ".read"); !s) return s.error();
    const Ampere current{plant_.current_a[pair_]};
    return drivers::CoilReading{plant_.clock.now(), current, current};
  }
  Status switch_off() override {
    if (auto s = plant_.call(name_ + ".switch_off", true); !s) return s;
    plant_.current_a[pair_] = 0.0;
    plant_.output_on[pair_] = false;
    return {};
  }
  Status confirm_off() override {
    if (auto s = plant_.call(name_ + ".confirm_off"); !s) return s;
    if (plant_.current_a[pair_] == 0.0) return {};
    return Error{ErrorCode::kDevice, name_ + " still carries current"};
  }

 private:
  FakePlant& plant_;
  std::size_t pair_;
  std::string name_;
};

class FakeMagnetometer final : public drivers::Magnetometer {
 public:
  explicit FakeMagnetometer(FakePlant& plant) : plant_(plant) {}
  Result<std::string> identity() override {
    if (auto s = plant_.call("magnetometer.identity"); !s) return s.error();
    return std::string("fake magnetometer");
  }
  Result<drivers::FieldReading> read() override {
    if (auto s = plant_.call("magnetometer.read"); !s) return s.error();
    const auto& p = plant_;
    // The pairs are not quite orthogonal, and their constants not quite nominal.
    const double up = p.ambient_ut[0] + p.ut_per_a[0] * p.current_a[0];
    const double north = p.ambient_ut[1] + p.ut_per_a[1] * p.current_a[1] + 0.5 * p.current_a[0];
    const double a = p.azimuth_deg * std::numbers::pi / 180.0;
    return drivers::FieldReading{
        p.clock.now(),
        {Microtesla{up}, Microtesla{north * std::cos(a) + p.ambient_ut[2] * std::sin(a)},
         Microtesla{north * std::sin(a) - p.ambient_ut[2] * std::cos(a)}}};
  }

 private:
  FakePlant& plant_;
};

class FakeTurntable final : public drivers::Turntable {
 public:
  explicit FakeTurntable(FakePlant& plant) : plant_(plant) {}
  Result<std::string> identity() override {
    if (auto s = plant_.call("turntable.identity"); !s) return s.error();
    return std::string("fake turntable");
  }
  Status rotate_to(Degree azimuth) override {
    if (auto s = plant_.call("turntable.rotate_to", true); !s) return s;
    plant_.clock.sleep_for(std::chrono::seconds{20});
    if (!plant_.turntable_stuck) plant_.azimuth_deg = azimuth.value;
    return {};
  }
  Result<Degree> azimuth() override {
    if (auto s = plant_.call("turntable.azimuth"); !s) return s.error();
    return Degree{plant_.azimuth_deg};
  }

 private:
  FakePlant& plant_;
};

class FakeGyro final : public drivers::Gyro {
 public:
  explicit FakeGyro(FakePlant& plant) : plant_(plant) {}
  Result<std::string> identity() override {
    if (auto s = plant_.call("gyro.identity"); !s) return s.error();
    return std::string("fake gyro");
  }
  Status read(drivers::GyroBlock& out) override {
    if (auto s = plant_.call("gyro.read"); !s) return s;
    // Frame i is measured from i to i + 1 periods, and has come at the end of it.
    const auto due = static_cast<std::int64_t>(std::floor(
        drivers::to_seconds(plant_.clock.now().time_since_epoch()) * plant_.frame_rate_hz + 1e-6));
    for (; next_ < due; ++next_) {
      if (plant_.lost(next_)) {
        ++statistics_.frames_missing;
        continue;
      }
      out.index.push_back(next_);
      out.rate_deg_per_h.push_back(static_cast<float>(plant_.rate(next_)));
      ++statistics_.frames_good;
    }
    return {};
  }
  const drivers::StreamStatistics& statistics() const override { return statistics_; }
  Clock::Instant time_of(std::int64_t index) const override {
    return Clock::Instant{
        drivers::from_seconds((static_cast<double>(index) + 0.5) / plant_.frame_rate_hz)};
  }
  double frame_rate_hz() const override { return plant_.frame_rate_hz; }
  std::optional<drivers::FrameRate> measured_frame_rate() const override {
    return drivers::FrameRate{plant_.frame_rate_hz * plant_.frame_rate_error,
                              plant_.frame_rate_error == 1.0};
  }

 private:
  FakePlant& plant_;
  std::int64_t next_ = 0;
  drivers::StreamStatistics statistics_;
};

class FakeOperator final : public drivers::Operator {
 public:
  explicit FakeOperator(FakePlant& plant) : plant_(plant) {}
  Result<bool> confirm(const std::string& /*prompt*/) override {
    if (auto s = plant_.call("operator.confirm"); !s) return s.error();
    plant_.clock.sleep_for(std::chrono::seconds{30});
    return plant_.operator_agrees;
  }

 private:
  FakePlant& plant_;
};

/// The plant must outlive the bench.
inline drivers::Bench fake_bench(FakePlant& plant) {
  return {std::make_unique<FakeThermostat>(plant), std::make_unique<FakeCoil>(plant, 0),
          std::make_unique<FakeCoil>(plant, 1),    std::make_unique<FakeMagnetometer>(plant),
          std::make_unique<FakeTurntable>(plant),  std::make_unique<FakeGyro>(plant)};
}

}  // namespace fogbench::test
