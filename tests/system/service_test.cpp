// What a packager and a service manager see of the real programs: the manual and the completion
// against --help, an installed tree, and systemd's end of the notification socket.

#include <fmt/format.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
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
  /// What bash offers after this line, by the program's own completion.
  std::set<std::string> offered(const std::string& program, const std::string& line) const {
    const std::string script = fmt::format(
        "PATH={0}:$PATH; source <({1} --completion) && COMP_WORDS=({1} {2}) && "
        "COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)) && _{1} && "
        "printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        tests::build_tree().string(), program, line);
    const Finished done = support::run({"/bin/bash", "-c", script});
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_EQ(done.err, "") << line;
    std::set<std::string> words;
    std::istringstream lines(done.out);
    for (std::string word; std::getline(lines, word);) words.insert(word);
    return words;
  }
  /// Holds the page and the completion of a command, and of those below it, to its --help.
  void expect_described(const std::string& program, const std::string& name,
                        const std::string& page) {
    std::vector<std::string> words;
    std::istringstream parts(name);
    for (std::string part; parts >> part;) words.push_back(part);
    words.emplace_back("--help");
    const Finished help = support::run(command(words, program));
    ASSERT_EQ(help.status, 0) << name;
    // Up to the next command's heading.
    std::string section = page;
    if (!name.empty()) {
      std::string heading = fmt::format(".SS \"{} {}\"", program, name);
      heading = std::regex_replace(heading, std::regex("-"), "\\-");
      const std::size_t begin = page.find(heading);
      ASSERT_NE(begin, std::string::npos) << heading;
      section = page.substr(begin, page.find("\n.S", begin) - begin);
    }
    const auto options = listed(help.out, "Options:");
    EXPECT_TRUE(options.contains("--help")) << help.out;
    std::set<std::string> offers = offered(program, name + " -");
    for (const std::string& option : options) {
      EXPECT_TRUE(offers.contains(option)) << program << " " << name << " " << option;
      const std::string roff = std::regex_replace(option, std::regex("-"), "\\-");
      EXPECT_NE(section.find(roff), std::string::npos) << program << " " << name << " " << option;
    }
    const auto commands = listed(help.out, "Subcommands:");
    if (!commands.empty()) offers = offered(program, name + " ''");
    for (const std::string& below : commands) {
      EXPECT_TRUE(offers.contains(below)) << name << " " << below;
      expect_described(program, name.empty() ? below : name + " " + below, page);
      ++described_;
    }
  }

  int described_ = 0;
};

TEST_F(ServiceTest, ManualAndCompletionLeaveNothingOut) {
  for (const std::string program : {"fogbench", "fogbenchd"}) {
    const Finished page = support::run(command({"--manual"}, program));
    ASSERT_EQ(page.status, 0) << page.err;
    expect_described(program, "", page.out);
  }
  EXPECT_GE(described_, 26) << "the commands were not found in --help";
  EXPECT_EQ(fogbench({"--manual", "--completion"}).status, 2);
  EXPECT_EQ(fogbench({"plan", "coil-sweep", "--manual"}).status, 2);
}

TEST_F(ServiceTest, CompletionOffersReadyFilesAndChoices) {
  using Words = std::set<std::string>;
  EXPECT_EQ(offered("fogbench", "pl"), Words{"plan"});
  EXPECT_EQ(offered("fogbench", "run coil"), Words{"coil-sweep"});
  EXPECT_EQ(offered("fogbench", "dry-run coil-sweep --bench simulated-"), Words{"simulated-1khz"});
  EXPECT_EQ(offered("fogbench", "device ''"), (Words{"check", "probe"}));
  EXPECT_EQ(offered("fogbench", "answer ''"), (Words{"no", "yes"}));
  EXPECT_EQ(offered("fogbench", "fit 7 -o fit"), Words{""}) << "a file's name is bash's own";
  EXPECT_EQ(offered("fogbenchd", "--scenario hyst"), Words{"hysteresis-z"});
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
                                     "--store", store(), "--json"});
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
