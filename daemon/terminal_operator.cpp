#include "daemon/terminal_operator.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "daemon/access.hpp"

namespace fogbench::daemon {
namespace {

/// How soon an abort is noticed while nobody answers.
constexpr int kLookMs = 200;

}  // namespace

Result<bool> TerminalOperator::confirm(const std::string& prompt) {
  for (;;) {
    fmt::print(out_, "{} [yes/no] ", prompt);
    std::fflush(out_);
    const auto line = read_line(prompt);
    if (!line) return line.error();
    if (aborted_() || *line == "n" || *line == "no") return false;
    if (*line == "y" || *line == "yes") return true;
  }
}

std::string TerminalOperator::name() const {
  return user_name(geteuid()) + " at the terminal";
}

Result<std::string> TerminalOperator::read_line(const std::string& prompt) {
  std::string line;
  while (!aborted_()) {
    pollfd typed{in_, POLLIN, 0};
    if (::poll(&typed, 1, kLookMs) <= 0) continue;
    // One byte at a time, so that the answer to the next prompt stays where it is.
    char c = 0;
    if (::read(in_, &c, 1) != 1) {
      return Error{
          ErrorCode::kDevice,
          fmt::format("nobody answers \"{}\": standard input has ended; run fogbenchd on a "
                      "terminal",
                      prompt)};
    }
    if (c == '\n') return line;
    if (c != '\r' && c != ' ') line += c;
  }
  return line;
}

}  // namespace fogbench::daemon
