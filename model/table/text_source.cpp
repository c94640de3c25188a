#include "model/table/text_source.hpp"

#include <iconv.h>

#include <algorithm>
#include <cerrno>
#include <utility>
#include <vector>

namespace fogbench::model {
namespace {

constexpr unsigned char kFirstLetter1251 = 0xC0;

unsigned char byte_at(std::string_view text, std::size_t at) {
  return static_cast<unsigned char>(text[at]);
}

/// Sequences of UTF-8 only, the last of them perhaps cut off.
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const unsigned char first = byte_at(text, i);
    std::size_t more = 0;
    if (first >= 0xF0 && first < 0xF5) {
      more = 3;
    } else if (first >= 0xE0 && first < 0xF0) {
      more = 2;
    } else if (first >= 0xC2 && first < 0xE0) {
      more = 1;
    } else if (first >= 0x80) {
      return false;
    }
    for (std::size_t k = 1; k <= more; ++k) {
      if (i + k >= text.size()) return true;
      if ((byte_at(text, i + k) & 0xC0) != 0x80) return false;
    }
    i += more + 1;
  }
  return true;
}

/// In a Latin text letters beyond ASCII stand singly among others; in a Cyrillic one they make the
/// words.
bool looks_cyrillic(std::string_view text) {
  std::size_t in_words = 0, alone = 0, run = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && byte_at(text, i) >= kFirstLetter1251) {
      ++run;
      continue;
    }
    (run >= 2 ? in_words : alone) += run;
    run = 0;
  }
  return in_words > alone;
}

/// Which of the two bytes of a UTF-16 text of mostly ASCII is zero: -1 for none.
int zero_half(std::string_view text) {
  std::size_t zeros[2] = {0, 0};
  for (std::size_t i = 0; i < text.size(); ++i) zeros[i % 2] += text[i] == '\0' ? 1 : 0;
  const std::size_t most = text.size() / 2;
  for (const int half : {0, 1}) {
    const bool is_text = 10 * zeros[half] > 7 * most && 20 * zeros[1 - half] < most;
    if (is_text) return half;
  }
  return -1;
}

struct Encoding {
  const char* name = "UTF-8";  ///< as iconv calls it
  std::string says;
  std::size_t mark = 0;  ///< bytes of the byte order mark
};

Encoding encoding_of(std::string_view head) {
  if (head.starts_with("\xEF\xBB\xBF")) return {.mark = 3};
  if (head.starts_with("\xFF\xFE")) return {"UTF-16LE", "UTF-16", 2};
  if (head.starts_with("\xFE\xFF")) return {"UTF-16BE", "UTF-16", 2};
  constexpr std::size_t kEnoughToSee = 8;
  if (head.size() >= kEnoughToSee) {
    const int zero = zero_half(head);
    if (zero >= 0) return {zero == 1 ? "UTF-16LE" : "UTF-16BE", "UTF-16", 0};
  }
  if (is_utf8(head)) return {};
  if (looks_cyrillic(head)) return {"CP1251", "Windows-1251", 0};
  return {"CP1252", "Latin-1", 0};  // whose C1 controls nobody writes
}

class ConvertedText final : public ByteSource {
 public:
  ConvertedText(iconv_t converter, std::string says, std::unique_ptr<ByteSource> bytes)
      : converter_(converter), says_(std::move(says)), bytes_(std::move(bytes)), in_(kLookedAt) {}
  ~ConvertedText() override { iconv_close(converter_); }
  ConvertedText(const ConvertedText&) = delete;
  ConvertedText& operator=(const ConvertedText&) = delete;

  Result<std::size_t> read(std::span<char> into) override {
    while (true) {
      if (!ended_ && left_ < in_.size()) {
        const auto got = bytes_->read(std::span(in_).subspan(left_));
        if (!got) return got.error();
        ended_ = *got == 0;
        left_ += *got;
      }
      if (left_ == 0) return std::size_t{0};
      char* from = in_.data();
      char* to = into.data();
      std::size_t room = into.size(), left = left_;
      const bool failed =
          iconv(converter_, &from, &left, &to, &room) == static_cast<std::size_t>(-1);
      const int reason = failed ? errno : 0;
      // CP1252 leaves five bytes without a meaning.
      if (reason == EILSEQ && says_ == "Latin-1" && room > 0) {
        *to++ = '?';
        --room;
        ++from;
        --left;
      } else if (reason == EILSEQ || (reason == EINVAL && ended_)) {
        return Error{ErrorCode::kBadInput,
                     "found bytes that are no " + says_ + " text (is this a text file?)"};
      }
      std::copy(from, from + left, in_.data());
      left_ = left;
      if (room < into.size()) return into.size() - room;
    }
  }

 private:
  iconv_t converter_;
  std::string says_;
  std::unique_ptr<ByteSource> bytes_;
  std::vector<char> in_;
  std::size_t left_ = 0;
  bool ended_ = false;
};

}  // namespace

Result<OpenedText> open_text(std::unique_ptr<ByteSource> bytes) {
  auto head = first_bytes(*bytes, kLookedAt);
  if (!head) return head.error();
  const Encoding encoding = encoding_of(*head);
  OpenedText opened{put_back(head->substr(encoding.mark), std::move(bytes)), encoding.says};
  if (encoding.says.empty()) return opened;
  const iconv_t converter = iconv_open("UTF-8", encoding.name);
  if (converter == reinterpret_cast<iconv_t>(-1)) {  // NOLINT(performance-no-int-to-ptr)
    return Error{ErrorCode::kBadInput, "this machine cannot read " + encoding.says};
  }
  opened.text = std::make_unique<ConvertedText>(converter, encoding.says, std::move(opened.text));
  return opened;
}

}  // namespace fogbench::model
