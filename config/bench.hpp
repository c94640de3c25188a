#pragma once
// A bench as data: which instruments, where they are connected, the geometry that ties coil
// currents to the gyro's axes, and the limits that no procedure may exceed (config/benches/*.json).
// The section `simulation` holds what only the simulated bench needs: the true plant.

#include <array>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config/device.hpp"
#include "config/interlock.hpp"
#include "config/result.hpp"
#include "config/sensor.hpp"
#include "config/units.hpp"

namespace fogbench::config {

/// Where an instrument is connected: `connection` as connection.hpp describes it.
struct InstrumentConfig {
  std::string connection = "simulated";
  std::string serial_number;
  std::string calibrated_on;    ///< ISO date of the certificate
  std::string calibration_due;  ///< ISO date
};

struct ThermostatConfig : InstrumentConfig {
  ModbusDevice device;
};
struct MagnetometerConfig : InstrumentConfig {
  /// false: the field is reckoned from the coils' currents and `ambient_ut`.
  bool fitted = true;
  HidDevice device;  ///< of one that is fitted
  /// The ambient field where none is fitted, bench frame: up, north, east.
  std::array<double, 3> ambient_ut{0.0, 0.0, 0.0};
};

/// One pair of Helmholtz coils and its supply.
struct CoilConfig : InstrumentConfig {
  ScpiDevice device;
  double field_ut_per_a = 89.9;  ///< nominal, 0.7155 mu0 N/R: 50 turns at 0.5 m
  Ampere current_limit{4.0};
};

/// A turntable is motorised (SCPI over serial) or the operator's hand (a prompt).
struct TurntableConfig : InstrumentConfig {
  bool motorised = false;
  std::optional<ScpiDevice> device;  ///< present when motorised
  Seconds move_time{20.0};           ///< for the plan
};

struct GyroConfig : InstrumentConfig {
  FrameDevice device;
  /// Subtracted from every reading: the Earth's rate along the sensitive axis at this site.
  DegPerHour reference_rate{0.0};
  /// The longest run of consecutive lost frames that an average survives; a longer one is a gap.
  Seconds max_gap{0.1};
};

/// A sensor beside the measurement: recorded with every point, commanded by nobody. Without it a
/// run goes on.
struct AuxiliaryConfig : InstrumentConfig {
  std::string name;
  SensorDevice device;
};

/// What no procedure may exceed on this bench.
struct BenchLimits {
  Celsius temperature_minimum{15.0};
  Celsius temperature_maximum{60.0};
  Microtesla field_maximum{320.0};
  /// The ambient field that compensation may have to null along one axis: a sweep's current is
  /// checked with it on top. Mid-latitudes have 50 uT along the vertical.
  Microtesla compensation_maximum{55.0};
  /// How long a run waits, coils at 0 A, for an instrument that was unplugged: time to find the
  /// cable, and to plug it in again.
  Seconds absence_maximum{120.0};
  /// How long a run waits, coils at 0 A, for a run log that cannot be written: a disk that fills up
  /// in the evening is emptied in the morning, and until then nothing is lost but time.
  Seconds record_wait_maximum{43200.0};
  Seconds run_time_maximum{172800.0};
};

/// What heaters, cooler and room can do to the gyro's temperature T, to first order:
///
///   -cooling - (T - room)/time constant  <=  dT/dt  <=  heating - (T - room)/time constant
///
/// A plan asks for no more.
struct ThermalReach {
  CelsiusPerHour boost{0.0};    ///< heating with the boost heaters, at the room's temperature
  CelsiusPerHour normal{0.0};   ///< with the normal heater, which holds
  CelsiusPerHour cooling{0.0};  ///< of the cooler, at the room's temperature; 0: there is none
  Seconds time_constant{0.0};   ///< with which it comes to the room's temperature by itself
};

/// How long things take on this bench, for a plan's estimate; the run itself waits for evidence.
struct EstimateConfig {
  Celsius room{21.0};
  CelsiusPerHour heating{45.0};
  CelsiusPerHour cooling{10.0};
  Seconds settling{1400.0};    ///< from arriving near a temperature to the start of the dwell
  Seconds compensation{15.0};  ///< nulling the ambient field
  Seconds operator_answer{60.0};
};

/// True plant of the simulated bench. All typical values are from the literature (heat capacities,
/// coil geometry, sensor errors), none is the factory's.
struct ThermalPlant {
  double heater_j_per_k = 30.0;
  double carrier_j_per_k = 600.0;
  double coil_j_per_k = 200.0;
  double heater_carrier_w_per_k = 2.0;
  double carrier_coil_w_per_k = 1.5;
  double carrier_ambient_w_per_k = 0.22;  ///< at most 0.265: 9 W must hold +34 degC
  Watt boost_maximum{12.0};
  Watt normal_maximum{9.0};
  Watt cooling_maximum{0.0};    ///< of a chamber's cooler, which the controller drives too
  Celsius boost_drop_out{2.0};  ///< boost heaters switch off this far below the target
  Seconds dead_time{10.0};
  double pid_gain_w_per_k = 10.0;
  Seconds pid_integral{400.0};
  Seconds pid_derivative{20.0};
  Celsius sensor_noise{0.002};
  Celsius sensor_resolution{0.001};
  std::array<double, 3> sensor_offset_c{0.0, 0.0, 0.0};  ///< working 1, working 2, control
  Seconds sensor_lag{10.0};
  Celsius ambient{21.0};
  Celsius ambient_wander{0.3};  ///< amplitude of the room's slow change
  Seconds ambient_period{7200.0};
  double gradient_c_per_w = 0.05;  ///< working 1 - working 2, per watt of boost heating
  Seconds gradient_lag{0.0};       ///< after which it follows the heating; 0: at once
};

struct MagneticPlant {
  /// Ambient field in the bench frame: up, north, east.
  std::array<double, 3> ambient_ut{-50.0, 16.0, 1.0};
  Microtesla ambient_diurnal{0.05};
  /// Step changes of the ambient field by lifts and cars: mean number an hour and their size.
  double ambient_steps_per_h = 0.0;
  Microtesla ambient_step{1.0};
  /// True field per ampere of each pair (horizontal pair: up; vertical pair: north).
  std::array<double, 2> coil_ut_per_a{89.9, 89.9};
  /// Deviation of each pair's axis from the bench axis, deg.
  std::array<double, 2> coil_misalignment_deg{0.3, 0.3};
  double supply_bits = 15;  ///< plus sign
  std::array<double, 3> sensor_offset_ut{0.0, 0.0, 0.0};
  std::array<std::array<double, 3>, 3> sensor_matrix{
      {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  Microtesla sensor_noise{0.002};
};

struct SimulationConfig {
  ThermalPlant thermal;
  MagneticPlant magnetic;
  Degree turntable_repeatability{0.003};
  /// Earth's rate along the sensitive axis, and horizontally (for earth_rate_projection).
  DegPerHour earth_rate_on_axis{12.433};
  /// Frames a second that the gyro really sends; without it as many as its description states.
  std::optional<double> gyro_frame_rate_hz;
  Seconds step{0.1};  ///< of the plant's integration
};

struct BenchConfig {
  std::string name;
  std::string description;
  ThermostatConfig thermostat;
  CoilConfig coil_horizontal;  ///< the horizontal pair of rings: field along the vertical, OX
  CoilConfig coil_vertical;    ///< the vertical pair, axis north: OY at azimuth 0, OZ at 90 deg
  MagnetometerConfig magnetometer;  ///< mounted with the gyro: turns with it, reads gyro axes
  TurntableConfig turntable;
  GyroConfig gyro;
  std::vector<AuxiliaryConfig> auxiliary;
  BenchLimits limits;
  /// Nothing where nobody has said it: then a plan cannot know.
  std::optional<ThermalReach> thermal;
  std::vector<InterlockConfig> interlocks;  ///< load_bench puts the default ones where none are
  EstimateConfig estimates;
  SimulationConfig simulation;
};

/// The channels of all auxiliary sensors, in the order of the bench.
std::vector<SensorChannel> auxiliary_channels(const BenchConfig& bench);

/// The first moment of a day written YYYY-MM-DD; nothing when there is no such day.
std::optional<std::chrono::sys_days> date_of(const std::string& text);

/// What the simulated plant can do.
ThermalReach reach_of(const ThermalPlant& plant);

/// The device file that a bench's file means by "device": a path relative to the bench's file, or
/// the name of one in the folder devices beside the bench's own folder, or of a ready one.
/// kBadInput says where it was looked for.
Result<std::filesystem::path> device_file(const std::filesystem::path& bench,
                                          const std::string& device);

/// Reads a bench and the device files that it names ("device": "gyro-kvh").
/// Errors: kBadInput, one line with the file and the JSON pointer.
Result<BenchConfig> load_bench(const std::filesystem::path& file);

}  // namespace fogbench::config
