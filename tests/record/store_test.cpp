#include "record/store.hpp"
#include "procedures/channel_values.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::record {
namespace {

using support::read_text;

void expect_refused(const std::filesystem::path& path, ErrorCode code, const std::string& says) {
  for (const bool writing : {false, true}) {
    const auto store = writing ? open_store_for_writing(path) : open_store(path);
    ASSERT_FALSE(store) << says;
    EXPECT_EQ(store.error().code, code) << store.error().message;
    EXPECT_NE(store.error().message.find(says), std::string::npos) << store.error().message;
    EXPECT_EQ(store.error().message.find('\n'), std::string::npos);
  }
}

TEST(Store, IsMadeCompleteWithNothingLeftBeside) {
  const support::TemporaryFolder folder;
  { ASSERT_TRUE(open_store_for_writing(folder / "new.db")); }
  EXPECT_EQ(folder.entries(), 1U);
  EXPECT_TRUE(open_store(folder / "new.db"));
}

TEST(Store, RefusesWhatIsNotARunLog) {
  const support::TemporaryFolder folder;
  std::string junk(5000, '\0');
  for (std::size_t i = 0; i < junk.size(); ++i) junk[i] = static_cast<char>(i * 37);
  expect_refused(folder.file("junk.db", junk), ErrorCode::kBadInput, "not an SQLite database");
  expect_refused(folder.file("text.db", "hello"), ErrorCode::kBadInput, "not a");
  expect_refused(folder.path(), ErrorCode::kBadInput, "not a regular file");
  std::filesystem::create_symlink(folder / "loop.db", folder / "loop.db");
  expect_refused(folder / "loop.db", ErrorCode::kBadInput, "symbolic links");
  EXPECT_EQ(read_text(folder / "junk.db"), junk);
}

TEST(Store, AnEmptyFileBecomesOne) {
  const support::TemporaryFolder folder;
  const auto empty = folder.file("empty.db", "");
  const auto read = open_store(empty);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(read.error().message, empty.string() + ": empty, no run log yet");
  EXPECT_EQ(std::filesystem::file_size(empty), 0U) << "a reader makes nothing";
  { ASSERT_TRUE(open_store_for_writing(empty)); }
  EXPECT_TRUE(open_store(empty));
  EXPECT_TRUE(open_store_for_writing(empty)) << "and is one then";
}

TEST(Store, ALinkToOneThatIsStillToBeMadeIsFollowed) {
  const support::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "disk");
  std::filesystem::create_symlink("disk/real.db", folder / "near.db");
  std::filesystem::create_symlink(folder / "near.db", folder / "far.db");
  { ASSERT_TRUE(open_store_for_writing(folder / "far.db")); }
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "far.db"));
  EXPECT_TRUE(std::filesystem::is_regular_file(folder / "disk/real.db"));
  EXPECT_TRUE(open_store(folder / "near.db"));
}

TEST(Store, RefusesAnotherProgramsDatabase) {
  const support::TemporaryFolder folder;
  {
    const auto other = Database::open(folder / "other.db", Database::Mode::kCreate);
    ASSERT_TRUE(other);
    ASSERT_TRUE((*other)->execute("CREATE TABLE runs (x)"));
  }
  expect_refused(folder / "other.db", ErrorCode::kBadInput, "another program");
}

TEST(Store, RefusesANewerSchema) {
  const support::TemporaryFolder folder;
  {
    const auto store = open_store_for_writing(folder / "new.db");
    ASSERT_TRUE(store);
    ASSERT_TRUE((*store)->execute("PRAGMA user_version = 99"));
  }
  expect_refused(folder / "new.db", ErrorCode::kBadInput, "newer fogbench (schema 99");
}

TEST(Store, RefusesAMissingFolderAndAMissingFile) {
  const support::TemporaryFolder folder;
  const auto write = open_store_for_writing(folder / "no/such.db");
  ASSERT_FALSE(write);
  EXPECT_EQ(write.error().code, ErrorCode::kStore);
  const auto read = open_store(folder / "missing.db");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(Store, SaysThatAnotherProgramHoldsIt) {
  const support::TemporaryFolder folder;
  const auto store = open_store_for_writing(folder / "store.db");
  const auto other = open_store_for_writing(folder / "store.db");
  ASSERT_TRUE(store && other);
  ASSERT_TRUE((*store)->execute("PRAGMA busy_timeout = 20"));  // seconds otherwise
  const auto held = Transaction::begin(**other);
  ASSERT_TRUE(held);
  const auto refused = Transaction::begin(**store);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kStore);
  EXPECT_NE(refused.error().message.find("locked by another program"), std::string::npos);
}

