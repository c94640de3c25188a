#include "daemon/service_manager.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <system_error>

#include "config/json_file.hpp"
#include "daemon/desk_json.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::daemon {
namespace {

void tell(const std::string& message) {
  const int sent = sd_notify(0, message.c_str());
  if (sent < 0) spdlog::warn("systemd: {}", std::generic_category().message(-sent));
}

}  // namespace

std::string service_status(const DeskView& view) {
  // A procedure's name and a prompt may be any text; a line is one line.
  constexpr std::size_t kLongest = 200;
  if (!view.run) {
    std::string says = view.bench_waits_for.empty() ? "idle" : "waiting: " + view.bench_waits_for;
    if (view.jobs > 0) {
      says += fmt::format(", {} in the queue{}", view.jobs, view.held() ? ", held" : "");
    }
    return config::one_line(says, kLongest);
  }
  const procedures::Progress& now = view.run->progress;
  std::string says = fmt::format(
      "run {}, {}: {}, step {} of {}, {} left", view.run->run, view.run->procedure, state_of(view),
      std::min(now.step + 1, now.steps), now.steps, procedures::duration_text(now.remaining));
  if (view.question) says += "; asks: " + view.question->text;
  return config::one_line(says, kLongest);
}

ServiceManager::ServiceManager(drivers::Clock& clock) : clock_(clock) {
  constexpr drivers::Clock::Duration kPeriod = std::chrono::seconds{1};
  std::uint64_t watchdog_us = 0;
  if (sd_watchdog_enabled(0, &watchdog_us) > 0) watchdog_ = std::chrono::microseconds(watchdog_us);
  // Twice within the watchdog's time is what systemd asks for; the second half is for a busy
  // machine.
  period_ = watchdog_ ? std::min(kPeriod, *watchdog_ / 4) : kPeriod;
}

void ServiceManager::ready() {
  tell("READY=1");
}

void ServiceManager::report(const RunDesk& desk) {
  const auto now = clock_.now();
  const DeskView view = desk.view();
  // At once: a bench without a run is left within the same moment.
  if (view.closing && !stopping_) {
    stopping_ = true;
    tell("STOPPING=1");
  }
  if (now < due_) return;
  due_ = now + period_;
  if (const std::string says = service_status(view); says != said_) {
    said_ = says;
    tell("STATUS=" + says);
  }
  if (!watchdog_) return;
  const RunDesk::Pulse pulse = desk.pulse();
  if (!pulse.waits_for_job && pulse.beats == fed_at_ && !desk.aborting()) return;
  fed_at_ = pulse.beats;
  tell("WATCHDOG=1");
}

}  // namespace fogbench::daemon
