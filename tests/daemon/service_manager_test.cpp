// The messages as systemd receives them: this test is at the other end of the notification socket.

#include "daemon/service_manager.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <map>
#include <sstream>

#include "config/exit_status.hpp"
#include "daemon/control_server.hpp"
#include "daemon/serve.hpp"
#include "drivers/file_descriptor.hpp"
#include "procedures/bench_watch.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

class ServiceManagerTest : public testing::Test {
 protected:
  ServiceManagerTest() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    const std::string path = (folder_ / "notify").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    // NOLINTBEGIN(concurrency-mt-unsafe)
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    setenv("WATCHDOG_USEC", "8000000", 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  }
  ~ServiceManagerTest() override {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
    // NOLINTEND(concurrency-mt-unsafe)
  }

  std::vector<std::string> told() const {
    std::vector<std::string> messages;
    char buffer[1024];
    for (ssize_t count = 0; (count = recv(socket_.get(), buffer, sizeof buffer, 0)) >= 0;) {
      messages.emplace_back(buffer, static_cast<std::size_t>(count));
    }
    return messages;
  }
  /// What is told when a second has passed.
  std::vector<std::string> told_after_a_second(ServiceManager& manager) {
    clock_.sleep_for(1s);
    manager.report(desk_);
    return told();
  }
  /// The bench's thread takes a job and goes as far as its first step.
  void begin_a_run() {
    PlannedProcedure procedure;
    procedure.plan.procedure = "sweep";
    procedure.plan.steps.resize(4);
    desk_.enqueue({}, procedure, {"alice", 1000});
    ASSERT_TRUE(desk_.next_job().has_value());
    advance();
  }
  void advance() {
    desk_.progressed({procedures::RunState::kRunning, 1, 4, "average", config::Seconds{10},
                      config::Seconds{90}});
  }

  support::TemporaryFolder folder_;
  drivers::FileDescriptor socket_;
  drivers::VirtualClock clock_;
  RunDesk desk_;
};

TEST_F(ServiceManagerTest, SaysThatItIsReadyAndWhatItDoes) {
  ServiceManager manager(clock_);
  manager.ready();
  EXPECT_THAT(told(), ElementsAre("READY=1"));
  begin_a_run();
  desk_.run_begun(7);
  EXPECT_THAT(told_after_a_second(manager),
              Contains("STATUS=run 7, sweep: running, step 2 of 4, 1 min 30 s left"));
  EXPECT_THAT(told_after_a_second(manager), Not(Contains(testing::StartsWith("STATUS="))));
  desk_.ask("Turn\nit.");
  EXPECT_THAT(told_after_a_second(manager),
              Contains(testing::AllOf(testing::EndsWith("left; asks: Turn?it."),
                                      testing::StartsWith("STATUS=run 7"))));
}

TEST_F(ServiceManagerTest, FeedsTheWatchdogOnlyWhileTheBenchAdvances) {
  ServiceManager manager(clock_);
  begin_a_run();
  EXPECT_THAT(told_after_a_second(manager), Contains("WATCHDOG=1"));
  for (int i = 0; i < 20; ++i) {
    EXPECT_THAT(told_after_a_second(manager), Not(Contains("WATCHDOG=1")))
        << "the bench's thread hangs, the clients' does not";
  }
  advance();
  EXPECT_THAT(told_after_a_second(manager), ElementsAre("WATCHDOG=1"));
  manager.report(desk_);
  EXPECT_THAT(told(), IsEmpty()) << "not a second later";
}

TEST_F(ServiceManagerTest, AnAbortHasADeadlineOfItsOwn) {
  ServiceManager manager(clock_);
  begin_a_run();
  told_after_a_second(manager);
  EXPECT_THAT(told_after_a_second(manager), Not(Contains("WATCHDOG=1")));
  desk_.close({"SIGTERM", 0});
  EXPECT_THAT(told_after_a_second(manager), testing::IsSupersetOf({"STOPPING=1", "WATCHDOG=1"}));
  EXPECT_THAT(told_after_a_second(manager), ElementsAre("WATCHDOG=1"));
}

TEST_F(ServiceManagerTest, SaysNothingOfAWatchdogThatIsOff) {
  unsetenv("WATCHDOG_USEC");  // NOLINT(concurrency-mt-unsafe)
  ServiceManager manager(clock_);
  EXPECT_THAT(told_after_a_second(manager), ElementsAre("STATUS=idle"));
}

// What the unit says must leave room for what the daemon promises.
TEST(ServiceUnit, AgreesWithTheDaemon) {
  std::map<std::string, std::string> unit;
  std::istringstream lines(
      support::read_text(tests::source_tree() / "config/systemd/fogbenchd.service"));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find('=');
    if (equals != std::string::npos) unit[line.substr(0, equals)] = line.substr(equals + 1);
  }
  EXPECT_EQ(unit["Type"], "notify");
  EXPECT_GT(std::stoi(unit["TimeoutStopSec"]), kAbortTime.count()) << "no kill during an abort";
  EXPECT_GT(std::stoi(unit["WatchdogSec"]), procedures::BenchWatch::kLongestOutage.count())
      << "a silent instrument is the engine's business";
  EXPECT_GE(std::stoul(unit["LimitNOFILE"]), 2 * ControlServer::kMostConnections);
  EXPECT_EQ(unit["RestartPreventExitStatus"],
            fmt::format("{} {}", static_cast<int>(ExitStatus::kUsage),
                        static_cast<int>(ExitStatus::kBadInput)));
}

}  // namespace
}  // namespace fogbench::daemon
