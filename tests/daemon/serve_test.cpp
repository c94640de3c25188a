#include "daemon/serve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <thread>

#include "daemon/resumption.hpp"
#include "drivers/file_descriptor.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using namespace std::chrono_literals;

/// Waits for the daemon, asks, and returns its answer.
std::string ask(const std::string& path, const std::string& method, const std::string& parameters) {
  const drivers::FileDescriptor client(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  while (connect(client.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    std::this_thread::sleep_for(10ms);
  }
  const std::string line =
      R"({"jsonrpc":"2.0","id":1,"method":")" + method + R"(","params":)" + parameters + "}\n";
  (void)send(client.get(), line.data(), line.size(), MSG_NOSIGNAL);
  std::string answer;
  char buffer[4096];
  while (answer.find('\n') == std::string::npos) {
    const ssize_t count = recv(client.get(), buffer, sizeof buffer, 0);
    if (count <= 0) break;
    answer.append(buffer, static_cast<std::size_t>(count));
  }
  return answer;
}

TEST(ServeDeathTest, AnAbortThatAnInstrumentHoldsUpIsForcedWhenItsTimeIsOver) {
  const auto ready = tests::source_tree() / "config";
  const auto setup = load_setup(
      {(ready / "benches/simulated.json").string(), (ready / "scenarios/clean.json").string()});
  ASSERT_TRUE(setup) << setup.error().message;
  const support::TemporaryFolder folder;
  const auto store = folder / "store.db";
  const auto socket = (folder / "s").string();
  // The call comes back when the turntable has arrived, 20 s of the bench later.
  const auto file = folder.file(
      "turn.json", R"({"name": "turn", "steps": [{"step": "rotate", "azimuth_deg": 90}]})");
  const auto serve_and_abort = [&] {
    dup2(STDERR_FILENO, STDOUT_FILENO);  // where a test's log goes
    std::thread([&] {
      ask(socket, "run", R"({"procedure":")" + file.string() + "\"}");
      while (ask(socket, "status", "{}").find("90 deg") == std::string::npos) {
        std::this_thread::sleep_for(10ms);
      }
      ask(socket, "abort", "{}");
    }).detach();  // what serves ends the process
    ServeOptions options;
    options.socket = socket;
    options.abort_time = 300ms;
    const Status ended = serve(*setup, 1, store, Speed{10.0}, options);
    _exit(ended ? 0 : 1);
  };
  EXPECT_EXIT(serve_and_abort(), testing::ExitedWithCode(4),
              "no safe state within 0.3 s of the abort: ending at once, the bench is NOT in its "
              "safe state; a new start begins with it\n$");
  const auto log = record::RunLogReader::open(store);
  ASSERT_TRUE(log) << log.error().message;
  const auto left = interrupted_runs(**log, *setup);
  ASSERT_TRUE(left && left->size() == 1) << "the next start offers it";
  EXPECT_EQ(left->front().run, 1);
}

}  // namespace
}  // namespace fogbench::daemon
