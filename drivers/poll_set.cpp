#include "drivers/poll_set.hpp"

#include <cerrno>

namespace fogbench::drivers {

bool PollSet::wait(std::chrono::nanoseconds at_most) {
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(at_most);
  const timespec patience{whole.count(), (at_most - whole).count()};
  if (ppoll(all_.data(), all_.size(), &patience, nullptr) >= 0) return true;
  for (pollfd& one : all_) one.revents = 0;
  return errno == EINTR;
}

short PollSet::happened(int descriptor) const {
  for (const pollfd& one : all_) {
    if (one.fd == descriptor) return one.revents;
  }
  return 0;
}

}  // namespace fogbench::drivers
