// The server against clients that mean no good: one thread plays both ends, and the clock jumps.

#include "daemon/control_server.hpp"

#include <gmock/gmock.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>

#include "daemon/control_socket.hpp"
#include "daemon/json_rpc.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;

/// Says the line again; "big" is answered with 10 kB, "watch" subscribes.
class Echo final : public ControlService {
 public:
  std::string answer(std::string_view line, Caller& caller) override {
    ++answered;
    if (line == "watch") caller.subscription = Subscription{seconds{1}, {}, {}, {}};
    return line == "big" ? std::string(10'000, 'x') + '\n' : std::string(line) + '\n';
  }
  std::string news(Caller&) override {
    ++told;
    return "news " + std::string(news_bytes, '!') + '\n';
  }
  std::size_t answered = 0, told = 0, news_bytes = 10;
};

class ControlServerTest : public testing::Test {
 protected:
  using Client = std::unique_ptr<drivers::FileDescriptor>;

  ControlServerTest() {
    chmod(folder_.path().c_str(), 0755);
    auto socket = ControlSocket::open(folder_ / "s", 0666);
    EXPECT_TRUE(socket) << socket.error().message;
    socket_ = std::move(*socket);
    server_ = std::make_unique<ControlServer>(socket_->descriptor(), wake_.get(),
                                              AccessRules{geteuid(), {}, {}}, echo_, clock_);
  }

