#include "cli/seal.hpp"

#include <gtest/gtest.h>

#include <string>

namespace fogbench::cli {
namespace {

const std::string kSecret = R"({"effect": "magnetic_hysteresis_z", "amplitude": 0.12})";
const std::string kHash(64, 'a');
const std::string kBeside = R"({"procedure": "coil-sweep"})";

TEST(Seal, OpensToWhatWasSealed) {
  for (const std::size_t size : {0U, 1U, 3055U, 3056U, 3057U, 10000U}) {
    const std::string secret(size, 'x');
    const auto opened = open_seal(seal(secret, kHash, kBeside), kHash, kBeside);
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_EQ(opened->substr(0, size), secret);
    EXPECT_EQ(opened->find_first_not_of(' ', size), std::string::npos);
  }
}

TEST(Seal, SameSecretAndDataGiveTheSameText) {
  EXPECT_EQ(seal(kSecret, kHash, kBeside), seal(kSecret, kHash, kBeside));
  EXPECT_NE(seal(kSecret, kHash, kBeside), seal(kSecret, std::string(64, 'b'), kBeside));
}

TEST(Seal, NeitherTextNorLengthShowsTheSecret) {
  const std::string sealed = seal(kSecret, kHash, kBeside);
  EXPECT_EQ(sealed.size(), seal("", kHash, kBeside).size());
  for (const char* word : {"magnetic", "effect", "amplitude", "0.12"}) {
    EXPECT_EQ(sealed.find(word), std::string::npos) << word;
  }
  // Base64 of "magnetic" from each of the three places in a group.
  for (const char* word : {"bWFnbmV0aW", "1hZ25ldGlj", "tYWduZXRpY"}) {
    EXPECT_EQ(sealed.find(word), std::string::npos) << word;
  }
}

TEST(Seal, AnyChangedLetterBreaksIt) {
  const std::string sealed = seal(kSecret, kHash, kBeside);
  // The first and the last of the text, of the secret, of the padding and of the tag.
  for (const std::size_t at : {0UL, 20UL, 71UL, 2000UL, 4073UL, 4074UL, sealed.size() - 1}) {
    for (const char letter : {'A', 'B', '/', '=', '-', '\n', ' ', '\0', '\xff'}) {
      std::string changed = sealed;
      if (changed[at] == letter) continue;
      changed[at] = letter;
      const auto opened = open_seal(changed, kHash, kBeside);
      ASSERT_FALSE(opened) << at << ' ' << static_cast<int>(letter);
      EXPECT_EQ(opened.error().code, ErrorCode::kBadInput);
    }
  }
}

TEST(Seal, AnyOtherLengthBreaksIt) {
  const std::string sealed = seal(kSecret, kHash, kBeside);
  for (const std::string& text : {std::string(), sealed.substr(1), sealed.substr(0, 100),
                                  sealed + "A", sealed + "\n", sealed + sealed}) {
    EXPECT_FALSE(open_seal(text, kHash, kBeside)) << text.size();
  }
  EXPECT_NE(open_seal("short", kHash, kBeside).error().message.find("5 letters long"),
            std::string::npos);
}

TEST(Seal, OtherDataOrAnotherDescriptionBreaksIt) {
  const std::string sealed = seal(kSecret, kHash, kBeside);
  std::string hash = kHash;
  hash.back() = 'b';
  EXPECT_FALSE(open_seal(sealed, hash, kBeside));
  EXPECT_FALSE(open_seal(sealed, kHash, kBeside + " "));
  EXPECT_FALSE(open_seal(sealed, kHash, ""));
}

}  // namespace
}  // namespace fogbench::cli
