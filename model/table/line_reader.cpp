#include "model/table/line_reader.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace fogbench::model {
namespace {

/// One line of the greatest length, and some room behind it.
constexpr std::size_t kBuffer = 2 * LineReader::kMaximumLine;
/// So much is asked for at once: what stays in the cache until it has been read.
constexpr std::size_t kAtOnce = std::size_t{1} << 18;

}  // namespace

LineReader::LineReader(std::unique_ptr<ByteSource> text)
    : text_(std::move(text)), buffer_(kBuffer) {}

Result<LineReader::Outcome> LineReader::next(std::string_view& line) {
  const char* newline = find_newline();
  while (newline == nullptr && end_ - begin_ <= kMaximumLine && !finished_) {
    if (Status refilled = refill(); !refilled) return refilled.error();
    newline = find_newline();
  }
  std::size_t length = 0;
  if (newline != nullptr) {
    length = static_cast<std::size_t>(newline - (buffer_.data() + begin_));
  } else if (end_ - begin_ > kMaximumLine) {
    return Outcome::kTooLong;
  } else if (begin_ == end_) {
    return Outcome::kEnd;
  } else {
    length = end_ - begin_;
  }
  if (length > kMaximumLine) return Outcome::kTooLong;
  line = {buffer_.data() + begin_, length};
  begin_ += length + (newline != nullptr ? 1 : 0);
  consumed_ += length + 1;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return Outcome::kLine;
}

Result<std::string_view> LineReader::peek(std::size_t most) {
  while (end_ - begin_ < most && !finished_) {
    if (Status refilled = refill(); !refilled) return refilled.error();
  }
  return std::string_view(buffer_.data() + begin_, std::min(most, end_ - begin_));
}

const char* LineReader::find_newline() const {
  return static_cast<const char*>(std::memchr(buffer_.data() + begin_, '\n', end_ - begin_));
}

Status LineReader::refill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const std::size_t room = std::min(kAtOnce, kBuffer - end_);
  const auto got = text_->read(std::span(buffer_).subspan(end_, room));
  if (!got) return got.error();
  finished_ = *got == 0;
  end_ += *got;
  return {};
}

}  // namespace fogbench::model
