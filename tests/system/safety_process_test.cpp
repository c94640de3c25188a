// The safety matrix with the real daemon, in real time, its instruments on serial lines, TCP and a
// stand-in for the kernel's hidraw: what a test in one process cannot show are signals, deaths,
// restarts and what the last words of a process reach. The far ends are a process of their own and
// keep what was energised. Whatever happens: within kBound every supply that can be reached was
// told 0 A, asked what it carries, and carries nothing; the heaters are off; and the log says how
// far each actuator came.
//
// A row is printed for each situation: a letter for each fault, '.' all off, 'u' all but what is
// unreachable, 'c' all but what cannot confirm it, '-' that fault does not let a run begin.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <functional>
#include <thread>

#include "tests/system/far_bench/client.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;
using far_bench::FarBench;
using support::Finished;
using support::Process;
using SteadyClock = std::chrono::steady_clock;
namespace fs = std::filesystem;

/// From the signal, or the start of the process, to the safe state: a serial line that is silent
/// holds up each round of it for two seconds.
constexpr std::chrono::seconds kBound{5};
/// An engine that was asking a supply that has just fallen silent does so twice, 1 s each, and
/// listens for 0.5 s and asks for the error queue, 1 s, after each: it hears of a signal then.
constexpr std::chrono::seconds kAskedInVain{5};
/// From one point to the next in the energising procedure: when a full disk is noticed.
constexpr std::chrono::seconds kNextPoint{4};
/// The process itself ends later: three rounds of what does not answer.
constexpr std::chrono::seconds kEnd{60};
constexpr double kNoCurrentA = 1e-3;

struct Broken {
  const char* name;
  std::string request = {};   ///< what breaks it; empty: it is so from the beginning
  const char* actuator = "";  ///< that cannot be confirmed
  char letter = '.';
  bool lets_runs_begin = true;
  double boost = 1.0;
  const char* identity = "";
};

const std::vector<Broken>& all_broken() {
  static const std::vector<Broken> all = {
      {"nothing"},
      {"magnetometer absent", "break magnetometer absent"},
      {"coil_vertical absent", "break coil_vertical absent", "coil_vertical", 'u'},
      {"coil_vertical silent", "break coil_vertical silent", "coil_vertical", 'c'},
      {"thermostat nan", "break thermostat nan"},
      {"thermostat in manual mode", "", "", '.', false, 3.0},
      {"gyro absent", "break gyro absent"},
      {"coil_vertical another one", "", "", '.', false, 1.0, "AGILENT"}};
  return all;
}

/// One bench, one fault, and the daemons that come and go.
class SafetyCell {
 public:
  explicit SafetyCell(const Broken& one) : broken(one), far(one.boost, one.identity) {}

  void fail(const std::string& what) { wrong += what + "; "; }

  void start(const std::vector<std::string>& environment = {}) {
    daemon = far.daemon(environment);
    told_after_s = far.state()["time_s"];
  }
  /// With a daemon: currents in both coils, and heat; by a run where one can begin, by hand else.
  void energise() {
    if (broken.lets_runs_begin) {
      Finished asked;
      for (int i = 0; i < 100; ++i) {
        asked = far.fogbench({"run", far.energising_procedure()});
        if (asked.status == 0) break;
        std::this_thread::sleep_for(100ms);
      }
      if (asked.status != 0) return fail("no run: " + asked.err);
    } else {
      std::this_thread::sleep_for(1500ms);
      far.ask("energise");
    }
    for (int i = 0; i < 300; ++i) {
      if (is_on(far.state())) return;
      std::this_thread::sleep_for(100ms);
    }
    fail("never energised");
  }
  void break_it() {
    if (!broken.request.empty() && far.ask(broken.request) != "done") fail("not broken");
  }
  void signal(int number) {
    told_after_s = far.state()["time_s"];
    daemon->signal(number);
  }
  /// Waits for it to be true, at most so long from now.
  void expect_safe(bool heaters_too, bool asked_too, std::chrono::seconds within = kBound) {
    const auto begun = SteadyClock::now();
    std::string unsafe;
    do {
      unsafe = what_is_unsafe(heaters_too, asked_too);
      std::this_thread::sleep_for(20ms);
    } while (!unsafe.empty() && SteadyClock::now() - begun < within);
    if (!unsafe.empty()) fail(unsafe);
    longest = std::max(longest, std::chrono::duration<double>(SteadyClock::now() - begun).count());
  }
  /// The daemon's end and its log.
  Finished end(int status) {
    Finished finished = daemon->wait(kEnd);
    daemon.reset();
    log += finished.err;
    if (finished.status != status) {
      fail(fmt::format("status {} (signal {}), expected {}", finished.status, finished.signal,
                       status));
    }
    return finished;
  }
  void die(int number) {
    daemon->signal(number);
    const Finished finished = daemon->wait(kEnd);
    log += finished.err;
    if (finished.signal != number) fail("it did not die");
    daemon.reset();
    if (!is_on(far.state())) fail("the far ends forgot what was energised");
  }
  /// What is left of the daemon stops, and what it said of each actuator was true.
  void stop_and_check_words() {
    signal(SIGTERM);
    const Finished finished = end(confirms_all() ? 0 : 4);
    for (const std::string actuator : {"coil_horizontal", "coil_vertical", "thermostat"}) {
      const std::string expected =
          actuator + (actuator != broken.actuator ? " off, read back"
                      : broken.letter == 'u'      ? " unreachable ("
                                                  : " commanded off, not confirmed (");
      if (finished.err.find(expected) == std::string::npos) fail("the log lacks: " + expected);
      const std::string lie = actuator + " off, read back";
      if (actuator == broken.actuator && finished.err.find(lie) != std::string::npos) {
        fail("the log lies: " + lie);
      }
    }
  }
  bool confirms_all() const { return std::string_view(broken.actuator).empty(); }

