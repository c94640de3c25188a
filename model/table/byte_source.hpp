#pragma once
// The bytes of a file as their writer knew them: taken out of a gzip or zstd archive, which is
// recognised by its first bytes, not by its name. Read once from front to back, so that a pipe
// serves as well as a file.

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "config/result.hpp"

namespace fogbench::model {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Fills `into` from its front; 0 at the end. Errors: kBadInput, without the file's name: what
  /// the system says, an archive that is damaged or ends too early.
  virtual Result<std::size_t> read(std::span<char> into) = 0;
};

struct OpenedBytes {
  std::unique_ptr<ByteSource> bytes;
  std::string archive;         ///< "gzip", "zstd"; empty: plain
  std::size_t file_bytes = 0;  ///< of the file itself; 0 where nobody knows, as of a pipe
};

/// Errors: kBadInput with the file's name, for what cannot be opened and for a directory.
Result<OpenedBytes> open_bytes(const std::filesystem::path& file);

/// The first bytes that `source` gives, `most` or all.
Result<std::string> first_bytes(ByteSource& source, std::size_t most);

/// `taken`, which were read already, and then those of `rest`.
std::unique_ptr<ByteSource> put_back(std::string taken, std::unique_ptr<ByteSource> rest);

}  // namespace fogbench::model
