#pragma once
// The seal of a challenge: text that a person cannot read by looking at the file.
//
//   key, nonce   first bytes of SHA-256(fixed text | hash of the data)
//   sealed       base64(AES-256-GCM(secret, padded with spaces; tag)), `beside` authenticated
//
// It keeps an honest person from seeing the answer by accident (cat, strings, grep, a decompressor)
// and shows when the data or the description beside it are not what was sealed. It is no protection
// against an attacker: whoever reads this file can open it. The secret is padded to whole blocks,
// and not compressed, so that the seal's length does not tell how much there is to hide.

#include <string>
#include <string_view>

#include "config/result.hpp"

namespace fogbench::cli {

/// `data_sha256` and `beside` are what the seal opens with: the same bytes, or not at all. The same
/// arguments give the same text.
std::string seal(std::string_view secret, std::string_view data_sha256, std::string_view beside);

/// The secret, with its padding. kBadInput, without the file's name, when the text is not a seal,
/// or not the one of these data.
Result<std::string> open_seal(std::string_view sealed, std::string_view data_sha256,
                              std::string_view beside);

}  // namespace fogbench::cli
