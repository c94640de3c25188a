#include "daemon/abort_on_signal.hpp"

#include <poll.h>
#include <pthread.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>

#include "config/exit_status.hpp"

namespace fogbench::daemon {

void end_at_once(const std::string& why, Session* session) {
  const bool sent = session != nullptr && session->send_last_zero();
  spdlog::critical(
      "{}: ending at once, the bench is NOT in its safe state{}; a new start begins with it", why,
      sent ? " (0 A was sent to the coils, and nobody waited for an answer)" : "");
  spdlog::default_logger()->flush();
  _exit(static_cast<int>(ExitStatus::kFailed));
}

AbortOnSignal::AbortOnSignal() : signals_(clock_), end_(eventfd(0, EFD_CLOEXEC)) {
  thread_ = std::thread([this] { watch(); });
  pthread_setname_np(thread_.native_handle(), "signals");
}

AbortOnSignal::~AbortOnSignal() {
  eventfd_write(end_.get(), 1);
  thread_.join();
}

void AbortOnSignal::attach(Session& session) {
  const std::lock_guard lock(mutex_);
  session_ = &session;
  if (asked_) session.engine().request_abort();
}

void AbortOnSignal::watch() {
  pollfd ready[] = {{signals_.descriptor(), POLLIN, 0}, {end_.get(), POLLIN, 0}};
  while (::poll(ready, 2, -1) >= 0 || errno == EINTR) {
    while (const auto signal = signals_.next()) take(*signal);
    if (ready[1].revents != 0) return;
  }
}

void AbortOnSignal::take(const StopSignals::Signal& signal) {
  const std::lock_guard lock(mutex_);
  switch (signal.means) {
    case StopSignals::Means::kAbort:
      asked_ = true;
      spdlog::info("{}: stopping; again after {} s ends at once", signal.name,
                   drivers::to_seconds(StopSignals::kPatience));
      if (session_ != nullptr) session_->engine().request_abort();
      return;
    case StopSignals::Means::kSameEvent:
      spdlog::info("{}: stopping already", signal.name);
      return;
    case StopSignals::Means::kForcedEnd:
      end_at_once("a second signal, " + signal.name, session_);
  }
}

}  // namespace fogbench::daemon
