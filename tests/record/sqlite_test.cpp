#include "record/sqlite.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace fogbench::record {
namespace {

TEST(Statement, ValueThatCannotBeBoundFailsTheStep) {
  const support::TemporaryFolder folder;
  const auto database = Database::open(folder / "new.db", Database::Mode::kCreate);
  ASSERT_TRUE(database);
  auto select = (*database)->prepare("SELECT ?");
  ASSERT_TRUE(select);
  const auto failed = select->bind(1.0).bind("one too many").step();
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kStore);
  EXPECT_NE(failed.error().message.find("new.db: a value cannot be stored: "), std::string::npos);

  const auto again = select->bind(2.5).step();
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(select->real(0), 2.5);
}

}  // namespace
}  // namespace fogbench::record
