// What a packager and a service manager see of the real programs: the manual and the completion
// against --help, an installed tree, and systemd's end of the notification socket.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <iterator>
#include <regex>
#include <set>
#include <thread>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class ServiceTest : public FogbenchTest {
 protected:
  /// Everything that begins an indented line below `heading`, as CLI11 prints its lists.
  static std::set<std::string> listed(const std::string& help, const std::string& heading) {
    std::set<std::string> words;
    const std::size_t begin = help.find("\n" + heading + "\n");
    if (begin == std::string::npos) return words;
    std::istringstream lines(help.substr(begin + 1));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line) && line.starts_with("  ")) {
      static const std::regex kWord("^  ([^ ]+).*");
      std::smatch match;
      if (!std::regex_match(line, match, kWord)) continue;
      std::istringstream names(match[1]);
      for (std::string name; std::getline(names, name, ',');) words.insert(name);
    }
    return words;
  }
  /// What bash offers after each of these lines, by the program's own completion.
  static std::vector<std::set<std::string>> offered(const std::string& program,
                                                    const std::vector<std::string>& lines) {
    std::string script = fmt::format("PATH='{0}':$PATH; source <({1} --completion) || exit\n",
                                     tests::build_tree().string(), program);
    for (const std::string& line : lines) {
      script += fmt::format(
          "COMP_WORDS=({0} {1}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _{0}; "
          "printf '%s ' \"${{COMPREPLY[@]}}\"; echo\n",
          program, line);
    }
    const Finished done = support::run({"/bin/bash", "-c", script});
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_EQ(done.err, "");
    std::vector<std::set<std::string>> all;
    std::istringstream answers(done.out);
    for (std::string answer; std::getline(answers, answer);) {
      std::istringstream words(answer);
      all.emplace_back(std::istream_iterator<std::string>(words),
                       std::istream_iterator<std::string>());
    }
    EXPECT_EQ(all.size(), lines.size());
    all.resize(lines.size());
    return all;
  }

  struct Command {
    std::string name;  ///< empty for the program itself
    std::set<std::string> options, commands;
  };
  /// What --help says of a command and of those below it.
  static void ask(const std::string& program, const std::string& name,
                  std::vector<Command>& commands) {
    std::istringstream parts(name);
    std::vector<std::string> words(std::istream_iterator<std::string>(parts), {});
    words.emplace_back("--help");
    const Finished help = support::run(command(words, program));
    EXPECT_EQ(help.status, 0) << name;
    const Command asked{name, listed(help.out, "Options:"), listed(help.out, "Subcommands:")};
    EXPECT_TRUE(asked.options.contains("--help")) << help.out;
    commands.push_back(asked);
    for (const std::string& below : asked.commands) {
      ask(program, name.empty() ? below : name + " " + below, commands);
    }
  }
  static std::string roff(const std::string& text) {
    return std::regex_replace(text, std::regex("-"), "\\-");
  }
};

TEST_F(ServiceTest, ManualAndCompletionLeaveNothingOut) {
  std::size_t described = 0;
  for (const std::string program : {"fogbench", "fogbenchd"}) {
    const Finished page = support::run(command({"--manual"}, program));
    ASSERT_EQ(page.status, 0) << page.err;
    std::vector<Command> commands;
    ask(program, "", commands);
    described += commands.size();
    std::vector<std::string> lines;
    for (const Command& one : commands) {
      lines.push_back(one.name + " -");
      lines.push_back(one.name + " ''");
    }
    const auto offers = offered(program, lines);
    for (std::size_t i = 0; i < commands.size(); ++i) {
      const Command& one = commands[i];
      EXPECT_THAT(offers[2 * i], testing::IsSupersetOf(one.options)) << program << " " << one.name;
      EXPECT_THAT(offers[2 * i + 1], testing::IsSupersetOf(one.commands)) << one.name;
      // Up to the next command's heading.
      std::string section = page.out;
      if (!one.name.empty()) {
        const std::size_t begin = page.out.find(roff(fmt::format(".SS \"fogbench {}\"", one.name)));
        ASSERT_NE(begin, std::string::npos) << one.name;
        section = page.out.substr(begin, page.out.find("\n.S", begin) - begin);
      }
      for (const std::string& option : one.options) {
        EXPECT_THAT(section, testing::HasSubstr(roff(option))) << program << " " << one.name;
      }
    }
  }
  EXPECT_GE(described, 28U) << "the commands were not found in --help";
  EXPECT_EQ(fogbench({"--manual", "--completion"}).status, 2);
  EXPECT_EQ(fogbench({"plan", "coil-sweep", "--manual"}).status, 2);
}

TEST_F(ServiceTest, CompletionOffersReadyFilesAndChoices) {
  using Words = std::set<std::string>;
  const std::vector<std::pair<std::string, Words>> expected{
      {"pl", {"plan"}},
      {"run coil", {"coil-sweep"}},
      {"dry-run coil-sweep --bench simulated-1", {"simulated-1khz"}},
      {"device ''", {"check", "probe"}},
      {"answer ''", {"no", "yes"}},
      {"verdict 1 --limits acc", {"acceptance"}},
      {"device check coil-", {"coil-kepco"}},
      {"effects warm", {"warm_up"}},
      {"add magnetic_hysteresis_",
       {"magnetic_hysteresis_x", "magnetic_hysteresis_y", "magnetic_hysteresis_z"}},
      {"plan coil-sweep --set lev", {"levels_ut="}},
      {"help expr", {"expressions"}},
      {"show ''", {}},       // there is no run log
      {"fit 7 -o fit", {}},  // a file's name is bash's own
      {"fit '$(exit 1)' --mod", {"--model"}}};
  std::vector<std::string> lines;
  for (const auto& [line, words] : expected) lines.push_back(line);
  const auto offers = offered("fogbench", lines);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(offers[i], expected[i].second) << expected[i].first;
  }
  EXPECT_EQ(offered("fogbenchd", {"--scenario hyst"}).front(), Words{"hysteresis-z"});
}

