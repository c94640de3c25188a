#include "cli/challenge_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "record/file_hash.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ChallengeFileTest : public testing::Test {
 protected:
  ChallengeFileTest() {
    secret_.seed = "18446744073709551615";
    secret_.scenario.terms = {{"bias", 0.7}};
    secret_.scenario.hidden = {{"magnetic_hysteresis_z", -0.12, {{"width", 0.6}}}};
    secret_.visible_deg_per_h = {0.03};
    secret_.noise_deg_per_h = 0.007;
    const std::string hash = *record::file_sha256(data_);
    text_ = sealed_text({.says = "A gyro.",
                         .software_version = "1",
                         .noise = "navigation",
                         .procedure = "coil-sweep",
                         .set = {{"average_s", {60.0}}},
                         .data_sha256 = hash},
                        secret_);
    folder_.file(kSealedFile, text_);
  }
  /// The error after `from` has become `to` in sealed.json.
  std::string changed(const std::string& from, const std::string& to) const {
    std::string text = text_;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    folder_.file(kSealedFile, text.replace(at, from.size(), to));
    return error();
  }
  std::string error() const {
    const auto opened = open_challenge(folder_.path());
    if (opened) return "opened";
    EXPECT_EQ(opened.error().code, ErrorCode::kBadInput);
    return opened.error().message;
  }

  support::TemporaryFolder folder_;
  std::filesystem::path data_ = folder_.file(kMeasurementsFile, "rate_deg_per_h\n0.5\n0.6\n");
  ChallengeSecret secret_;
  std::string text_;
};

TEST_F(ChallengeFileTest, OpensToWhatWasSealed) {
  const auto opened = open_challenge(folder_.path());
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ(opened->seed, secret_.seed);
  EXPECT_EQ(opened->scenario.terms, secret_.scenario.terms);
  ASSERT_EQ(opened->scenario.hidden.size(), 1U);
  EXPECT_EQ(opened->scenario.hidden[0].effect, "magnetic_hysteresis_z");
  EXPECT_EQ(opened->scenario.hidden[0].amplitude, -0.12);
  EXPECT_EQ(opened->scenario.hidden[0].parameters, secret_.scenario.hidden[0].parameters);
  EXPECT_EQ(opened->visible_deg_per_h, secret_.visible_deg_per_h);
  EXPECT_EQ(opened->noise_deg_per_h, 0.007);
}

TEST_F(ChallengeFileTest, NothingHiddenIsSealedToo) {
  ChallengeSecret nothing;
  nothing.seed = "1";
  const std::string text = sealed_text({.says = "A gyro.",
                                        .software_version = "1",
                                        .noise = "none",
                                        .procedure = "static-record",
                                        .data_sha256 = *record::file_sha256(data_)},
                                       nothing);
  folder_.file(kSealedFile, text);
  const auto opened = open_challenge(folder_.path());
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_TRUE(opened->scenario.hidden.empty());
}

TEST_F(ChallengeFileTest, ShowsWhatEverybodyMayReadAndNothingElse) {
  EXPECT_THAT(text_, HasSubstr("coil-sweep"));
  for (const char* hidden : {"hysteresis", "width", "0.12", "0.6}", "1844674407", "0.007"}) {
    EXPECT_THAT(text_, Not(HasSubstr(hidden)));
  }
}

TEST_F(ChallengeFileTest, ChangedDataBreakTheSeal) {
  folder_.file(kMeasurementsFile, "rate_deg_per_h\n0.5\n0.7\n");
  EXPECT_THAT(error(), HasSubstr("measurements.csv: found SHA-256 "));
}

TEST_F(ChallengeFileTest, ChangedDataWithTheirNewHashBreakTheSealToo) {
  const std::string before = *record::file_sha256(data_);
  folder_.file(kMeasurementsFile, "rate_deg_per_h\n0.5\n0.7\n");
  EXPECT_THAT(changed(before, *record::file_sha256(data_)), HasSubstr("the seal is broken"));
}

TEST_F(ChallengeFileTest, AnythingChangedBreaksTheSeal) {
  EXPECT_THAT(changed("coil-sweep", "coil-sweeps"), HasSubstr("/seal: the seal is broken"));
  EXPECT_THAT(changed("60.0", "61.0"), HasSubstr("/seal: the seal is broken"));
  EXPECT_THAT(changed("navigation", "tactical"), HasSubstr("/seal: the seal is broken"));
  EXPECT_THAT(changed("\"hidden\": \"7b22", "\"hidden\": \"7b23"),
              HasSubstr("/seal: the seal is broken"));
  EXPECT_THAT(changed("\"seal\": \"", "\"seal\": \"0"), HasSubstr("/seal: the seal is broken"));
}

TEST_F(ChallengeFileTest, ASealOfAnOlderVersionIsSaidToBeOne) {
  const auto begin = text_.find("\"hidden\""), end = text_.find("\"seal\"");
  EXPECT_THAT(changed(text_.substr(begin, end - begin), ""), HasSubstr("older version"));
}

TEST_F(ChallengeFileTest, ACutOrDamagedFileIsSaidToBeSo) {
  EXPECT_THAT(changed(text_.substr(text_.size() / 2), ""), HasSubstr("sealed.json: line "));
  EXPECT_THAT(changed(text_.substr(text_.size() - 40, 30), ""), HasSubstr("the seal is broken"));
  EXPECT_THAT(changed("\"seal\"", "\"sael\""), HasSubstr("sael"));
  EXPECT_THAT(changed("\"says\": \"A gyro.\"", "\"says\": 7"), HasSubstr("/says"));
}

TEST_F(ChallengeFileTest, AMissingFileIsNamed) {
  std::filesystem::remove(data_);
  EXPECT_THAT(error(), HasSubstr("measurements.csv"));
  std::filesystem::remove(folder_ / kSealedFile);
  EXPECT_THAT(error(), HasSubstr("sealed.json"));
}

}  // namespace
}  // namespace fogbench::cli