TEST(Store, ReportsAFullDisk) {
  const support::TemporaryFolder folder;
  const auto store = open_store_for_writing(folder / "store.db");
  ASSERT_TRUE(store);
  ASSERT_TRUE((*store)->execute("PRAGMA max_page_count = 1"));  // fewer than it has: none to come
  auto transaction = Transaction::begin(**store);
  ASSERT_TRUE(transaction);
  const Status full =
      (*store)->execute("INSERT INTO channels VALUES ('x', hex(zeroblob(100000)), '', '')");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kStore);
  EXPECT_NE(full.error().message.find("the disk is full"), std::string::npos);
}

TEST(Store, OfAnOlderVersionGetsTheColumnsThatCameLater) {
  const support::TemporaryFolder folder;
  const auto path = folder / "store.db";
  {
    const auto store = open_store_for_writing(path);
    ASSERT_TRUE(store);
    ASSERT_TRUE((*store)->execute(
        "ALTER TABLE points DROP COLUMN current_vertical_a;"
        "DELETE FROM channels WHERE name = 'current_vertical_a' AND \"table\" = 'points'"));
  }
  const std::string there =
      "SELECT count(*) FROM pragma_table_info('points') WHERE name = 'current_vertical_a'";
  EXPECT_EQ(*(*open_store(path))->integer(there), 0);
  const auto store = open_store_for_writing(path);
  ASSERT_TRUE(store) << store.error().message;
  EXPECT_EQ(*(*store)->integer(there), 1);
  EXPECT_EQ(*(*store)->integer("SELECT count(*) FROM channels"),
            static_cast<std::int64_t>(procedures::point_channels().size() +
                                      procedures::monitor_channels().size()));
}

TEST(Store, DescribesEveryColumnWithItsUnit) {
  const support::TemporaryFolder folder;
  const auto store = open_store_for_writing(folder / "store.db");
  ASSERT_TRUE(store);
  EXPECT_EQ(*(*store)->integer("SELECT count(*) FROM channels WHERE unit = ''"), 0);
  EXPECT_EQ(*(*store)->integer("SELECT count(*) FROM channels"),
            static_cast<std::int64_t>(procedures::point_channels().size() +
                                      procedures::monitor_channels().size()));
  EXPECT_EQ(*(*store)->integer("SELECT count(*) FROM channels WHERE \"table\" = 'points' AND "
                               "name = 'rate_deg_per_h' AND unit = 'deg/h'"),
            1);
}

TEST(Store, IsDocumentedColumnByColumn) {
  const support::TemporaryFolder folder;
  const auto store = open_store_for_writing(folder / "store.db");
  ASSERT_TRUE(store);
  const std::string document = read_text(tests::source_tree() / "record/run-log.md");
  auto columns = (*store)->prepare(
      "SELECT m.name, c.name FROM sqlite_schema m JOIN pragma_table_info(m.name) c "
      "WHERE m.type = 'table' AND m.name NOT LIKE 'sqlite%'");
  ASSERT_TRUE(columns);
  int count = 0;
  while (*columns->step()) {
    ++count;
    EXPECT_NE(document.find("`" + columns->text(1) + "`"), std::string::npos)
        << columns->text(0) << "." << columns->text(1);
  }
  EXPECT_GT(count, 60);
}

TEST(DefaultStore, FollowsTheEnvironmentInItsOrder) {
  setenv("HOME", "/home/x", 1);
  setenv("XDG_STATE_HOME", "/state", 1);
  setenv("FOGBENCH_STORE", "/a/b.db", 1);
  EXPECT_EQ(*default_store(), "/a/b.db");
  unsetenv("FOGBENCH_STORE");
  EXPECT_EQ(*default_store(), "/state/fogbench/fogbench.db");
  unsetenv("XDG_STATE_HOME");
  EXPECT_EQ(*default_store(), "/home/x/.local/state/fogbench/fogbench.db");
  unsetenv("HOME");
  const auto none = default_store();
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kBadInput);
}

TEST(DefaultStore, ItsFolderIsMade) {
  const support::TemporaryFolder folder;
  setenv("FOGBENCH_STORE", (folder / "deep/er/store.db").c_str(), 1);
  EXPECT_TRUE(open_store_for_writing(*default_store()));
  unsetenv("FOGBENCH_STORE");
}

}  // namespace
}  // namespace fogbench::record
