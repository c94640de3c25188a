#pragma once
// A file's bytes as text in UTF-8, whichever way they were written: UTF-8 and UTF-16 with or
// without a byte order mark, else Windows-1251 or Latin-1, recognised on the first 64 KiB.

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "model/table/byte_source.hpp"

namespace fogbench::model {

/// What is looked at to recognise how a file is written.
inline constexpr std::size_t kLookedAt = std::size_t{1} << 16;

struct OpenedText {
  std::unique_ptr<ByteSource> text;  ///< UTF-8, no byte order mark
  std::string encoding;              ///< "UTF-16", "Windows-1251", "Latin-1"; empty: UTF-8
};

/// The text behind `bytes`. Errors of reading later: also text that is broken in its encoding.
Result<OpenedText> open_text(std::unique_ptr<ByteSource> bytes);

}  // namespace fogbench::model
