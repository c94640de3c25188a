#include "model/table/line_reader.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace fogbench::model {
namespace {

/// Several lines of the greatest length.
constexpr std::size_t kBuffer = 4 * LineReader::kMaximumLine;

}  // namespace

OpenFile::OpenFile(const std::filesystem::path& file)
    : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

LineReader::LineReader(int file) : file_(file), buffer_(kBuffer) {}

LineReader::Outcome LineReader::next(std::string_view& line) {
  const char* newline = find_newline();
  while (newline == nullptr && end_ - begin_ <= kMaximumLine && !finished_) {
    if (!refill()) return Outcome::kFailed;
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

const char* LineReader::find_newline() const {
  return static_cast<const char*>(std::memchr(buffer_.data() + begin_, '\n', end_ - begin_));
}

bool LineReader::refill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  ssize_t got = 0;
  do {
    got = ::read(file_, buffer_.data() + end_, buffer_.size() - end_);
  } while (got < 0 && errno == EINTR);
  if (got < 0) return false;
  finished_ = got == 0;
  end_ += static_cast<std::size_t>(got);
  return true;
}

}  // namespace fogbench::model