  const Broken& broken;
  FarBench far;
  std::unique_ptr<Process> daemon;
  double told_after_s = 0.0;
  double longest = 0.0;
  std::string wrong, log;

 private:
  static double current_a(const nlohmann::json& state, const std::string& coil) {
    return std::abs(state[coil]["current_a"].get<double>());
  }
  static bool is_on(const nlohmann::json& state) {
    return current_a(state, "coil_horizontal") > 1.0 && current_a(state, "coil_vertical") > 1.0 &&
           state["heater_w"] > 5.0;
  }
  std::string what_is_unsafe(bool heaters_too, bool asked_too) {
    const nlohmann::json state = far.state();
    std::string unsafe;
    for (const std::string coil : {"coil_horizontal", "coil_vertical"}) {
      if (coil == broken.actuator) continue;
      const nlohmann::json& one = state[coil];
      if (current_a(state, coil) > kNoCurrentA) unsafe += coil + " carries current; ";
      if (one["zero_at_s"] < told_after_s) unsafe += coil + " was not told; ";
      if (asked_too && one["asked_at_s"] < one["zero_at_s"]) unsafe += coil + " was not asked; ";
    }
    if (heaters_too && (state["heats"] || state["heater_w"] > 0.0)) unsafe += "it heats; ";
    return unsafe;
  }
};

/// The thread of that name; waits for it.
pid_t named_thread(pid_t process, const std::string& name) {
  for (int i = 0; i < 100; ++i) {
    for (const auto& task : fs::directory_iterator(fmt::format("/proc/{}/task", process))) {
      if (support::read_text(task.path() / "comm") == name + "\n") {
        return std::stoi(task.path().filename().string());
      }
    }
    std::this_thread::sleep_for(50ms);
  }
  return 0;
}

