#include "simulator/wire/pseudo_terminal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace fogbench::simulator {

Result<PseudoTerminal> PseudoTerminal::open(std::filesystem::path link) {
  PseudoTerminal terminal(std::move(link));
  if (Status s = terminal.plug(); !s) return s.error();
  return terminal;
}

void PseudoTerminal::unplug() {
  if (!ours_) return;
  std::error_code ignored;
  std::filesystem::remove(link_, ignored);
  ours_ = drivers::FileDescriptor();
}

Status PseudoTerminal::plug() {
  if (ours_) return {};
  const auto failed = [this](const std::string& why) {
    return Error{ErrorCode::kDevice,
                 fmt::format("tty:{}: cannot be made: {}", link_.string(), why)};
  };
  drivers::FileDescriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 64> name{};
  if (!master || grantpt(master.get()) != 0 || unlockpt(master.get()) != 0 ||
      ptsname_r(master.get(), name.data(), name.size()) != 0) {
    return failed(std::strerror(errno));
  }
  std::error_code error;
  std::filesystem::create_symlink(name.data(), link_, error);
  if (error) return failed(error.message());
  ours_ = std::move(master);
  name_ = name.data();
  was_in_use_ = false;
  make_fresh();
  return {};
}

bool PseudoTerminal::make_fresh() {
  // The host's side, for a moment: only once it has been closed does ours say that it is.
  const drivers::FileDescriptor theirs(
      ::open(name_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!theirs) return false;
  termios settings{};
  if (tcgetattr(theirs.get(), &settings) == 0) {
    cfmakeraw(&settings);
    tcsetattr(theirs.get(), TCSANOW, &settings);
  }
  tcflush(theirs.get(), TCIOFLUSH);
  return true;
}

bool PseudoTerminal::in_use(Bytes* last_words, std::size_t most) {
  if (!ours_) return false;
  pollfd ours{ours_.get(), 0, 0};
  poll(&ours, 1, 0);
  const bool used = (ours.revents & POLLHUP) == 0;
  if (was_in_use_ && !used && last_words != nullptr) receive(*last_words, most);
  if (was_in_use_ && !used && !make_fresh()) {
    // A host that was killed has left it closed to all others: there is no way back but a new one.
    unplug();
    static_cast<void>(plug());
    return false;
  }
  was_in_use_ = used;
  return used;
}

void PseudoTerminal::enlist(drivers::PollSet& set, short events) const {
  // One that nobody has open would wake the loop without end.
  if (was_in_use_) set.add(ours_.get(), events);
}

void PseudoTerminal::receive(Bytes& input, std::size_t most) {
  const std::size_t before = input.size();
  if (!ours_ || before >= most) return;
  input.resize(most);
  const ssize_t count = read(ours_.get(), input.data() + before, most - before);
  input.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
}

std::size_t PseudoTerminal::send(ByteView bytes) {
  if (!ours_ || bytes.empty()) return 0;
  const ssize_t count = write(ours_.get(), bytes.data(), bytes.size());
  return static_cast<std::size_t>(std::max<ssize_t>(count, 0));
}

}  // namespace fogbench::simulator
