#include "cli/seal.hpp"

#include <openssl/evp.h>

#include <array>
#include <memory>

namespace fogbench::cli {
namespace {

constexpr std::size_t kTagBytes = 16;
/// One for nothing, one effect or two. Its bytes make whole groups of base64, which then has one
/// spelling only.
constexpr std::size_t kBlockBytes = 3072;

using Hash = std::array<unsigned char, 32>;
using Cipher = std::unique_ptr<EVP_CIPHER_CTX, decltype(&EVP_CIPHER_CTX_free)>;

const unsigned char* bytes(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}
unsigned char* bytes(std::string& text) {
  return reinterpret_cast<unsigned char*>(text.data());
}
int length(std::string_view text) {
  return static_cast<int>(text.size());
}

Hash hash(std::string text, std::string_view data_sha256) {
  text += data_sha256;
  Hash digest{};
  EVP_Digest(text.data(), text.size(), digest.data(), nullptr, EVP_sha256(), nullptr);
  return digest;
}

/// The cipher, set to the data's key, with `beside` taken in. A key never seals two secrets that
/// differ, unless they had made the same data, so that the nonce may follow from the data too.
Cipher cipher_for(std::string_view data_sha256, std::string_view beside, bool encrypt) {
  Cipher cipher(EVP_CIPHER_CTX_new(), &EVP_CIPHER_CTX_free);
  const Hash key = hash("fogbench challenge: key ", data_sha256);
  // The cipher takes the first 12 bytes, what GCM is made for.
  const Hash nonce = hash("fogbench challenge: nonce ", data_sha256);
  EVP_CipherInit_ex(cipher.get(), EVP_aes_256_gcm(), nullptr, key.data(), nonce.data(),
                    encrypt ? 1 : 0);
  int done = 0;
  EVP_CipherUpdate(cipher.get(), nullptr, &done, bytes(beside), length(beside));
  return cipher;
}

}  // namespace

std::string seal(std::string_view secret, std::string_view data_sha256, std::string_view beside) {
  const std::size_t blocks = (secret.size() + kTagBytes) / kBlockBytes + 1;
  std::string padded(secret);
  padded.resize(blocks * kBlockBytes - kTagBytes, ' ');

  const Cipher cipher = cipher_for(data_sha256, beside, true);
  std::string hidden(blocks * kBlockBytes, '\0');
  int done = 0, rest = 0;
  EVP_CipherUpdate(cipher.get(), bytes(hidden), &done, bytes(padded), length(padded));
  EVP_CipherFinal_ex(cipher.get(), bytes(hidden) + done, &rest);
  EVP_CIPHER_CTX_ctrl(cipher.get(), EVP_CTRL_GCM_GET_TAG, kTagBytes, bytes(hidden) + padded.size());

  std::string text(hidden.size() / 3 * 4 + 1, '\0');  // the last is the zero that it is ended by
  EVP_EncodeBlock(bytes(text), bytes(hidden), length(hidden));
  text.pop_back();
  return text;
}

Result<std::string> open_seal(std::string_view sealed, std::string_view data_sha256,
                              std::string_view beside) {
  constexpr std::size_t kBlockText = kBlockBytes / 3 * 4;
  if (sealed.empty() || sealed.size() % kBlockText != 0) {
    return Error{ErrorCode::kBadInput,
                 "the seal is broken: it is " + std::to_string(sealed.size()) +
                     " letters long, expected a multiple of " + std::to_string(kBlockText)};
  }
  std::string hidden(sealed.size() / 4 * 3, '\0');
  const Error broken{ErrorCode::kBadInput,
                     "the seal is broken: it, or what stands beside it, is not as it was made"};
  if (EVP_DecodeBlock(bytes(hidden), bytes(sealed), length(sealed)) != length(hidden)) {
    return broken;
  }
  const std::size_t size = hidden.size() - kTagBytes;

  const Cipher cipher = cipher_for(data_sha256, beside, false);
  std::string secret(size, '\0');
  int done = 0, rest = 0;
  EVP_CipherUpdate(cipher.get(), bytes(secret), &done, bytes(hidden), static_cast<int>(size));
  EVP_CIPHER_CTX_ctrl(cipher.get(), EVP_CTRL_GCM_SET_TAG, kTagBytes, bytes(hidden) + size);
  if (EVP_CipherFinal_ex(cipher.get(), bytes(secret) + done, &rest) != 1) return broken;
  return secret;
}

}  // namespace fogbench::cli
