#pragma once
// Lines of a file through one fixed buffer, so that no file, however wrong, takes much memory.

#include <filesystem>
#include <string_view>
#include <vector>

namespace fogbench::model {

/// A file open for reading; the descriptor is -1 (and errno says why) when it cannot be opened.
class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& file);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

class LineReader {
 public:
  static constexpr std::size_t kMaximumLine = std::size_t{1} << 20;

  enum class Outcome {
    kLine,
    kEnd,
    kTooLong,  ///< more than kMaximumLine bytes
    kFailed,   ///< errno says why
  };

  explicit LineReader(int file);
  /// The next line without its end (LF or CRLF), valid until the next call.
  Outcome next(std::string_view& line);
  /// Bytes of the lines given out so far.
  std::size_t consumed() const { return consumed_; }

 private:
  const char* find_newline() const;
  bool refill();

  int file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0, consumed_ = 0;
  bool finished_ = false;
};

}  // namespace fogbench::model
