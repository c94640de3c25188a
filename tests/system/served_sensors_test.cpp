// The auxiliary sensors of `fogbench simulate --serve`, read by fogbenchd over their real wires in
// real time: a barometer over Modbus TCP, a voltmeter that answers SCPI on a serial line, a
// hygrometer that streams lines of text, a light meter whose HID reports come over USB/IP (what
// stands between, the kernel and hidapi, is tried under a real kernel: tests/system/kernel). Each
// fails once, one after the other, at the wire.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "config/bench.hpp"
#include "tests/system/far_bench/client.hpp"
#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

/// Channel, its sensor, what it reads without a fault.
struct Expected {
  const char* channel;
  const char* sensor;
  double mean, tolerance;
};
constexpr Expected kExpected[] = {{"pressure_hpa", "barometer", 1013.0, 1.0},
                                  {"supply_v", "voltmeter", 5.0, 0.1},
                                  {"humidity_percent", "hygrometer", 45.0, 3.0},
                                  {"room_c", "barometer", 22.0, 3.0},
                                  {"illuminance_lx", "light_meter", 300.0, 60.0}};

/// The columns of a table, empty cells as NaN.
std::map<std::string, std::vector<double>> columns_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line, cell;
  std::getline(lines, line);
  std::vector<std::string> names;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(lines, line)) {
    std::istringstream cells(line + ",");
    for (const std::string& name : names) {
      cell.clear();
      std::getline(cells, cell, ',');
      columns[name].push_back(cell.empty() ? std::nan("") : std::atof(cell.c_str()));
    }
  }
  return columns;
}

class ServedSensors : public FogbenchTest {
 protected:
  /// The ready bench with its supplies on serial lines, which needs no kernel that takes USB.
  std::string bench() const {
    const auto ready = tests::source_tree() / "config/benches/simulated-auxiliary.json";
    auto bench = nlohmann::json::parse(support::read_text(ready));
    const auto absolute = [&](nlohmann::json& its) {
      its["device"] = config::device_file(ready, its["device"].get<std::string>())->string();
    };
    for (auto& [name, its] : bench.items()) {
      if (its.is_object() && its.contains("device")) absolute(its);
    }
    for (auto& its : bench["auxiliary"]) absolute(its);
    for (const char* const coil : {"coil_horizontal", "coil_vertical"}) {
      bench[coil]["connection"] = "tty:/dev/null";
    }
    return folder_.file("bench.json", bench.dump()).string();
  }
  std::string scenario() const {
    return folder_
        .file("scenario.json", R"({"name": "failing sensors", "noise": "navigation", "faults": [
  {"device": "barometer", "at_s": 12, "kind": "timeout", "for_s": 5},
  {"device": "hygrometer", "at_s": 17, "kind": "unplug", "for_s": 5},
  {"device": "light_meter", "at_s": 22, "kind": "unplug", "for_s": 5},
  {"device": "voltmeter", "at_s": 33, "kind": "unplug", "for_s": 5}]})")
        .string();
  }
  /// Twenty-one averages of 2 s, void when the supply voltage was not read.
  std::string procedure() const {
    return folder_
        .file("record.json", R"({"name": "record", "needs": ["supply_v"], "steps": [
  {"step": "set_temperature", "mode": "off"},
  {"step": "wait", "duration_s": 42, "segment": "static", "window_s": 2}]})")
        .string();
  }
};

TEST_F(ServedSensors, EachFailureIsOnRecordAndCostsItsOwnChannelsUnlessTheProcedureNeedsThem) {
  const std::string served_file = (folder_ / "served.json").string();
  Process served(
      command({"simulate", "--serve", "--bench", bench(), "--scenario", scenario(), "--seed", "5",
               "--modbus-port", "0", "--usbip-port", "0", "--json", "--write-bench", served_file}));
  ASSERT_TRUE(served.wait_for_output("\n}\n", 30s)) << served.output();
  const auto document = nlohmann::json::parse(served.output(), nullptr, false);
  const auto wire = [&](const char* name) {
    return document["instruments"][name]["connection"].get<std::string>().substr(0, 4);
  };
  EXPECT_EQ(wire("barometer"), "tcp:");
  EXPECT_EQ(wire("voltmeter"), "tty:");
  EXPECT_EQ(wire("hygrometer"), "tty:");
  EXPECT_EQ(wire("light_meter"), "hid:");

  Process daemon(
      command({"--bench", served_file, "--store", store(), procedure()}, "fogbenchd"),
      {far_bench::hid_stand_in(folder_.path(), document["usbip"]["port"].get<int>()), {}});
  const Finished finished = daemon.wait(120s);
  ASSERT_EQ(finished.status, 0) << finished.err;

  const auto run = json({"show", "1", "--store", store(), "--json"});
  EXPECT_EQ(run["outcome"], "completed");
  std::string events;
  for (const auto& event : run["events"]) events += event["message"].get<std::string>() + "\n";

  const Finished table = fogbench({"export", "1", "--store", store()});
  ASSERT_EQ(table.status, 0) << table.err;
  const auto columns = columns_of(table.out);
  const std::size_t rows = columns.at("rate_deg_per_h").size();
  for (const char* const own : {"rate_deg_per_h", "temperature_c", "field_x_ut"}) {
    for (const double value : columns.at(own)) EXPECT_FALSE(std::isnan(value)) << own;
  }
  const auto missing = [&](const Expected& its, std::size_t row) {
    return std::isnan(columns.at(its.channel)[row]);
  };
  for (const Expected& its : kExpected) {
    SCOPED_TRACE(its.channel);
    ASSERT_TRUE(columns.contains(its.channel)) << table.out;
    EXPECT_THAT(events, HasSubstr(std::string(its.sensor) + ": answers again after"));
    std::size_t read = 0;
    for (const double value : columns.at(its.channel)) {
      if (std::isnan(value)) continue;
      ++read;
      EXPECT_NEAR(value, its.mean, its.tolerance);
    }
    if (std::string(its.sensor) == "voltmeter") {
      EXPECT_EQ(read, rows) << "a point without it is void";
      continue;
    }
    EXPECT_LT(read, rows);
    // A sensor that has failed is asked again every ten seconds.
    EXPECT_GE(read, rows / 3);
    for (const Expected& other : kExpected) {
      if (std::string(other.sensor) == its.sensor) continue;
      bool alone = false;
      for (std::size_t row = 0; row < rows; ++row) {
        alone = alone || (missing(its, row) && !missing(other, row));
      }
      EXPECT_TRUE(alone) << "whenever it is missing, " << other.channel << " is too";
    }
  }
  // What the procedure needs costs points, nothing else does.
  EXPECT_LT(rows, 21U);
  EXPECT_GE(rows, 12U);
  EXPECT_THAT(events, HasSubstr("readings of supply_v in 2 s"));
  EXPECT_THAT(events, Not(HasSubstr("readings of pressure_hpa")));
}

}  // namespace
}  // namespace fogbench::system_tests
