#pragma once
// A serial line as a pseudo-terminal. It is met under a link whose name stays when the line is
// unplugged and plugged in again, as udev names the real ones by their serial numbers.

#include <sys/types.h>

#include <filesystem>

#include "config/result.hpp"
#include "drivers/file_descriptor.hpp"
#include "simulator/wire/bytes.hpp"
#include "simulator/wire/event_loop.hpp"

namespace fogbench::simulator {

class PseudoTerminal {
 public:
  /// Plugged in. kDevice with the system's reason. The link must not exist.
  static Result<PseudoTerminal> open(std::filesystem::path link);
  PseudoTerminal(PseudoTerminal&&) = default;
  PseudoTerminal& operator=(PseudoTerminal&&) = delete;
  ~PseudoTerminal() { unplug(); }

  /// Closes our side, which hangs up on the host, and removes the link.
  void unplug();
  /// Another one under the same link; nothing when it is plugged in already. kDevice.
  Status plug();
  bool plugged() const { return static_cast<bool>(ours_); }

  const std::filesystem::path& link() const { return link_; }

  /// Whether a host has it open. When the last one has closed it, what it said before is appended
  /// to `last_words`, where given, up to `most` bytes in all, and what it left unread is forgotten.
  bool in_use(Bytes* last_words = nullptr, std::size_t most = 0);
  void enlist(drivers::PollSet& set, short events) const;
  /// Appends what the host has sent, up to `most` bytes in all.
  void receive(Bytes& input, std::size_t most);
  /// How many of the bytes went out; 0 when the line is full.
  std::size_t send(ByteView bytes);

 private:
  explicit PseudoTerminal(std::filesystem::path link) : link_(std::move(link)) {}
  /// As a host finds it: raw, and with nothing in it. False when it cannot be opened.
  bool make_fresh();

  std::filesystem::path link_;
  drivers::FileDescriptor ours_;
  std::string name_;  ///< "/dev/pts/3"
  bool was_in_use_ = false;
};

}  // namespace fogbench::simulator
