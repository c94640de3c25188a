#pragma once
// The JSON shape of benches (bench.hpp): keys, sentences, bounds.

#include "config/bench.hpp"
#include "config/codec.hpp"
#include "config/describe_device.hpp"
#include "config/describe_interlock.hpp"
#include "config/describe_sensor.hpp"
#include "config/device_file.hpp"

namespace fogbench::config {

/// A key that names a device file: a ready one, or a path relative to the file that it stands in.
template <class Device>
struct DeviceReference {
  Device& device;
};

/// Reads the device file named at `at`; the caller takes the kind that it needs.
std::optional<DeviceFile> read_named_device(const Place& at);

template <class Device>
struct Codec<DeviceReference<Device>> {
  static bool read(const Place& at, DeviceReference<Device>& out, const Rule& /*rule*/) {
    std::optional<DeviceFile> file = read_named_device(at);
    if (!file) return false;
    auto* device = std::get_if<Device>(&*file);
    if (device == nullptr) return at.fail("names a device of the wrong kind for this instrument");
    out.device = std::move(*device);
    return true;
  }
  static ordered_json schema(const Rule& /*rule*/) { return Codec<std::string>::schema({}); }
  static ordered_json write(const DeviceReference<Device>& reference) {
    return reference.device.name;
  }
};
template <class Device>
struct Codec<DeviceReference<std::optional<Device>>> : Codec<DeviceReference<Device>> {
  static bool read(const Place& at, DeviceReference<std::optional<Device>>& out, const Rule& rule) {
    DeviceReference<Device> inside{out.device.emplace()};
    return Codec<DeviceReference<Device>>::read(at, inside, rule);
  }
  static ordered_json write(const DeviceReference<std::optional<Device>>& reference) {
    return reference.device ? ordered_json(reference.device->name) : ordered_json(nullptr);
  }
};

/// A sensor of any kind.
template <>
struct Codec<DeviceReference<SensorDevice>> {
  static bool read(const Place& at, DeviceReference<SensorDevice>& out, const Rule& rule);
  static ordered_json schema(const Rule& /*rule*/) { return Codec<std::string>::schema({}); }
  static ordered_json write(const DeviceReference<SensorDevice>& reference) {
    return name_of(reference.device);
  }
};

bool check(const Place& at, const InstrumentConfig& instrument);

template <class Visitor>
void describe_instrument(Visitor& v, InstrumentConfig& i) {
  v.optional("connection", i.connection,
             "\"simulated\", or where it is: tcp:ADDRESS:PORT, rtu:TTY:BAUD[:8E1][:echo], "
             "usb:VENDOR:PRODUCT:SERIAL, hid:VENDOR:PRODUCT:SERIAL, tty:TTY[:BAUD]. ADDRESS is in "
             "numbers, since looking up a name has no deadline.");
  v.optional("serial_number", i.serial_number, "For the protocol of the acceptance.");
  v.optional("calibrated_on", i.calibrated_on, "Date of the certificate, YYYY-MM-DD.");
  v.optional("calibration_due", i.calibration_due, "Date until which it is valid, YYYY-MM-DD.");
}

template <class Visitor>
void describe(Visitor& v, ThermostatConfig& t) {
  describe_instrument(v, t);
  v.required("device", DeviceReference<ModbusDevice>{t.device},
             "Its description, a device file of the kind modbus: a ready one's name, or a path "
             "from this file.");
  v.optional(
      "sensor_lag_s", t.device.sensor_lag,
      "First-order lag of the sensors on the carrier, in place of the device file's; averages "
      "are freed of it.",
      between(0, 120));
}

template <class Visitor>
void describe(Visitor& v, MagnetometerConfig& m) {
  describe_instrument(v, m);
  v.optional("fitted", m.fitted,
             "false: there is none. The field is then reckoned from the coils' measured currents, "
             "their nominal field per ampere and ambient_ut.");
  v.optional("device", DeviceReference<HidDevice>{m.device},
             "Its description where it is fitted, a device file of the kind hid: a ready one's "
             "name, or a path from this file.");
  v.optional("ambient_ut", m.ambient_ut,
             "Where none is fitted, the ambient field: up, north, east.");
  MagnetometerCalibration calibration{m.device.calibration_offset_ut, m.device.calibration_matrix};
  v.optional("calibration", calibration,
             "Correction from this instrument's certificate, in place of the device file's.");
}

template <class Visitor>
void describe(Visitor& v, CoilConfig& c) {
  describe_instrument(v, c);
  v.required(
      "device", DeviceReference<ScpiDevice>{c.device},
      "Its supply's description, a device file of the kind scpi: a ready one's name, or a path "
      "from this file.");
  v.optional("field_ut_per_a", c.field_ut_per_a, "Nominal field at the centre per ampere.",
             above(0));
  v.optional("current_limit_a", c.current_limit, "Largest current of either sign.", above(0));
}

template <class Visitor>
void describe(Visitor& v, TurntableConfig& t) {
  describe_instrument(v, t);
  v.optional("motorised", t.motorised, "false: the operator is asked to turn the gyro.");
  v.optional("device", DeviceReference<std::optional<ScpiDevice>>{t.device},
             "Its description when motorised, a device file of the kind scpi: a ready one's name, "
             "or a path from this file.");
  v.optional("move_time_s", t.move_time, "Typical time of a rotation, for the plan.", at_least(0));
}

template <class Visitor>
void describe(Visitor& v, GyroConfig& g) {
  describe_instrument(v, g);
  v.required("device", DeviceReference<FrameDevice>{g.device},
             "Its description, a device file of the kind frame: a ready one's name, or a path "
             "from this file.");
  v.optional("frame_rate_hz", g.device.frame_rate_hz,
             "Frames a second that this gyro is set to, in place of the device file's.",
             between(0.1, 100000));
  v.optional("reference_rate_deg_per_h", g.reference_rate,
             "Earth's rate along the sensitive axis here; subtracted from every reading.");
  v.optional("max_gap_s", g.max_gap,
             "Longest run of consecutive lost frames that an average survives.", above(0));
}

template <class Visitor>
void describe(Visitor& v, AuxiliaryConfig& a) {
  v.required("name", a.name, "Names it in events and messages.");
  describe_instrument(v, a);
  v.required("device", DeviceReference<SensorDevice>{a.device},
             "Its description, a device file of the kind modbus_sensor, scpi_sensor, hid_sensor or "
             "line_sensor: a ready one's name, or a path from this file.");
}

template <class Visitor>
void describe(Visitor& v, BenchLimits& l) {
  v.optional("temperature_minimum_c", l.temperature_minimum, "Lowest temperature of the gyro.");
  v.optional("temperature_maximum_c", l.temperature_maximum, "Highest temperature of the gyro.");
  v.optional("field_maximum_ut", l.field_maximum, "Largest field along any axis.", above(0));
  v.optional("compensation_maximum_ut", l.compensation_maximum,
             "Largest ambient field to null along one axis; a sweep's current is checked with it.",
             at_least(0));
  v.optional("absence_maximum_s", l.absence_maximum,
             "How long a run waits for an instrument that was unplugged.", above(0));
  v.optional("record_wait_maximum_s", l.record_wait_maximum,
             "How long a run waits, coils at 0 A, for a run log that cannot be written.", above(0));
  v.optional("run_time_maximum_s", l.run_time_maximum, "Longest run.", above(0));
}

template <class Visitor>
void describe(Visitor& v, ThermalReach& t) {
  v.required("boost_c_per_h", t.boost,
             "How fast the boost heaters warm the gyro at the room's temperature.", above(0));
  v.required("normal_c_per_h", t.normal,
             "How fast the normal heater does, which holds a temperature.", above(0));
  v.optional("cooling_c_per_h", t.cooling,
             "How fast a cooler cools it at the room's temperature; 0: there is none.",
             at_least(0));
  v.required("time_constant_s", t.time_constant,
             "With which it comes to the room's temperature by itself.", above(0));
}

template <class Visitor>
void describe(Visitor& v, EstimateConfig& e) {
  v.optional("room_c", e.room, "Usual temperature of the room.");
  v.optional("heating_c_per_h", e.heating, "With the boost heaters.", above(0));
  v.optional("cooling_c_per_h", e.cooling, "With the heaters off, on average.", above(0));
  v.optional("settling_s", e.settling, "From arriving near a temperature to the dwell.",
             at_least(0));
  v.optional("compensation_s", e.compensation, "Nulling the ambient field.", at_least(0));
  v.optional("operator_answer_s", e.operator_answer, "Until the operator answers.", at_least(0));
}

template <class Visitor>
void describe(Visitor& v, ThermalPlant& t) {
  v.optional("heater_j_per_k", t.heater_j_per_k, "Heat capacity of the heaters.", above(0));
  v.optional("carrier_j_per_k", t.carrier_j_per_k, "Heat capacity of the coil carrier.", above(0));
  v.optional("coil_j_per_k", t.coil_j_per_k, "Heat capacity of the fibre coil.", above(0));
  v.optional("heater_carrier_w_per_k", t.heater_carrier_w_per_k, "Heaters to carrier.", above(0));
  v.optional("carrier_coil_w_per_k", t.carrier_coil_w_per_k, "Carrier to fibre coil.", above(0));
  v.optional("carrier_ambient_w_per_k", t.carrier_ambient_w_per_k,
             "Loss to the room; at most 0.265 if 9 W are to hold +34 degC.", above(0));
  v.optional("boost_maximum_w", t.boost_maximum, "Power of all boost heaters.", above(0));
  v.optional("normal_maximum_w", t.normal_maximum, "Power of the normal heater.", above(0));
  v.optional("cooling_maximum_w", t.cooling_maximum,
             "Power of a chamber's cooler, which the controller drives in normal mode; 0: none.",
             at_least(0));
  v.optional("boost_drop_out_c", t.boost_drop_out,
             "The boost heaters switch off this far below the target.", at_least(0));
  v.optional("dead_time_s", t.dead_time, "From a change of power to the carrier.",
             between(0, 3600));
  v.optional("pid_gain_w_per_k", t.pid_gain_w_per_k, "Gain of the controller.", above(0));
  v.optional("pid_integral_s", t.pid_integral, "Its integral time.", above(0));
  v.optional("pid_derivative_s", t.pid_derivative, "Its derivative time.", at_least(0));
  v.optional("sensor_noise_c", t.sensor_noise, "Standard deviation of a reading.", at_least(0));
  v.optional("sensor_resolution_c", t.sensor_resolution, "Step of a reading.", at_least(0));
  v.optional("sensor_offset_c", t.sensor_offset_c, "Error of working 1, working 2 and control.");
  v.optional("sensor_lag_s", t.sensor_lag, "First-order lag of the sensors.", at_least(0));
  v.optional("ambient_c", t.ambient, "The room.");
  v.optional("ambient_wander_c", t.ambient_wander, "Amplitude of its slow change.", at_least(0));
  v.optional("ambient_period_s", t.ambient_period, "Period of its slow change.", above(0));
  v.optional("gradient_c_per_w", t.gradient_c_per_w,
             "Working 1 less working 2, per watt of boost heating.");
  v.optional("gradient_lag_s", t.gradient_lag,
             "The lag at which it follows the heating; 0: at once.", at_least(0));
}

template <class Visitor>
void describe(Visitor& v, MagneticPlant& m) {
  v.optional("ambient_ut", m.ambient_ut, "Ambient field in the bench frame: up, north, east.");
  v.optional("ambient_diurnal_ut", m.ambient_diurnal, "Amplitude of its daily change.",
             at_least(0));
  v.optional("ambient_steps_per_h", m.ambient_steps_per_h,
             "Mean number an hour of its steps by lifts and cars.", between(0, 3600));
  v.optional("ambient_step_ut", m.ambient_step, "Size of these steps.", at_least(0));
  v.optional("coil_ut_per_a", m.coil_ut_per_a, "True field per ampere: horizontal, vertical pair.",
             above(0));
  v.optional("coil_misalignment_deg", m.coil_misalignment_deg,
             "Of the horizontal and the vertical pair's axis.", between(-10, 10));
  v.optional("supply_bits", m.supply_bits, "Resolution of the supplies, besides the sign.",
             between(4, 32));
  v.optional("sensor_offset_ut", m.sensor_offset_ut, "What the magnetometer reads in zero field.");
  v.optional("sensor_matrix", m.sensor_matrix,
             "Rows of the matrix that takes the true field to the magnetometer's.");
  v.optional("sensor_noise_ut", m.sensor_noise, "Standard deviation of a reading.", at_least(0));
}

template <class Visitor>
void describe(Visitor& v, SimulationConfig& s) {
  v.optional("thermal", s.thermal, "Gyro, heaters, thermostat and room.");
  v.optional("magnetic", s.magnetic, "Coils, ambient field and magnetometer.");
  v.optional("turntable_repeatability_deg", s.turntable_repeatability,
             "Standard deviation of a position.", at_least(0));
  v.optional("earth_rate_on_axis_deg_per_h", s.earth_rate_on_axis,
             "Earth's rate along the sensitive axis.");
  v.optional("gyro_frame_rate_hz", s.gyro_frame_rate_hz,
             "Frames a second that the gyro really sends; without it what its description states.",
             between(0.1, 100000));
  v.optional("step_s", s.step, "Of the integration.", between(0.001, 1));
}

template <class Visitor>
void describe(Visitor& v, BenchConfig& b) {
  v.required("name", b.name, "Short name.");
  v.optional("description", b.description, "What this bench is, in a sentence.");
  v.required("thermostat", b.thermostat, "Controller of the gyro's heaters.");
  v.required("coil_horizontal", b.coil_horizontal,
             "Horizontal pair of rings and its supply: field along the vertical.");
  v.required("coil_vertical", b.coil_vertical,
             "Vertical pair of rings and its supply: field along north.");
  v.required("magnetometer", b.magnetometer, "Mounted with the gyro, reads the gyro's axes.");
  v.required("turntable", b.turntable, "Turns the gyro in azimuth.");
  v.required("gyro", b.gyro, "The gyro under test.");
  v.optional("auxiliary", b.auxiliary,
             "Sensors that are recorded beside the measurement: each of their quantities is a "
             "channel of the record.");
  v.optional("limits", b.limits, "What no procedure may exceed here.");
  v.optional("thermal", b.thermal,
             "What heaters, cooler and room can do to the gyro's temperature: a plan asks for no "
             "more. A simulated bench has it from its plant.");
  v.optional("interlocks", b.interlocks,
             "What may not be while a run goes on, and what is done when it is; without this list, "
             "one of each kind but those of channels.",
             not_empty());
  v.optional("estimates", b.estimates, "How long things take here, for a plan's duration.");
  v.optional("simulation", b.simulation, "The true plant behind simulated instruments.");
}

bool check(const Place& at, const ThermostatConfig& thermostat);
bool check(const Place& at, const MagnetometerConfig& magnetometer);
bool check(const Place& at, const CoilConfig& coil);
bool check(const Place& at, const TurntableConfig& turntable);
bool check(const Place& at, const GyroConfig& gyro);
bool check(const Place& at, const AuxiliaryConfig& sensor);
bool check(const Place& at, const MagneticPlant& plant);
bool check(const Place& at, const BenchConfig& bench);

}  // namespace fogbench::config
