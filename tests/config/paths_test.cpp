#include "config/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Names a folder in FOGBENCH_CONFIG_DIR while it lives.
class ConfigDirectory {
 public:
  explicit ConfigDirectory(const fs::path& path) {
    setenv("FOGBENCH_CONFIG_DIR", path.c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  }
  ConfigDirectory(const ConfigDirectory&) = delete;
  ConfigDirectory& operator=(const ConfigDirectory&) = delete;
  ~ConfigDirectory() { unsetenv("FOGBENCH_CONFIG_DIR"); }  // NOLINT(concurrency-mt-unsafe)
};

TEST(Paths, ReadyFolderIsFoundBesideTheBuildTree) {
  const auto directory = config_directory();
  ASSERT_TRUE(directory) << directory.error().message;
  EXPECT_EQ(*directory, fs::weakly_canonical(kReady));
}

TEST(Paths, EnvironmentGoesBeforeTheBuildTree) {
  const support::TemporaryFolder folder;
  const ConfigDirectory set(folder.path());
  const auto directory = config_directory();
  ASSERT_TRUE(directory) << directory.error().message;
  EXPECT_EQ(*directory, folder.path());
}

TEST(Paths, EnvironmentThatNamesNoFolderIsAnError) {
  const ConfigDirectory set("/no/such/folder");
  EXPECT_EQ(message_of(config_directory()),
            "FOGBENCH_CONFIG_DIR=/no/such/folder: no such directory");
  EXPECT_THAT(message_of(find_config("models", "thermal")), HasSubstr("no such directory"));
}

TEST(Paths, ShortNameFindsTheReadyFile) {
  const ConfigDirectory set(kReady);
  const auto found = find_config("models", "paper-thermal");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(*found, kReady / "models" / "paper-thermal.json");
}

TEST(Paths, ExistingFileGoesBeforeAReadyOne) {
  const ConfigDirectory set(kReady);
  const support::TemporaryFolder folder;
  const fs::path own = folder.file("thermal", "{}");
  const auto found = find_config("models", own.string());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(*found, own);
}

TEST(Paths, UnknownNameListsTheKnownOnes) {
  const ConfigDirectory set(kReady);
  EXPECT_THAT(
      message_of(find_config("benches", "simulate")),
      HasSubstr("simulate: no such file, and none of the ready benches (factory, simulated, "
                "simulated-1khz, simulated-auxiliary, simulated-chamber); did you mean "
                "\"simulated\"?"));
}

TEST(Paths, WhatIsNoFileIsSaidToBeWhatItIs) {
  const ConfigDirectory set(kReady);
  const support::TemporaryFolder folder;
  EXPECT_THAT(message_of(find_config("models", folder.path().string())),
              HasSubstr("is a directory, a file was expected"));
  EXPECT_THAT(message_of(find_config("models", "/dev/null")), HasSubstr("is not a regular file"));
  const std::string loop = (folder / "loop.json").string();
  fs::create_symlink(loop, loop);
  EXPECT_THAT(message_of(find_config("models", loop)), HasSubstr("symbolic links"));
}

}  // namespace
}  // namespace fogbench::config
