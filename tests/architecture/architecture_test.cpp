// The real tree against the rules. When one of these fails, the message names file and line; what
// to do about it stands in ARCHITECTURE.md.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/architecture/rules.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::tests {
namespace {

using ::testing::IsEmpty;

const Tree& tree() {
  static const Tree kTree = read_tree(tests::source_tree());
  return kTree;
}

TEST(Architecture, TheScannerSeesEveryRoom) {
  for (const auto& [room, seen] : kMaySee) {
    EXPECT_TRUE(std::any_of(tree().begin(), tree().end(), [&room = room](const SourceFile& file) {
      return file.is_cpp() && file.folder() == room;
    })) << room;
  }
}

TEST(Architecture, NoFolderSeesOneThatItMustNot) {
  EXPECT_THAT(forbidden_includes(tree()), IsEmpty());
}

TEST(Architecture, LinkListsAgreeWithTheTableAndTheIncludes) {
  EXPECT_THAT(wrong_links(tree()), IsEmpty());
}

TEST(Architecture, EverySourceIsBuilt) {
  EXPECT_THAT(unlisted_sources(tree()), IsEmpty());
}

TEST(Architecture, EverySourceHasARoom) {
  EXPECT_THAT(homeless_sources(tree()), IsEmpty());
}

TEST(Architecture, EverySourceHasAHeaderOfItsName) {
  EXPECT_THAT(sources_without_header(tree()), IsEmpty());
}

TEST(Architecture, TimeComesFromTheClockAndChanceFromASeed) {
  EXPECT_THAT(machine_time_or_chance(tree()), IsEmpty());
}

TEST(Architecture, OnlyTheRunEngineCommandsDevices) {
  EXPECT_THAT(commands_outside_the_engine(tree()), IsEmpty());
}

TEST(Architecture, NoEffectIsKnownByItsName) {
  EXPECT_THAT(effects_known_by_name(tree()), IsEmpty());
}

TEST(Architecture, NobodyThrows) {
  EXPECT_THAT(thrown_exceptions(tree()), IsEmpty());
}

TEST(Architecture, NoCallCanPickAnotherFilesHelper) {
  EXPECT_THAT(shared_helper_names(tree()), IsEmpty());
}

TEST(Architecture, NoFileIsTooLongToRead) {
  EXPECT_THAT(long_files(tree()), IsEmpty());
}

TEST(Architecture, NothingIsPutOffOrSwitchedOff) {
  EXPECT_THAT(unfinished_work(tree()), IsEmpty());
}

TEST(Architecture, DocumentsNameOnlyWhatExists) {
  const std::filesystem::path root = source_tree();
  const auto exists = [&](const std::string& path) { return std::filesystem::exists(root / path); };
  EXPECT_THAT(dead_references(tree(), exists), IsEmpty());
}

}  // namespace
}  // namespace fogbench::tests
