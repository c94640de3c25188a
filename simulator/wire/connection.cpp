#include "simulator/wire/connection.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace fogbench::simulator {

void Connection::enlist(drivers::PollSet& set) const {
  const bool room = input_.size() < most_input_ && !congested();
  const int events = (room ? POLLIN : 0) | (output_.empty() ? 0 : POLLOUT);
  set.add(descriptor_.get(), static_cast<short>(events));
}

bool Connection::receive(const drivers::PollSet& happened) {
  const short what = happened.happened(descriptor_.get());
  if (what == 0) return true;
  if ((what & POLLIN) == 0) return (what & (POLLERR | POLLHUP | POLLNVAL)) == 0;
  const std::size_t before = input_.size();
  constexpr std::size_t kAtOnce = 16 * 1024;
  input_.resize(std::min(most_input_, before + kAtOnce));
  const ssize_t count = recv(descriptor_.get(), input_.data() + before, input_.size() - before, 0);
  const bool later = count < 0 && (errno == EAGAIN || errno == EINTR);
  input_.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return count > 0 || later;
}

void Connection::drop_input(std::size_t count) {
  input_.erase(input_.begin(), input_.begin() + static_cast<std::ptrdiff_t>(count));
}

bool Connection::send(ByteView bytes) {
  append(output_, bytes);
  while (!output_.empty()) {
    const ssize_t count = ::send(descriptor_.get(), output_.data(), output_.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno == EAGAIN;
    output_.erase(output_.begin(), output_.begin() + count);
  }
  return true;
}

}  // namespace fogbench::simulator
