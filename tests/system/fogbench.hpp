#pragma once
// The executables as the tests of this folder run them: in a folder of their own, on a procedure
// that is over in a moment.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/own_locks.hpp"
#include "tests/support/process.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::system_tests {

using support::Finished;
using support::Process;

/// A sweep of five levels along each axis, seconds each.
inline const std::vector<std::string> kQuickSweep = {"coil-sweep", "--set", "average_s=3", "--set",
                                                     "levels_ut=0,300,0,-300,0"};

class FogbenchTest : public testing::Test {
 protected:
  /// A command that forgets --store must not reach the developer's own.
  FogbenchTest() { setenv("FOGBENCH_STORE", (folder_ / "default" / "store.db").c_str(), 1); }

  std::string store() const { return (folder_ / "store.db").string(); }

  static std::vector<std::string> command(std::vector<std::string> arguments,
                                          const std::string& program = "fogbench") {
    arguments.insert(arguments.begin(), (tests::build_tree() / program).string());
    return arguments;
  }
  static Finished fogbench(const std::vector<std::string>& arguments,
                           const Process::Setup& setup = {}) {
    return support::run(command(arguments), setup);
  }

  /// dry-run of `procedure` into store(), with more arguments.
  std::vector<std::string> dry_run(std::vector<std::string> procedure,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"dry-run", "--store", store()};
    arguments.insert(arguments.end(), procedure.begin(), procedure.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return command(arguments);
  }

  /// Succeeds and parses its only document.
  static nlohmann::json json(const std::vector<std::string>& arguments) {
    const Finished done = fogbench(arguments);
    EXPECT_EQ(done.status, 0) << done.err;
    return nlohmann::json::parse(done.out, nullptr, false);
  }

  /// One line on stderr that says `says`, nothing on stdout.
  static void expect_refused(const Finished& done, int status, const std::string& says) {
    EXPECT_EQ(done.status, status) << done.err;
    EXPECT_EQ(done.signal, 0);
    EXPECT_EQ(done.out, "");
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
    EXPECT_EQ(done.err.rfind("fogbench: ", 0), 0U) << done.err;
    EXPECT_NE(done.err.find(says), std::string::npos) << done.err;
  }

  support::TemporaryFolder folder_;
  support::OwnLocks locks_;
};

}  // namespace fogbench::system_tests
