#pragma once
// Messages as lines over a serial line: what a SCPI instrument without USB speaks.

#include <memory>
#include <string>

#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

class LineMessages final : public MessageTransport {
 public:
  /// `clock` must outlive it.
  LineMessages(std::unique_ptr<SerialTransport> serial, Clock& clock)
      : serial_(std::move(serial)), clock_(clock) {}

  /// Throws away what has arrived unasked, then sends the message and a line feed.
  Status write(std::string_view message) override;
  /// The next line without its line feed and carriage return. kProtocol for a line without end.
  Result<std::string> read(Clock::Duration timeout) override;
  /// Ends whatever line is half sent, and listens for late answers, which it throws away.
  Status clear() override;
  void write_last(std::string_view message) noexcept override;

 private:
  /// What has arrived by now is added to arrived_; how much that was.
  Result<std::size_t> receive();
  Status drop();

  std::unique_ptr<SerialTransport> serial_;
  Clock& clock_;
  std::string arrived_;
};

}  // namespace fogbench::drivers
