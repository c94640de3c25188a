// The rules against a tiny tree made up in memory: each must find what it is there to find, and
// leave alone what is allowed.

#include "tests/architecture/rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace fogbench::tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

SourceFile file(const std::string& path, const std::string& text) {
  return {path, text, blank_comments(text, false), blank_comments(text, true)};
}

TEST(ForbiddenIncludes, FindsARoomThatMustNotBeSeen) {
  const Tree tree{file("model/fit.cpp", "#include \"simulator/plant.hpp\"\n"),
                  file("simulator/plant.hpp", "")};
  EXPECT_THAT(forbidden_includes(tree), ElementsAre(HasSubstr("model must not see simulator")));
}

TEST(ForbiddenIncludes, FindsAPathThatIsNotRooted) {
  const Tree tree{file("model/fit.cpp", "#include \"../config/units.hpp\"\n"),
                  file("config/units.hpp", "")};
  EXPECT_THAT(forbidden_includes(tree), ElementsAre(HasSubstr("no such file")));
}

TEST(EffectsKnownByName, FindsAComparisonAndACutButNoColumn) {
  const Tree tree{file("model/fit.cpp",
                       "if (id == \"warm_up\") return;\n"
                       "if (id.starts_with(\"magnetic_linear_\")) return;\n"
                       "if (name == \"temperature_rate_c_per_h\") return;\n"),
                  file("model/effects/loop.cpp", "if (id == \"warm_up\") return;\n")};
  EXPECT_THAT(effects_known_by_name(tree),
              ElementsAre(HasSubstr("model/fit.cpp:1"), HasSubstr("model/fit.cpp:2")));
}

TEST(ForbiddenIncludes, AllowsTheArrowsTheOwnRoomAndTests) {
  const Tree tree{file("drivers/a.hpp", "# include \"config/units.hpp\"\n"),
                  file("config/units.hpp", "#include <string>\n"),
                  file("drivers/a.cpp", "#include \"drivers/a.hpp\"\n"),
                  file("tests/system/b_test.cpp", "#include \"drivers/a.hpp\"\n")};
  EXPECT_THAT(forbidden_includes(tree), IsEmpty());
}

TEST(ForbiddenIncludes, IgnoresIncludesInComments) {
  const Tree tree{file("model/fit.cpp",
                       "// #include \"simulator/plant.hpp\"\n"
                       "/*\n#include \"simulator/plant.hpp\"\n*/\n")};
  EXPECT_THAT(forbidden_includes(tree), IsEmpty());
}

TEST(ForbiddenIncludes, AllowsWhatTheBuildMakes) {
  const Tree tree{
      file("model/a.cpp", "#include \"model/families.hpp\"\n#include \"model/page.css.hpp\"\n"),
      file("model/families.hpp.in", ""), file("model/page.css", "")};
  EXPECT_THAT(forbidden_includes(tree), IsEmpty());
}

TEST(WrongLinks, FindsALinkAgainstTheTable) {
  const Tree tree{file("procedures/CMakeLists.txt",
                       "fogbench_library(procedures SOURCES a.cpp PUBLIC fogbench::simulator)\n"
                       "# fogbench::cli is only talked about\n")};
  EXPECT_THAT(wrong_links(tree), ElementsAre(HasSubstr("procedures must not see simulator")));
}

TEST(WrongLinks, FindsAnIncludeWithoutALink) {
  const Tree tree{file("drivers/CMakeLists.txt", "fogbench_library(drivers SOURCES a.cpp)"),
                  file("drivers/a.cpp", "#include \"config/units.hpp\"\n")};
  EXPECT_THAT(wrong_links(tree), ElementsAre(HasSubstr("does not link fogbench::config")));
}

TEST(UnlistedSources, FindsATestThatWasForgotten) {
  const Tree tree{file("tests/model/CMakeLists.txt", "fogbench_test(m SOURCES fit_test.cpp)"),
                  file("tests/model/fit_test.cpp", ""), file("tests/model/lost_test.cpp", "")};
  EXPECT_THAT(unlisted_sources(tree), ElementsAre(HasSubstr("tests/model/lost_test.cpp")));
}

TEST(UnlistedSources, LeavesARoomToItsPattern) {
  EXPECT_THAT(unlisted_sources({file("model/CMakeLists.txt", "fogbench_library(model)"),
                                file("model/effects/bias.cpp", "")}),
              IsEmpty());
}

