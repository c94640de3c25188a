#include "cli/common_options.hpp"

#include <gtest/gtest.h>

#include "cli/control_client.hpp"

namespace fogbench::cli {
namespace {

TEST(CommonOptions, WhatIsProposedNextIsQuotedForTheShell) {
  EXPECT_EQ(store_argument(""), "");
  EXPECT_EQ(store_argument("try.db"), " --store try.db");
  EXPECT_EQ(store_argument("a b/it's.db"), R"( --store 'a b/it'\''s.db')");
  EXPECT_EQ(socket_argument(""), "");
  EXPECT_EQ(socket_argument("/run/my bench.sock"), " --socket '/run/my bench.sock'");
}

TEST(CommonOptions, RunsAreNumberedFromOne) {
  EXPECT_EQ(wrong_run_number("1"), "");
  EXPECT_EQ(wrong_run_number("9223372036854775807"), "");
  EXPECT_EQ(wrong_run_number("0"), "there is no run 0: they are numbered from 1");
  for (const char* text : {"", "-1", "9223372036854775808", "1.5", "1 ", "one"}) {
    EXPECT_EQ(wrong_run_number(text), std::string("the number of a run was expected, not ") + text);
  }
}

}  // namespace
}  // namespace fogbench::cli
