#include "tests/system/far_bench/hid_server.hpp"

#include <sys/socket.h>

#include <cerrno>

namespace fogbench::far_bench {

void HidServer::enlist(simulator::PollSet& set) const {
  if (!listener_) return;
  listener_->enlist(set);
  set.wake_at(next_);
}

void HidServer::serve(const simulator::PollSet&) {
  if (!far_end_.plugged()) {
    hosts_.clear();
    listener_.reset();
    return;
  }
  if (!listener_) {
    auto opened = PacketListener::open(path_);
    if (opened) listener_.emplace(std::move(*opened));
    return;
  }
  while (simulator::FileDescriptor host = listener_->accept()) hosts_.push_back(std::move(host));
  if (clock_.now() < next_) return;
  next_ = clock_.now() + period_;
  const auto count = far_end_.read_report(report_, period_);
  clock_.take_due();
  if (!count) return;
  // As the kernel: a host that does not read loses reports.
  std::erase_if(hosts_, [&](const simulator::FileDescriptor& host) {
    const ssize_t sent =
        send(host.get(), report_.data(), *count, MSG_DONTWAIT | MSG_NOSIGNAL | MSG_EOR);
    return sent < 0 && errno != EAGAIN;
  });
}

}  // namespace fogbench::far_bench
