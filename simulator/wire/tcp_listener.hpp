#pragma once

#include <cstdint>
#include <string>

#include "config/result.hpp"
#include "drivers/file_descriptor.hpp"
#include "simulator/wire/event_loop.hpp"

namespace fogbench::simulator {

/// Waits for TCP connections on one address of this machine.
class TcpListener {
 public:
  /// `address`: numeric IPv4. Port 0: any that is free. kDevice with address, port and the system's
  /// reason.
  static Result<TcpListener> open(const std::string& address, std::uint16_t port);

  std::uint16_t port() const { return port_; }
  void enlist(drivers::PollSet& set) const { set.add(descriptor_.get(), POLLIN); }
  /// The next connection, which does not block and sends without delay; empty when there is none.
  drivers::FileDescriptor accept();

 private:
  TcpListener(drivers::FileDescriptor descriptor, std::uint16_t port)
      : descriptor_(std::move(descriptor)), port_(port) {}

  drivers::FileDescriptor descriptor_;
  std::uint16_t port_ = 0;
};

}  // namespace fogbench::simulator
