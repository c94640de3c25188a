// fogbench simulate --serve as another's programs meet it: mbpoll, a Modbus master that shares no
// line with ours. What the kernel's drivers and our own say of it is tested elsewhere.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class SimulateTest : public FogbenchTest {
 protected:
  /// On ports of its own; `more` are further options.
  static Process::Setup quiet() { return {}; }
  static std::vector<std::string> serve(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"simulate",     "--serve", "--modbus-port", "0",
                                       "--usbip-port", "0",       "--seed",        "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return command(arguments);
  }
  /// The document that it prints first.
  static nlohmann::json document(Process& bench) {
    EXPECT_TRUE(bench.wait_for_output("\n}\n", 30s)) << bench.output();
    return nlohmann::json::parse(bench.output(), nullptr, false);
  }
  static Finished interrupt(Process& bench) {
    bench.signal(SIGINT);
    return bench.wait(10s);
  }
  /// One answer of the controller to mbpoll, which must be installed.
  static Finished mbpoll(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"/usr/bin/mbpoll", "-0", "-1", "-a", "1"});
    const Finished done = support::run(arguments);
    EXPECT_NE(done.status, 127) << "mbpoll is missing: scripts/setup installs it";
    return done;
  }
};

TEST_F(SimulateTest, AForeignModbusMasterReadsAndWritesOverTcp) {
  Process bench(serve({"--json"}));
  const auto served = document(bench);
  const std::string connection = served["instruments"]["thermostat"]["connection"];
  ASSERT_EQ(connection.rfind("tcp:127.0.0.1:", 0), 0U) << connection;
  const std::string port = connection.substr(connection.rfind(':') + 1);
  const auto tcp = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"-m", "tcp", "-p", port, "127.0.0.1"});
    return mbpoll(arguments);
  };
  // temperature_working_1 at 0x8002: a float, the high word first; the room has 21 degC.
  Finished done = tcp({"-t", "4:float", "-B", "-r", "32770"});
  EXPECT_EQ(done.status, 0) << done.out << done.err;
  EXPECT_TRUE(std::regex_search(done.out, std::regex(R"(\[32770\]:\s+2[01]\.[0-9]+)"))) << done.out;
  // The target, register 2 in tenths of a degree: written by function 6, and read back.
  done = tcp({"-r", "2", "415"});
  EXPECT_EQ(done.status, 0) << done.out << done.err;
  done = tcp({"-r", "2"});
  EXPECT_THAT(done.out, HasSubstr("415"));
  done = tcp({"-r", "2", "9000"});
  EXPECT_NE(done.status, 0) << "900 degC";
  EXPECT_THAT(done.err, HasSubstr("Illegal data value"));
  done = tcp({"-r", "1000"});
  EXPECT_THAT(done.err, HasSubstr("Illegal data address"));
  EXPECT_EQ(interrupt(bench).status, 0);
}

TEST_F(SimulateTest, AForeignModbusMasterReadsAndWritesOverTheSerialLine) {
  Process bench(serve({"--json"}));
  const auto served = document(bench);
  const std::string also = served["instruments"]["thermostat"]["also"];
  ASSERT_EQ(also.rfind("rtu:", 0), 0U) << also;
  const std::string tty = also.substr(4, also.rfind(':') - 4);
  const auto rtu = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"-m", "rtu", "-b", "9600", "-P", "none", tty});
    return mbpoll(arguments);
  };
  Finished done = rtu({"-t", "4:float", "-B", "-r", "32770"});
  EXPECT_EQ(done.status, 0) << done.out << done.err;
  EXPECT_TRUE(std::regex_search(done.out, std::regex(R"(\[32770\]:\s+2[01]\.[0-9]+)"))) << done.out;
  done = rtu({"-r", "2", "300"});
  EXPECT_EQ(done.status, 0) << done.out << done.err;
  done = rtu({"-r", "2"});
  EXPECT_THAT(done.out, HasSubstr("300"));
  done = rtu({"-r", "1000"});
  EXPECT_THAT(done.err, HasSubstr("Illegal data address"));
  EXPECT_EQ(interrupt(bench).status, 0);
}

TEST_F(SimulateTest, SaysWhereEverythingIsAndWhatToDoNext) {
  const std::string file = (folder_ / "served.json").string();
  Process bench(serve({"--write-bench", file}));
  ASSERT_TRUE(bench.wait_for_output("Ctrl-C ends it.\n", 30s)) << bench.output();
  const std::string& says = bench.output();
  for (const char* const part :
       {"tcp:127.0.0.1:", "rtu:", "usb:0x1209:0x0002:SIM-CH-1", "usb:0x1209:0x0002:SIM-CV-1",
        "hid:0x1209:0x0001:SIM-MAG-1", "attach --remote 127.0.0.1 --busid 1-3", "modprobe vhci-hcd",
        "seed 1"}) {
    EXPECT_THAT(says, HasSubstr(part));
  }
  EXPECT_THAT(says, HasSubstr("Next: fogbenchd --bench " + file));
  EXPECT_EQ(interrupt(bench).status, 0);
}

TEST_F(SimulateTest, WritesABenchThatMeetsIt) {
  const std::string file = (folder_ / "served.json").string();
  Process bench(serve({"--json", "--speed", "10", "--write-bench", file}));
  const auto served = document(bench);
  const auto written = nlohmann::json::parse(support::read_text(file), nullptr, false);
  for (const auto& [name, instrument] : served["instruments"].items()) {
    EXPECT_EQ(written[name]["connection"], instrument["connection"]) << name;
  }
  EXPECT_FALSE(written.contains("simulation"));
  EXPECT_EQ(written["gyro"]["frame_rate_hz"], 1000.0) << "ten times 100 Hz";
  const std::string tty = written["gyro"]["connection"].get<std::string>().substr(4);
  EXPECT_TRUE(fs::is_symlink(tty)) << tty;
  // It is a bench like any other: whole, and with device files that are found.
  EXPECT_EQ(fogbench({"plan", "coil-sweep", "--bench", file}).status, 0);
  // Its gyro is looked at as this bench runs it, not as its device file says.
  const Finished gyro = fogbench({"device", "probe", "gyro", "--bench", file});
  EXPECT_EQ(gyro.status, 0) << gyro.err;
  EXPECT_TRUE(std::regex_search(gyro.out, std::regex("expected about [0-9]{4,5};"))) << gyro.out;

  EXPECT_EQ(interrupt(bench).status, 0);
  EXPECT_FALSE(fs::exists(fs::path(tty).parent_path())) << "nothing stays behind";
}

TEST_F(SimulateTest, RefusesWhatCannotBeServed) {
  Process bench(serve({"--json"}));
  const auto served = document(bench);
  const std::string port = std::to_string(served["usbip"]["port"].get<int>());
  const auto refusal = [&](const std::vector<std::string>& more) {
    return support::run(serve(more));
  };
  expect_refused(refusal({"--usbip-port", port}), 2, "--usbip-port");  // It stands there twice.
  Finished done = fogbench({"simulate", "--serve", "--modbus-port", "0", "--usbip-port", port});
  expect_refused(done, 4, "tcp:127.0.0.1:" + port + ": cannot listen there");
  expect_refused(fogbench({"simulate"}), 2, "--serve");
  expect_refused(refusal({"--speed", "0"}), 2, "--speed");
  expect_refused(refusal({"--bench", "factory"}), 3, "/turntable/motorised");
  expect_refused(refusal({"--write-bench", (folder_ / "none" / "x.json").string()}), 3, "x.json");
}

}  // namespace
}  // namespace fogbench::system_tests