TEST(HomelessSources, FindsAFolderThatTheTableDoesNotKnow) {
  const Tree tree{file("misc/helper.cpp", ""), file("tests/cli/a_test.cpp", "")};
  EXPECT_THAT(homeless_sources(tree), ElementsAre(HasSubstr("misc/helper.cpp")));
}

TEST(SourcesWithoutHeader, FindsAPartOfAnotherFile) {
  const Tree tree{file("model/fit/fit.hpp", ""),
                  file("model/fit/fit.cpp", ""),
                  file("model/fit/fit_results.cpp", ""),
                  file("cli/command.hpp", "void add_fit();"),
                  file("cli/fit.cpp", ""),
                  file("cli/fit_text.cpp", "")};
  EXPECT_THAT(sources_without_header(tree),
              ElementsAre(HasSubstr("model/fit/fit_results.cpp has no model/fit/fit_results.hpp"),
                          HasSubstr("cli/fit_text.cpp")));
}

TEST(SourcesWithoutHeader, AcceptsProgramsFamiliesOfEffectsAndTests) {
  EXPECT_THAT(
      sources_without_header(
          {file("daemon/main.cpp", ""), file("model/effects/catalogue/bias.cpp", ""),
           file("simulator/effects/catalogue/drift.cpp", ""), file("tests/cli/a_test.cpp", "")}),
      IsEmpty());
}

TEST(MachineTimeOrChance, FindsTheMachinesClockAndUnseededChance) {
  const Tree tree{
      file("daemon/a.cpp", "\nauto t = std::chrono::system_clock::now();\n"),
      file("cli/b.cpp", "std::this_thread::sleep_for(1s);"),
      file("simulator/c.cpp", "std::random_device seed; int r = rand();"),
  };
  EXPECT_THAT(machine_time_or_chance(tree),
              ElementsAre(HasSubstr("daemon/a.cpp:2: `system_clock`"), HasSubstr("this_thread"),
                          HasSubstr("random_device"), HasSubstr("rand(")));
}

TEST(MachineTimeOrChance, AllowsTheClockItselfItsUsersAndTests) {
  const Tree tree{
      file("drivers/clock.cpp", "std::chrono::steady_clock::now();"),
      file("procedures/a.cpp", "clock_.sleep_until(clock_.now() + 1s);  // not steady_clock"),
      file("tests/system/kill_test.cpp", "std::this_thread::sleep_for(1s);"),
  };
  EXPECT_THAT(machine_time_or_chance(tree), IsEmpty());
}

TEST(CommandsOutsideTheEngine, FindsACommandInTheDaemon) {
  const Tree tree{file("daemon/a.cpp", "bench.coil_vertical->set_current(Ampere{1.0});"),
                  file("procedures/b.cpp", "bench.coil_vertical->set_current(Ampere{1.0});")};
  EXPECT_THAT(commands_outside_the_engine(tree), ElementsAre(HasSubstr("daemon/a.cpp:1")));
}

TEST(ThrownExceptions, FindsAThrowAndIgnoresTheWordInText) {
  const Tree tree{file("config/a.cpp", "throw 1;"),
                  file("config/b.cpp", "// throw\nconst char* s = \"throw\"; bool nothrow_;")};
  EXPECT_THAT(thrown_exceptions(tree), ElementsAre(HasSubstr("config/a.cpp:1")));
}

TEST(SharedHelperNames, FindsTwoOfOneRoomAndThoseOfHeaders) {
  const std::string text = "namespace a {\nnamespace {\nint text_of(double v) {\n}\n}\n}\n";
  const Tree tree{file("cli/a.cpp", text),
                  file("cli/b/c.cpp", text),
                  file("daemon/a.cpp", text),
                  file("model/a.cpp", "namespace {\nint digits(\n    const std::string& of);\n}\n"),
                  file("config/a.hpp", "std::string digits();\n"),
                  file("tests/cli/a.hpp", "inline int text_of(int v) {\n}\n"),
                  file("tests/cli/a_test.cpp", text)};
  EXPECT_THAT(shared_helper_names(tree),
              ElementsAre(HasSubstr("cli/b/c.cpp and cli/a.cpp both have a function `text_of`"),
                          HasSubstr("model/a.cpp and config/a.hpp both have a function `digits`"),
                          HasSubstr("tests/cli/a_test.cpp and tests/cli/a.hpp both have")));
}

