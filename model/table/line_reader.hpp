#pragma once
// Lines of a text through one fixed buffer, so that no file, however wrong, takes much memory.

#include <memory>
#include <string_view>
#include <vector>

#include "model/table/byte_source.hpp"

namespace fogbench::model {

class LineReader {
 public:
  static constexpr std::size_t kMaximumLine = std::size_t{1} << 20;

  enum class Outcome {
    kLine,
    kEnd,
    kTooLong,  ///< more than kMaximumLine bytes
  };

  explicit LineReader(std::unique_ptr<ByteSource> text);
  /// The next line without its end (LF or CRLF), valid until the next call. Errors: the source's.
  Result<Outcome> next(std::string_view& line);
  /// What comes next, `most` bytes or all that is left; valid until the next call of anything.
  Result<std::string_view> peek(std::size_t most);
  /// Bytes of the lines given out so far.
  std::size_t consumed() const { return consumed_; }
  /// The source has given all its bytes.
  bool finished() const { return finished_; }

 private:
  const char* find_newline() const;
  Status refill();

  std::unique_ptr<ByteSource> text_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0, consumed_ = 0;
  bool finished_ = false;
};

}  // namespace fogbench::model
