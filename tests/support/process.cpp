#include "tests/support/process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace fogbench::support {
namespace {

using SteadyTime = std::chrono::steady_clock::time_point;

int remaining_ms(SteadyTime deadline) {
  const auto left = deadline - std::chrono::steady_clock::now();
  return static_cast<int>(std::max<std::int64_t>(
      0, std::chrono::duration_cast<std::chrono::milliseconds>(left).count()));
}

}  // namespace

Process::Process(const std::vector<std::string>& command, const Setup& setup) {
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0) {
    ADD_FAILURE() << "no pipes";
    return;
  }
  std::vector<char*> arguments;
  for (const std::string& argument : command)
    arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    dup2(open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    for (const std::string& variable : setup.environment) {
      const std::size_t equals = variable.find('=');
      setenv(variable.substr(0, equals).c_str(), variable.substr(equals + 1).c_str(), 1);
    }
    if (setup.in_child) setup.in_child();
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);
  out_ = out[0];
  err_ = err[0];
}

Process::~Process() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (out_ >= 0) close(out_);
  if (err_ >= 0) close(err_);
}

void Process::signal(int number) const {
  kill(pid_, number);
}

void Process::read_some(int timeout_ms) {
  pollfd files[] = {{out_, POLLIN, 0}, {err_, POLLIN, 0}};
  if (poll(files, 2, timeout_ms) <= 0) return;
  char buffer[65536];
  const auto take = [&](const pollfd& file, int& descriptor, std::string& text) {
    if (file.revents == 0) return;
    const ssize_t count = read(descriptor, buffer, sizeof buffer);
    if (count > 0) {
      text.append(buffer, static_cast<std::size_t>(count));
    } else {
      close(descriptor);
      descriptor = -1;  // poll ignores it from now on
    }
  };
  take(files[0], out_, finished_.out);
  take(files[1], err_, finished_.err);
}

bool Process::wait_for_output(const std::string& text, std::chrono::seconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (finished_.out.find(text) == std::string::npos) {
    if (out_ < 0 || remaining_ms(deadline) == 0) return false;
    read_some(remaining_ms(deadline));
  }
  return true;
}

Finished Process::wait(std::chrono::seconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (out_ >= 0 || err_ >= 0) {
    if (remaining_ms(deadline) == 0) {
      ADD_FAILURE() << "the program did not end in time";
      kill(pid_, SIGKILL);
      break;
    }
    read_some(remaining_ms(deadline));
  }
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  if (WIFEXITED(status)) finished_.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) finished_.signal = WTERMSIG(status);
  return finished_;
}

Finished run(const std::vector<std::string>& command, const Process::Setup& setup) {
  return Process(command, setup).wait();
}

}  // namespace fogbench::support