// Ready files are found from where the program is, and nothing of the build tree is needed.
TEST_F(ServiceTest, RunsWhereItIsInstalled) {
  const std::string root = (folder_ / "root").string();
  const Finished installed = support::run(
      {"/usr/bin/cmake", "--install", tests::build_tree().string(), "--prefix", "/usr"},
      {{"DESTDIR=" + root}, {}});
  ASSERT_EQ(installed.status, 0) << installed.err;
  const std::string program = root + "/usr/bin/fogbench";
  const Finished ran = support::run({program, "dry-run", "static-record", "--set", "duration_s=10",
                                     "--set", "average_s=5", "--store", store(), "--json"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(support::run({root + "/usr/sbin/fogbenchd", "--version"}).status, 0);
  for (const char* file :
       {"usr/share/man/man1/fogbench.1.gz", "usr/share/man/man8/fogbenchd.8.gz",
        "usr/share/bash-completion/completions/fogbench",
        "usr/lib/systemd/system/fogbenchd.service", "usr/lib/sysusers.d/fogbench.conf",
        "usr/lib/udev/rules.d/60-fogbench.rules", "usr/share/doc/fogbench/protocol.md",
        "etc/default/fogbenchd"}) {
    EXPECT_GT(fs::file_size(fs::path(root) / file), 0U) << file;
  }
}

/// systemd's end of NOTIFY_SOCKET.
class Notifications {
 public:
  explicit Notifications(const fs::path& path)
      : path_(path), socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  Notifications(const Notifications&) = delete;
  Notifications& operator=(const Notifications&) = delete;
  ~Notifications() { close(socket_); }

  /// Whether a message that begins so comes within that time; the others are thrown away.
  bool comes(const std::string& message, std::chrono::milliseconds within) {
    const auto until = std::chrono::steady_clock::now() + within;
    for (auto left = within; left > 0ms;) {
      const timeval wait{left.count() / 1000, left.count() % 1000 * 1000};
      setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
      char buffer[1024];
      const ssize_t count = recv(socket_, buffer, sizeof buffer, 0);
      if (count > 0 && std::string(buffer, static_cast<std::size_t>(count)).starts_with(message)) {
        return true;
      }
      left = std::chrono::duration_cast<std::chrono::milliseconds>(
          until - std::chrono::steady_clock::now());
    }
    return false;
  }
  void forget() {
    char buffer[1024];
    while (recv(socket_, buffer, sizeof buffer, MSG_DONTWAIT) >= 0) continue;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  int socket_;
};

/// The thread of that name.
pid_t thread_of(pid_t process, const std::string& name) {
  for (const auto& task : fs::directory_iterator(fmt::format("/proc/{}/task", process))) {
    if (support::read_text(task.path() / "comm") == name + "\n") {
      return std::stoi(task.path().filename().string());
    }
  }
  return 0;
}

TEST_F(ServiceTest, AHungInstrumentStarvesTheWatchdogAlthoughClientsAreServed) {
  Notifications systemd(folder_ / "notify");
  setenv("FOGBENCH_SOCKET", (folder_ / "control.sock").c_str(), 1);
  const fs::path metrics = folder_ / "fogbench.prom";
  Process daemon(command({"--bench", "simulated", "--speed", "20", "--store", store(), "--metrics",
                          metrics.string()},
                         "fogbenchd"),
                 {{"NOTIFY_SOCKET=" + systemd.path().string(), "WATCHDOG_USEC=4000000"}, {}});
  ASSERT_TRUE(systemd.comes("READY=1", 30s));
  EXPECT_EQ(fogbench({"status"}).status, 0) << "ready means served";
  EXPECT_TRUE(systemd.comes("WATCHDOG=1", 10s)) << "nothing to do is no reason to starve";
  EXPECT_NE(support::read_text(metrics).find("\nfogbench_up 1\n"), std::string::npos);
  ASSERT_EQ(fogbench({"run", "static-record"}).status, 0);
  ASSERT_TRUE(systemd.comes("STATUS=run 1, ", 30s));
  EXPECT_TRUE(systemd.comes("WATCHDOG=1", 10s));

  // A call that never returns, as far as the rest of the process can tell.
  const pid_t bench = thread_of(daemon.id(), "bench");
  ASSERT_GT(bench, 0);
  ASSERT_EQ(ptrace(PTRACE_SEIZE, bench, nullptr, nullptr), 0) << std::strerror(errno);
  ASSERT_EQ(ptrace(PTRACE_INTERRUPT, bench, nullptr, nullptr), 0);
  ASSERT_EQ(waitpid(bench, nullptr, __WALL), bench);
  systemd.comes("WATCHDOG=1", 1100ms);  // of what it did before
  systemd.forget();
  EXPECT_FALSE(systemd.comes("WATCHDOG=1", 2s));
  EXPECT_EQ(fogbench({"status"}).status, 0);
  ASSERT_EQ(ptrace(PTRACE_DETACH, bench, nullptr, nullptr), 0);
  EXPECT_TRUE(systemd.comes("WATCHDOG=1", 10s));

  daemon.signal(SIGTERM);
  EXPECT_TRUE(systemd.comes("STOPPING=1", 10s));
  EXPECT_EQ(daemon.wait(30s).status, 0);
  EXPECT_FALSE(fs::exists(metrics));
  unsetenv("FOGBENCH_SOCKET");
}

}  // namespace
}  // namespace fogbench::system_tests
