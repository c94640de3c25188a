#include "daemon/abort_on_signal.hpp"

#include <unistd.h>

#include <atomic>
#include <cassert>
#include <csignal>

#include "config/exit_status.hpp"

namespace fogbench::daemon {
namespace {

// A signal handler reaches nothing but globals.
std::atomic<procedures::RunEngine*> g_engine{nullptr};
std::atomic<bool> g_asked{false};
static_assert(std::atomic<procedures::RunEngine*>::is_always_lock_free);

void on_signal(int) {
  if (g_asked.exchange(true)) _exit(static_cast<int>(ExitStatus::kFailed));
  if (procedures::RunEngine* engine = g_engine) engine->request_abort();
}

}  // namespace

AbortOnSignal::AbortOnSignal(procedures::RunEngine& engine) {
  assert(g_engine == nullptr);
  g_engine = &engine;
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // Nobody reads the output any more: a failed write must not end the process in mid-run.
  std::signal(SIGPIPE, SIG_IGN);
  // A terminal that is closed ends the run like the others, unless nohup asked to survive it.
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

AbortOnSignal::~AbortOnSignal() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  struct sigaction now {};
  sigaction(SIGHUP, nullptr, &now);
  if (now.sa_handler == on_signal) std::signal(SIGHUP, SIG_DFL);
  g_engine = nullptr;
  g_asked = false;
}

bool AbortOnSignal::asked() {
  return g_asked;
}

}  // namespace fogbench::daemon