TEST(SharedHelperNames, AcceptsAnOverloadOnATypeOfTheProject) {
  const Tree tree{
      file("tests/cli/a_test.cpp", "namespace {\nint text_of(double value) {}\n}\n"),
      file("tests/cli/b_test.cpp", "namespace {\nint text_of(const Plan& plan) {}\n}\n"),
      file("tests/model/a_test.cpp", "namespace {\nint text_of(double value) {}\n}\n"),
      file("cli/a.cpp", "namespace {\nint b;\n}\nint text_of(double value) {}\n"),
      file("cli/c.cpp", "namespace {\nint text_of() {}\n}\nbool C::text_of() const {}\n"),
      file("cli/c.hpp", "int text_of(Plan plan);\nstruct C {\n  bool text_of() const;\n};\n")};
  EXPECT_THAT(shared_helper_names(tree), IsEmpty());
}

TEST(LongFiles, FindsTheFirstLineTooMany) {
  const Tree tree{file("cli/a.cpp", std::string(kMostLines, '\n')),
                  file("cli/b.cpp", std::string(kMostLines + 1, '\n'))};
  EXPECT_THAT(long_files(tree), ElementsAre(HasSubstr("cli/b.cpp: 601 lines")));
}

TEST(UnfinishedWork, FindsNotesAndSwitchedOffTests) {
  // Put together here, so that this file is not found itself.
  const std::string note = std::string("TO") + "DO";
  const std::string disabled = std::string("DISABLED") + "_Works";
  const std::string skip = std::string("GTEST_") + "SKIP";
  const Tree tree{file("cli/a.cpp", "// " + note + " later\n"),
                  file("tests/cli/a_test.cpp", "TEST(A, " + disabled + ") { " + skip + "(); }"),
                  file("scripts/demo", "mktemp -d /tmp/demo.XXXXXX\n")};
  EXPECT_THAT(unfinished_work(tree),
              ElementsAre(HasSubstr("cli/a.cpp:1"), HasSubstr(disabled), HasSubstr(skip)));
}

TEST(DeadReferences, FindsAPathThatWentAway) {
  const Tree tree{file("README.md",
                       "see `config/units.hpp`, `model/gone.hpp`, `coil_z/down`, "
                       "`config/models/NAME.json` and `fogbench fit`")};
  const auto exists = [](const std::string& path) { return path == "config/units.hpp"; };
  EXPECT_THAT(dead_references(tree, exists), ElementsAre(HasSubstr("`model/gone.hpp`")));
}

TEST(BlankComments, KeepsLinesAndKnowsLiterals) {
  EXPECT_EQ(blank_comments("a /* b\nc */ d // e\nf", false), "a     \n     d     \nf");
  EXPECT_EQ(blank_comments("x(\"// no comment\"); y", false), "x(               ); y");
  EXPECT_EQ(blank_comments("x(\"// no comment\"); // y", true), "x(\"// no comment\");     ");
  EXPECT_EQ(blank_comments("n = 1'000'000; // k", false), "n = 1'000'000;     ");
  EXPECT_EQ(blank_comments("c = '\"'; s = \"\\\"//\"; z", false), "c =    ; s =       ; z");
  EXPECT_EQ(blank_comments("R\"(// \" text)\"; // y", true), "R\"(// \" text)\";     ");
}

TEST(ReadTree, ReadsFilesFromDiskAndLeavesBuildTreesOut) {
  const std::filesystem::path root =
      std::filesystem::path(::testing::TempDir()) / "fogbench_read_tree";
  std::filesystem::remove_all(root);
  for (const char* name : {"model/fit.cpp", "build/release/x.cpp", ".git/y.cpp", ".ci/run",
                           "out/CMakeCache.txt", "out/z.cpp", "config/data/table.csv"}) {
    std::filesystem::create_directories((root / name).parent_path());
    std::ofstream(root / name) << "#include \"config/units.hpp\"\n";
  }
  const Tree tree = read_tree(root);
  ASSERT_EQ(tree.size(), 2U);
  EXPECT_EQ(tree[0].path, ".ci/run");
  EXPECT_EQ(tree[1].path, "model/fit.cpp");
  EXPECT_THAT(quoted_includes(tree[1]), ElementsAre("config/units.hpp"));
  std::filesystem::remove_all(root);
}

}  // namespace
}  // namespace fogbench::tests
