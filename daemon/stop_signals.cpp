#include "daemon/stop_signals.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <csignal>

namespace fogbench::daemon {
namespace {

int block(sigset_t& before) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGTERM, SIGINT}) sigaddset(&signals, number);
  struct sigaction hangup {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaddset(&signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals, &before);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is a full disk
  return signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
}

}  // namespace

StopSignals::StopSignals(drivers::Clock& clock) : clock_(clock), descriptor_(block(before_)) {}

StopSignals::~StopSignals() {
  // What has come and was not read belongs to what was stopped.
  while (next()) {
  }
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

std::optional<StopSignals::Signal> StopSignals::next() {
  signalfd_siginfo info{};
  if (read(descriptor_.get(), &info, sizeof info) != sizeof info) return std::nullopt;
  Signal signal{fmt::format("SIG{}", sigabbrev_np(static_cast<int>(info.ssi_signo))),
                Means::kAbort};
  const auto now = clock_.now();
  if (!first_) {
    first_ = now;
  } else {
    signal.means = now - *first_ < kPatience ? Means::kSameEvent : Means::kForcedEnd;
  }
  return signal;
}

}  // namespace fogbench::daemon
