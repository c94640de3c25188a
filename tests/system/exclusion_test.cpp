// Two processes on one thing: only real ones have a process number, and locks that end with them.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>

#include "config/connection.hpp"
#include "drivers/modbus_port.hpp"
#include "tests/system/control_fixture.hpp"

namespace fogbench::system_tests {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

std::string held_by(pid_t pid, const std::string& name) {
  return fmt::format("is held by process {} ({})", pid, name);
}

class ExclusionTest : public ControlTest {
 protected:
  /// A second daemon with a socket of its own.
  Finished second(std::vector<std::string> more) const {
    more.insert(more.end(), {"--socket", (folder_ / "second.sock").string()});
    return support::run(command(more, "fogbenchd"));
  }
  std::string queue() const { return store() + ".queue"; }
};

TEST_F(ExclusionTest, ARunLogIsServedByOneDaemonWhateverTheSocketAndTheName) {
  const auto first = serve();
  // Two jobs that wait behind a question, so that the queue is on disk.
  for (const char* name : {"a", "b"}) {
    EXPECT_EQ(fogbench({"run", procedure(name, 1, "Ready?")}).status, 0);
  }
  wait_for_prompt();
  for (int i = 0; i < 100 && !fs::exists(queue()); ++i) usleep(50'000);
  const std::string waiting = support::read_text(queue());

  const std::string link = (folder_ / "link.db").string();
  fs::create_symlink(store(), link);
  for (const std::string& name : {store(), link}) {
    const Finished refused = second({"--bench", "simulated", "--store", name});
    EXPECT_EQ(refused.status, 4);
    EXPECT_THAT(refused.err,
                HasSubstr("run log " + name + " " + held_by(first->id(), "fogbenchd")));
  }
  EXPECT_EQ(support::read_text(queue()), waiting);
  EXPECT_EQ(status()["state"], "running");
  // A run of its own is a row of its own.
  EXPECT_EQ(support::run(dry_run(kQuickSweep)).status, 0);
  EXPECT_EQ(support::read_text(queue()), waiting);
}

TEST_F(ExclusionTest, WhatACrashedDaemonHeldIsFree) {
  auto first = serve();
  first->signal(SIGKILL);
  EXPECT_EQ(first->wait(10s).signal, SIGKILL);
  const auto next = serve();
  EXPECT_EQ(status()["state"], "idle");
  next->signal(SIGTERM);
  EXPECT_EQ(next->wait(30s).status, 0);
  EXPECT_FALSE(fs::exists(store() + ".serving"));
}

/// A simulated bench at the wire, one of whose instruments this test holds.
class HeldInstrumentTest : public ExclusionTest {
 protected:
  HeldInstrumentTest()
      : served_(command({"simulate", "--serve", "--modbus-port", "0", "--usbip-port", "0", "--seed",
                         "1", "--json", "--write-bench", bench()})) {
    EXPECT_TRUE(served_.wait_for_output("\n}\n", 30s)) << served_.output();
    served_at_ = nlohmann::json::parse(served_.output(), nullptr, false)["instruments"];
  }
  std::string bench() const { return (folder_ / "served.json").string(); }
  std::string connection(const std::string& role, const char* which = "connection") const {
    return served_at_[role][which];
  }
  template <class Wanted>
  static Wanted parsed(const std::string& connection) {
    return std::get<Wanted>(*config::parse_connection(connection));
  }
  static Finished probe(const std::string& device, const std::string& connection) {
    return fogbench({"device", "probe", device, "--connection", connection});
  }

  Process served_;
  nlohmann::json served_at_;
  drivers::SteadyClock clock_;
};

TEST_F(HeldInstrumentTest, IsNotProbed) {
  const std::string tcp = connection("thermostat");
  const std::string rtu = connection("thermostat", "also");
  const std::string me = held_by(getpid(), "system_test");
  auto by_tcp = drivers::open_modbus(parsed<config::TcpConnection>(tcp), 1, clock_);
  ASSERT_TRUE(by_tcp) << by_tcp.error().message;
  expect_refused(probe("thermostat-eurotherm", tcp), 4, me);

  auto by_rtu = drivers::open_modbus(parsed<config::RtuConnection>(rtu), 1, clock_);
  ASSERT_TRUE(by_rtu) << by_rtu.error().message;
  expect_refused(probe("thermostat-eurotherm", rtu), 4, "serial line ");
  expect_refused(probe("thermostat-eurotherm", rtu), 4, me);

  by_tcp = Error{ErrorCode::kHeld, "given back"};
  EXPECT_EQ(probe("thermostat-eurotherm", tcp).status, 0);
}

TEST_F(HeldInstrumentTest, IsNotTakenIntoAnotherBench) {
  // One whose supply is a line, the same.
  auto file = nlohmann::json::parse(support::read_text(bench()), nullptr, false);
  const std::string rtu = connection("thermostat", "also");
  const std::string line = rtu.substr(4, rtu.rfind(':') - 4);
  file["coil_horizontal"]["connection"] = "tty:" + line;
  const auto path = folder_.file("lines.json", file.dump()).string();
  const auto held = drivers::open_modbus(parsed<config::RtuConnection>(rtu), 1, clock_);
  ASSERT_TRUE(held) << held.error().message;
  const auto begun = std::chrono::steady_clock::now();
  const Finished daemon = second({"--bench", path, "--store", store()});
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 10s);
  EXPECT_EQ(daemon.status, 4);
  EXPECT_THAT(daemon.err, HasSubstr("coil_horizontal: serial line " + line + " " +
                                    held_by(getpid(), "system_test")));
}

}  // namespace
}  // namespace fogbench::system_tests