  Client connect() const {
    auto client = std::make_unique<drivers::FileDescriptor>(
        socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket_->name().copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::connect(client->get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0)
        << errno;
    return client;
  }
  static std::size_t say(const Client& client, const std::string& text) {
    const ssize_t sent = send(client->get(), text.data(), text.size(), MSG_NOSIGNAL);
    return sent < 0 ? 0 : static_cast<std::size_t>(sent);
  }
  void serve(int rounds = 5) {
    for (int i = 0; i < rounds; ++i) server_->serve_once();
  }
  /// All that has come.
  static std::string heard(const Client& client) {
    std::string text;
    char buffer[65536];
    for (ssize_t count = 1; count > 0;) {
      count = recv(client->get(), buffer, sizeof buffer, 0);
      if (count > 0) text.append(buffer, static_cast<std::size_t>(count));
    }
    return text;
  }
  static bool closed(const Client& client) {
    char byte;
    return recv(client->get(), &byte, 1, 0) == 0 || errno == ECONNRESET;
  }
  std::string ask(const Client& client, const std::string& line) {
    say(client, line + '\n');
    serve();
    return heard(client);
  }

  support::TemporaryFolder folder_;
  Echo echo_;
  drivers::VirtualClock clock_;
  drivers::FileDescriptor wake_{eventfd(1, EFD_CLOEXEC)};  // always readable: no round waits
  std::unique_ptr<ControlSocket> socket_;
  std::unique_ptr<ControlServer> server_;
};

TEST_F(ControlServerTest, AnswersLinesInTheirOrderHoweverTheyAreCut) {
  const Client client = connect();
  serve();
  std::string heard_so_far;
  for (const char byte : std::string("one\n\ntwo\nthree\n")) {
    say(client, std::string(1, byte));
    serve(1);
    heard_so_far += heard(client);
  }
  EXPECT_EQ(heard_so_far, "one\ntwo\nthree\n");
  EXPECT_EQ(ask(client, "four\nfive"), "four\nfive\n");
}

TEST_F(ControlServerTest, HalfALineIsDroppedInTheEndAndAnIdleClientIsNot) {
  const Client half = connect(), idle = connect();
  EXPECT_EQ(ask(idle, "hello"), "hello\n");
  say(half, "{\"jsonrpc\":");
  serve();
  clock_.sleep_for(seconds{9});
  serve();
  EXPECT_EQ(server_->connections(), 2U);
  // A byte now and then does not help.
  say(half, "2");
  clock_.sleep_for(seconds{2});
  serve();
  EXPECT_EQ(server_->connections(), 1U);
  EXPECT_TRUE(closed(half));
  clock_.sleep_for(std::chrono::hours{10});
  EXPECT_EQ(ask(idle, "still here"), "still here\n");
}

TEST_F(ControlServerTest, AHugeLineIsAnErrorAndTheEnd) {
  const Client longest = connect(), huge = connect();
  const std::string fits(kLongestRequest - 1, 'a');
  EXPECT_EQ(ask(longest, fits), fits + '\n');

  std::size_t sent = 0;
  for (int i = 0; i < 200; ++i) {
    sent += say(huge, std::string(65536, 'a'));
    serve(2);
  }
  EXPECT_LT(sent, std::size_t{1} << 20) << "the rest was never taken";
  EXPECT_THAT(heard(huge), HasSubstr("-32007"));
  EXPECT_TRUE(closed(huge));
  EXPECT_EQ(echo_.answered, 1U);
  const Client one_more = connect();
  EXPECT_THAT(ask(one_more, std::string(kLongestRequest, 'a')), HasSubstr("-32007"));
  EXPECT_EQ(ask(longest, "and you?"), "and you?\n");
}

TEST_F(ControlServerTest, AClientThatNeverReadsIsHeldThenDropped) {
  const Client deaf = connect(), other = connect();
  for (int i = 0; i < 500; ++i) {
    say(deaf, "big\nbig\nbig\nbig\n");
    serve(1);
  }
  // What the kernel's buffers take, and then kMostUnread.
  EXPECT_LT(echo_.answered, 100U);
  EXPECT_EQ(ask(other, "hello"), "hello\n");
  clock_.sleep_for(seconds{9});
  serve();
  EXPECT_EQ(server_->connections(), 2U);
  clock_.sleep_for(seconds{2});
  serve();
  EXPECT_EQ(server_->connections(), 1U);
  EXPECT_EQ(ask(other, "hello"), "hello\n");
}

TEST_F(ControlServerTest, ASlowReaderGetsEveryAnswerInTheEnd) {
  const Client slow = connect();
  std::size_t asked = 0, read = 0;
  for (int i = 0; i < 3000; ++i) {
    if (i < 1000) asked += say(slow, "big\n") == 4 ? 1 : 0;
    serve(1);
    char buffer[4096];
    const ssize_t count = recv(slow->get(), buffer, sizeof buffer, 0);
    if (count > 0) read += static_cast<std::size_t>(count);
    clock_.sleep_for(std::chrono::milliseconds{100});
  }
  while (echo_.answered < asked) {
    serve(1);
    read += heard(slow).size();
  }
  serve();
  read += heard(slow).size();
  EXPECT_GT(asked, 100U);
  EXPECT_EQ(read, asked * 10'001);
}

TEST_F(ControlServerTest, NewsComeWhenTheyAreDueAndOneAtATime) {
  const Client client = connect();
  EXPECT_EQ(ask(client, "watch"), "watch\nnews !!!!!!!!!!\n");
  serve();
  EXPECT_EQ(echo_.told, 1U);
  clock_.sleep_for(seconds{1});
  serve();
  EXPECT_EQ(heard(client), "news !!!!!!!!!!\n");
  // It reads no more: one piece of news is kept, the others are never made.
  echo_.news_bytes = 1'000'000;
  for (int i = 0; i < 5; ++i) {
    clock_.sleep_for(seconds{1});
    serve();
  }
  EXPECT_EQ(echo_.told, 3U);
  clock_.sleep_for(seconds{11});
  serve();
  EXPECT_EQ(server_->connections(), 0U);
}

TEST_F(ControlServerTest, ThereAreOnlySoManyConnections) {
  const rlimit enough{8192, 8192};
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit raised{std::max(before.rlim_cur, enough.rlim_cur),
                      std::max(before.rlim_max, enough.rlim_max)};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &raised), 0);
  std::vector<Client> crowd;
  for (std::size_t i = 0; i < ControlServer::kMostConnections; ++i) {
    crowd.push_back(connect());
    if (i % 50 == 0) serve(1);
  }
  serve(100);
  EXPECT_EQ(server_->connections(), ControlServer::kMostConnections);
  const Client late = connect();
  serve();
  EXPECT_THAT(heard(late), HasSubstr("-32008"));
  EXPECT_TRUE(closed(late));
  EXPECT_EQ(ask(crowd.front(), "still"), "still\n");
  crowd.pop_back();
  serve();
  const Client next = connect();
  EXPECT_EQ(ask(next, "room"), "room\n");
  setrlimit(RLIMIT_NOFILE, &before);
}

TEST_F(ControlServerTest, WithoutFileHandlesWhoIsHereIsServedAndTheOthersWait) {
  const Client here = connect();
  EXPECT_EQ(ask(here, "hello"), "hello\n");
  const Client late = connect();
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const int lowest_free = dup(wake_.get());
  close(lowest_free);
  const auto limit_to = [&](int handles) {
    const rlimit limit{static_cast<rlim_t>(handles), before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &limit), 0);
  };
  limit_to(lowest_free);
  EXPECT_EQ(ask(here, "still"), "still\n");
  EXPECT_EQ(ask(late, "me?"), "");
  // The kernel polls no more files than there may be.
  limit_to(1);
  const auto begun = clock_.now();
  serve(1);
  EXPECT_GT(clock_.now(), begun) << "it waits before it tries again";
  setrlimit(RLIMIT_NOFILE, &before);
  clock_.sleep_for(seconds{1});
  serve();
  EXPECT_EQ(heard(late), "me?\n");
  EXPECT_EQ(server_->connections(), 2U);
}

TEST_F(ControlServerTest, AUserWhoMayNotActHasFewerConnections) {
  // For the server this user is a stranger; root never is, and becomes one for the moment.
  server_ = std::make_unique<ControlServer>(socket_->descriptor(), wake_.get(),
                                            AccessRules{geteuid() + 1, {}, {}}, echo_, clock_);
  const bool root = geteuid() == 0;
  if (root) {
    ASSERT_EQ(seteuid(65534), 0);
  }
  std::vector<Client> crowd;
  for (std::size_t i = 0; i < ControlServer::kMostPerUser; ++i) crowd.push_back(connect());
  const Client late = connect();
  if (root) {
    ASSERT_EQ(seteuid(0), 0);
  }
  serve();
  EXPECT_EQ(server_->connections(), ControlServer::kMostPerUser);
  EXPECT_THAT(heard(late), HasSubstr("this user has 100 connections"));
  EXPECT_TRUE(closed(late));
}

}  // namespace
}  // namespace fogbench::daemon
