// Auxiliary sensors of a served bench, read by our own drivers over their real wires.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/auxiliary_sensor.hpp"
#include "drivers/open_ports.hpp"
#include "tests/simulator/wire/loopback.hpp"
#include "tests/support/own_locks.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::simulator {
namespace {

class ServedSensors : public ServedBenchTest {
 protected:
  ServedSensors() : ServedBenchTest({}, ready_bench()), config_(ready_bench()) {}

  static config::BenchConfig ready_bench() {
    return *config::load_bench(tests::source_tree() / "config/benches/simulated-auxiliary.json");
  }

  /// The sensor as a daemon reaches it, by the connection that the bench is served at.
  std::unique_ptr<drivers::AuxiliarySensor> reach(std::size_t index,
                                                  bool by_the_other_way = false) {
    config::AuxiliaryConfig its = config_.auxiliary[index];
    const ServedInstrument& served = instrument(its.name);
    const std::string& connection = by_the_other_way ? served.also : served.connection;
    drivers::SensorTransport way;
    const auto open = [&](const auto& device) {
      auto port = drivers::open_port(device, connection, machine_);
      EXPECT_TRUE(port) << port.error().message;
      way = std::move(*port);
    };
    std::visit(open, its.device);
    auto sensor = drivers::attach_sensor(its, std::move(way), machine_);
    EXPECT_TRUE(sensor) << sensor.error().message;
    return std::move(*sensor);
  }
  static void expect_near(drivers::AuxiliarySensor& sensor, double expected) {
    const auto value = sensor.read().front();
    ASSERT_TRUE(value) << value.error().message;
    EXPECT_NEAR(*value, expected, 0.02 * expected);
  }

  config::BenchConfig config_;
  drivers::SteadyClock machine_;
  support::OwnLocks locks_;
};

TEST_F(ServedSensors, AreReadOverModbusTcpAndRtu) {
  expect_near(*reach(0), 1013.0);
  expect_near(*reach(0, true), 1013.0);
}

TEST_F(ServedSensors, AreReadOverAScpiLine) {
  const auto sensor = reach(1);
  expect_near(*sensor, 5.0);
  EXPECT_EQ(*sensor->identity(), "34461A");
}

TEST_F(ServedSensors, AreReadFromTheLinesThatTheySend) {
  expect_near(*reach(2), 45.0);
}

TEST_F(ServedSensors, OfUsbStandOnTheBus) {
  EXPECT_EQ(instrument("light_meter").connection, "hid:0x1209:0x0003:SIM-LM-1");
  EXPECT_FALSE(instrument("light_meter").bus_id.empty());
}

}  // namespace
}  // namespace fogbench::simulator
