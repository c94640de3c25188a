#pragma once
// A TCP connection with one host, in bounded memory: a host that sends without end is read no
// faster than it is served, and one that never reads is not served any more.

#include "drivers/file_descriptor.hpp"
#include "simulator/wire/bytes.hpp"
#include "simulator/wire/event_loop.hpp"

namespace fogbench::simulator {

class Connection {
 public:
  /// `descriptor` is a socket that does not block. At most `most_input` bytes wait to be taken.
  Connection(drivers::FileDescriptor descriptor, std::size_t most_input)
      : descriptor_(std::move(descriptor)), most_input_(most_input) {}

  void enlist(drivers::PollSet& set) const;
  /// Reads what has come. False when the host is gone.
  bool receive(const drivers::PollSet& happened);

  ByteView input() const { return input_; }
  void drop_input(std::size_t count);
  /// Sends now what the system takes, and the rest when it can. False when the host is gone.
  bool send(ByteView bytes);
  bool flush() { return send({}); }

  /// More is waiting to be sent than a host that reads leaves: no more is to be answered.
  bool congested() const { return output_.size() > kMostOutput; }
  std::size_t unsent() const { return output_.size(); }

 private:
  static constexpr std::size_t kMostOutput = 64 * 1024;

  drivers::FileDescriptor descriptor_;
  std::size_t most_input_;
  Bytes input_;
  Bytes output_;
};

}  // namespace fogbench::simulator
