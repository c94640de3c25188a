#pragma once
// A local socket on which messages keep their bounds (SOCK_SEQPACKET), met at a path.

#include <filesystem>
#include <optional>

#include "drivers/file_descriptor.hpp"
#include "simulator/wire/event_loop.hpp"

namespace fogbench::far_bench {

class PacketListener {
 public:
  /// Nothing with the system's reason in errno. A socket that was left at the path is replaced.
  static std::optional<PacketListener> open(const std::filesystem::path& path);
  PacketListener(PacketListener&&) = default;
  PacketListener& operator=(PacketListener&&) = delete;
  /// Nobody finds it any more.
  ~PacketListener();

  void enlist(drivers::PollSet& set) const { set.add(descriptor_.get(), POLLIN); }
  /// The next connection, which does not block; empty when there is none.
  drivers::FileDescriptor accept() const;

 private:
  PacketListener(drivers::FileDescriptor descriptor, std::filesystem::path path)
      : descriptor_(std::move(descriptor)), path_(std::move(path)) {}

  drivers::FileDescriptor descriptor_;
  std::filesystem::path path_;
};

}  // namespace fogbench::far_bench