/// Whether systemd's end of NOTIFY_SOCKET is told READY=1.
class ReadySocket {
 public:
  explicit ReadySocket(const std::string& path)
      : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  ReadySocket(const ReadySocket&) = delete;
  ReadySocket& operator=(const ReadySocket&) = delete;
  ~ReadySocket() { close(socket_); }
  bool comes(std::chrono::seconds within) const {
    const timeval wait{within.count(), 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
    std::array<char, 1024> message{};
    return recv(socket_, message.data(), message.size() - 1, 0) > 0 &&
           std::string_view(message.data()).starts_with("READY=1");
  }

 private:
  int socket_;
};

void ends_by(SafetyCell& cell, const std::vector<int>& signals) {
  cell.start();
  cell.energise();
  cell.break_it();
  cell.signal(signals.front());
  for (std::size_t i = 1; i < signals.size(); ++i) {
    std::this_thread::sleep_for(5ms);
    cell.daemon->signal(signals[i]);
  }
  cell.expect_safe(true, true, kBound + (cell.broken.letter == 'c' ? kAskedInVain : 0s));
  const Finished ended = cell.end(cell.confirms_all() ? 0 : 4);
  const std::string words = cell.confirms_all() ? "stopped; the bench is in its safe state"
                            : cell.broken.letter == 'u'
                                ? std::string(cell.broken.actuator) + " unreachable ("
                                : std::string(cell.broken.actuator) + " commanded off, not";
  if (ended.err.find(words) == std::string::npos) cell.fail("the log lacks: " + words);
  if (signals.size() > 1 && ended.err.find("stopping already") == std::string::npos) {
    cell.fail("the log does not tell one event from two");
  }
}

void dies_by(SafetyCell& cell, int signal, std::chrono::milliseconds pause) {
  cell.start();
  cell.energise();
  cell.die(signal);
  cell.break_it();
  std::this_thread::sleep_for(pause);
  cell.start();
  cell.expect_safe(true, true);
  cell.stop_and_check_words();
}

/// The bench's thread stands as in a call that never returns; a person will not wait.
void last_words(SafetyCell& cell) {
  cell.start();
  cell.energise();
  cell.break_it();
  std::this_thread::sleep_for(500ms);
  const pid_t bench = named_thread(cell.daemon->id(), "bench");
  if (bench == 0 || ptrace(PTRACE_SEIZE, bench, nullptr, nullptr) != 0 ||
      ptrace(PTRACE_INTERRUPT, bench, nullptr, nullptr) != 0 ||
      waitpid(bench, nullptr, __WALL) != bench) {
    return cell.fail("the bench's thread cannot be stopped");
  }
  cell.far.ask("energise");
  cell.daemon->signal(SIGINT);
  std::this_thread::sleep_for(3200ms);
  cell.signal(SIGTERM);
  waitpid(bench, nullptr, __WALL);
  // The magnetometer's absence has switched the coils off before, and they are on again by hand.
  cell.expect_safe(false, false);
  const Finished ended = cell.end(4);
  for (const char* words : {"SIGINT: stopping", "a second signal, SIGTERM: ending at once",
                            "0 A was sent to the coils"}) {
    if (ended.err.find(words) == std::string::npos) {
      cell.fail(std::string("the log lacks: ") + words);
    }
  }
  cell.start();
  cell.expect_safe(true, true);
  cell.stop_and_check_words();
}

void killed_in_the_start(SafetyCell& cell) {
  cell.far.ask("energise");
  cell.break_it();
  // One after the other, each a little further.
  for (int killed = 0; killed < 5; ++killed) {
    const auto daemon = cell.far.daemon();
    std::this_thread::sleep_for(10ms * (1 << killed));
    daemon->signal(SIGKILL);
    daemon->wait(kEnd);
  }
  cell.start();
  cell.expect_safe(true, true);
  cell.stop_and_check_words();
}

void restarted_by_systemd(SafetyCell& cell) {
  cell.start();
  cell.energise();
  cell.die(SIGKILL);
  cell.break_it();
  std::this_thread::sleep_for(100ms);
  const ReadySocket systemd(cell.far.path("notify"));
  cell.start({"NOTIFY_SOCKET=" + cell.far.path("notify"), "WATCHDOG_USEC=4000000"});
  cell.expect_safe(true, true);
  if (!systemd.comes(20s)) cell.fail("systemd was not told that it is ready");
  cell.stop_and_check_words();
}

void disk_full(SafetyCell& cell) {
  if (!cell.broken.lets_runs_begin) return;
  cell.start();
  cell.energise();
  cell.break_it();
  cell.told_after_s = cell.far.state()["time_s"];
  const rlimit none{4096, RLIM_INFINITY};
  if (prlimit(cell.daemon->id(), RLIMIT_FSIZE, &none, nullptr) != 0) cell.fail("no limit");
  // The run waits for room, with its heating; no field waits with it.
  cell.expect_safe(false, true,
                   kBound + kNextPoint + (cell.broken.letter == 'c' ? kAskedInVain : 0s));
  cell.signal(SIGTERM);
  cell.expect_safe(true, true, kBound + (cell.broken.letter == 'c' ? kAskedInVain : 0s));
  cell.daemon->wait(kEnd);
  cell.daemon.reset();
}

struct SafetySituation {
  const char* name;
  std::function<void(SafetyCell&)> happens;
  bool needs_a_run = false;
};

const std::vector<SafetySituation>& process_situations() {
  static const std::vector<SafetySituation> all = {
      {"SIGTERM", [](SafetyCell& cell) { ends_by(cell, {SIGTERM}); }},
      {"SIGHUP_twice",
       [](SafetyCell& cell) {
         ends_by(cell, {SIGHUP, SIGHUP});
       }},
      {"hung_abort_and_a_second_signal", last_words},
      {"SIGKILL_and_restart", [](SafetyCell& cell) { dies_by(cell, SIGKILL, 0ms); }},
      {"killed_in_the_start", killed_in_the_start},
      {"systemd_restart", restarted_by_systemd},
      {"disk_full_in_a_sweep", disk_full, true},
      {"watchdog_and_restart", [](SafetyCell& cell) { dies_by(cell, SIGABRT, 100ms); }}};
  return all;
}

class SafetyProcess : public testing::TestWithParam<std::size_t> {};

TEST_P(SafetyProcess, LeavesNothingEnergisedThatCanBeReached) {
  const SafetySituation& situation = process_situations()[GetParam()];
  std::vector<std::unique_ptr<SafetyCell>> cells;
  for (const Broken& broken : all_broken()) cells.push_back(std::make_unique<SafetyCell>(broken));
  std::vector<std::thread> threads;
  for (const auto& cell : cells) threads.emplace_back([&] { situation.happens(*cell); });
  for (std::thread& thread : threads) thread.join();
  std::string letters;
  double longest_s = 0.0;
  int tried = 0;
  for (const auto& cell : cells) {
    EXPECT_EQ(cell->wrong, "") << situation.name << ", " << cell->broken.name << ":\n" << cell->log;
    const bool counts = cell->broken.lets_runs_begin || !situation.needs_a_run;
    letters += !cell->wrong.empty() ? 'X' : counts ? cell->broken.letter : '-';
    if (counts) ++tried;
    longest_s = std::max(longest_s, cell->longest);
  }
  fmt::print("{:<32}{}  {} cells, the longest {:.1f} s to 0 A\n", situation.name, letters, tried,
             longest_s);
}

INSTANTIATE_TEST_SUITE_P(All, SafetyProcess,
                         testing::Range(std::size_t{0}, process_situations().size()),
                         [](const testing::TestParamInfo<std::size_t>& tried) {
                           return process_situations()[tried.param].name;
                         });

TEST(SafetyStart, WaitsForAMagnetometerAndGoesOnWhenItIsPluggedIn) {
  FarBench far;
  far.ask("energise");
  far.ask("break magnetometer absent");
  const auto daemon = far.daemon();
  std::string shown;
  for (int i = 0; i < 100 && shown.find("waiting: magnetometer") == std::string::npos; ++i) {
    shown = far.fogbench({"status"}).out;
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_THAT(shown, testing::HasSubstr("waiting: magnetometer: HID device"));
  const nlohmann::json state = far.state();
  EXPECT_NEAR(state["coil_horizontal"]["current_a"], 0.0, kNoCurrentA);
  EXPECT_NEAR(state["coil_vertical"]["current_a"], 0.0, kNoCurrentA);
  EXPECT_FALSE(state["heats"]);
  EXPECT_EQ(far.fogbench({"run", far.energising_procedure()}).status, 0) << "it waits in the queue";
  far.ask("mend magnetometer absent");
  for (int i = 0; i < 200 && shown.find("energise") == std::string::npos; ++i) {
    shown = far.fogbench({"status"}).out;
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_THAT(shown, testing::HasSubstr("energise"));
  EXPECT_THAT(shown, testing::Not(testing::HasSubstr("waiting:")));
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(kEnd).status, 0);
}

void end_in_the_foreground(const std::string& missing) {
  FarBench far;
  far.ask("energise");
  far.ask("break " + missing + " absent");
  const auto daemon = far.daemon({}, {far.energising_procedure()});
  const Finished ended = daemon->wait(kEnd);
  EXPECT_EQ(ended.status, 4) << ended.err;
  EXPECT_THAT(ended.err, testing::HasSubstr(missing + ": "));
  EXPECT_THAT(ended.err, testing::HasSubstr("coil_horizontal off, read back"));
  const nlohmann::json state = far.state();
  EXPECT_NEAR(state["coil_horizontal"]["current_a"], 0.0, kNoCurrentA);
  EXPECT_NEAR(state["coil_vertical"]["current_a"], 0.0, kNoCurrentA);
  EXPECT_GE(state["coil_vertical"]["zeros"], 2) << "it tries again before it gives up";
  EXPECT_EQ(state["heats"], missing == "thermostat");
}

TEST(SafetyStart, InTheForegroundAMissingInstrumentIsStatusFourWithTheOthersOff) {
  std::vector<std::thread> threads;
  for (const char* missing : {"magnetometer", "gyro", "turntable", "thermostat"}) {
    threads.emplace_back(end_in_the_foreground, missing);
  }
  for (std::thread& thread : threads) thread.join();
}

// A run that was aborted while a supply was gone leaves it energised; nobody asks for another.
TEST(SafetyStart, AfterARunWhoIsPluggedInAgainIsSwitchedOff) {
  static const Broken kGone{"coil_vertical absent", "break coil_vertical absent", "coil_vertical",
                            'u'};
  SafetyCell cell(kGone);
  cell.start();
  cell.energise();
  cell.break_it();
  EXPECT_EQ(cell.far.fogbench({"abort"}).status, 4) << "not everything is off";
  EXPECT_GT(std::abs(cell.far.state()["coil_vertical"]["current_a"].get<double>()), 1.0);
  cell.far.ask("mend coil_vertical absent");
  nlohmann::json now;
  for (int i = 0; i < 100; ++i) {
    now = cell.far.state()["coil_vertical"];
    if (std::abs(now["current_a"].get<double>()) < kNoCurrentA) break;
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_NEAR(now["current_a"], 0.0, kNoCurrentA);
  cell.signal(SIGTERM);
  EXPECT_EQ(cell.end(0).status, 0) << cell.log;
  EXPECT_EQ(cell.wrong, "");
}

}  // namespace
}  // namespace fogbench::system_tests
