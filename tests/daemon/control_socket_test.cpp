#include "daemon/control_socket.hpp"

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using testing::HasSubstr;

class ControlSocketTest : public testing::Test {
 protected:
  mode_t mode() const {
    struct stat there {};
    EXPECT_EQ(stat(path().c_str(), &there), 0);
    return there.st_mode & 0777U;
  }
  std::filesystem::path path() const { return folder_ / "control.sock"; }

  support::TemporaryFolder folder_;
};

TEST_F(ControlSocketTest, HasTheModeThatIsAskedForAndLeavesNoName) {
  for (const mode_t wanted : {0600U, 0666U}) {
    const auto socket = ControlSocket::open(path(), wanted);
    ASSERT_TRUE(socket) << socket.error().message;
    EXPECT_EQ(mode(), wanted);
    EXPECT_EQ((*socket)->name(), path().string());
  }
  EXPECT_FALSE(std::filesystem::exists(path()));
}

TEST_F(ControlSocketTest, ASecondDaemonIsRefusedAndTheFirstStays) {
  const auto first = ControlSocket::open(path(), 0600);
  ASSERT_TRUE(first);
  const auto second = ControlSocket::open(path(), 0600);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kHeld);
  EXPECT_EQ(second.error().message,
            "control socket " + path().string() + " is held by this program already");
  EXPECT_TRUE(std::filesystem::exists(path()));
}

TEST_F(ControlSocketTest, WhatADeadDaemonLeftIsReplaced) {
  const drivers::FileDescriptor dead(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path().string().copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(dead.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_TRUE(ControlSocket::open(path(), 0600));
}

TEST_F(ControlSocketTest, AFileThatIsNoSocketIsLeftAlone) {
  folder_.file("control.sock", "precious");
  const auto socket = ControlSocket::open(path(), 0600);
  ASSERT_FALSE(socket);
  EXPECT_THAT(socket.error().message, HasSubstr("no socket"));
  EXPECT_EQ(support::read_text(path()), "precious");
}

TEST_F(ControlSocketTest, PathsThatCannotBeServedAreOneLine) {
  const auto missing = ControlSocket::open(folder_ / "no/such.sock", 0600);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kDevice);
  EXPECT_THAT(missing.error().message, HasSubstr("no/such.sock"));
  const auto longest = ControlSocket::open(folder_ / std::string(108, 'x'), 0600);
  ASSERT_FALSE(longest);
  EXPECT_EQ(longest.error().code, ErrorCode::kBadInput);
  EXPECT_FALSE(check_socket_path(""));
}

TEST(InheritedSocket, ThereIsNoneWithoutSystemd) {
  unsetenv("LISTEN_PID");
  auto inherited = ControlSocket::inherited();
  ASSERT_TRUE(inherited);
  EXPECT_EQ(*inherited, nullptr);
  // Left by a parent that was given one itself.
  setenv("LISTEN_PID", "1", 1);
  setenv("LISTEN_FDS", "1", 1);
  inherited = ControlSocket::inherited();
  ASSERT_TRUE(inherited);
  EXPECT_EQ(*inherited, nullptr);
  setenv("LISTEN_PID", std::to_string(getpid()).c_str(), 1);
  setenv("LISTEN_FDS", "2", 1);
  EXPECT_FALSE(ControlSocket::inherited());
  unsetenv("LISTEN_PID");
  unsetenv("LISTEN_FDS");
}

TEST(SocketPaths, FollowTheEnvironment) {
  const support::TemporaryFolder runtime;
  unsetenv("FOGBENCH_SOCKET");
  unsetenv("RUNTIME_DIRECTORY");
  setenv("XDG_RUNTIME_DIR", runtime.path().c_str(), 1);
  EXPECT_EQ(socket_to_ask(), "/run/fogbench/control.sock") << "no daemon of the user's own";
  const auto own = runtime.path() / "fogbench/control.sock";
  {
    const auto served = ControlSocket::open(own, 0600);  // makes the folder
    ASSERT_TRUE(served) << served.error().message;
    EXPECT_EQ(socket_to_ask(), own);
  }
  const auto standard = socket_to_serve();
  ASSERT_TRUE(standard);
  EXPECT_EQ(*standard, geteuid() == 0 ? "/run/fogbench/control.sock" : own);
  setenv("RUNTIME_DIRECTORY", "/run/there", 1);
  EXPECT_EQ(*socket_to_serve(), "/run/there/control.sock");
  setenv("FOGBENCH_SOCKET", "/named", 1);
  EXPECT_EQ(*socket_to_serve(), "/named");
  EXPECT_EQ(socket_to_ask(), "/named");
  unsetenv("FOGBENCH_SOCKET");
  unsetenv("RUNTIME_DIRECTORY");
  unsetenv("XDG_RUNTIME_DIR");
}

}  // namespace
}  // namespace fogbench::daemon
