#include "daemon/mistyped.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace fogbench::daemon {
namespace {

/// What a program with a few commands says of these words.
std::string said(const std::vector<std::string>& arguments) {
  CLI::App app{"", "bench"};
  bool flag = false;
  std::string text;
  CLI::App* diagnose = app.add_subcommand("diagnose", "");
  diagnose->add_option("DATA", text)->required();
  diagnose->add_option("--model", text)->required();
  diagnose->add_option("-o,--output", text);
  CLI::App* device = app.add_subcommand("device", "");
  CLI::App* probe = device->add_subcommand("probe", "");
  probe->add_flag("--json", flag);
  probe->add_option_group("where")->add_option("--connection", text);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ParseError& error) {
    return mistyped(app, arguments, error);
  }
  return "";
}

TEST(Mistyped, OffersTheNearestCommandAndOption) {
  EXPECT_EQ(said({"diagnos", "7"}),
            "unknown command diagnos; did you mean \"diagnose\"? (see bench --help)");
  EXPECT_EQ(said({"diagnose", "7", "--modle", "x"}),
            "unknown option --modle; did you mean \"--model\"? (see bench diagnose --help)");
  EXPECT_EQ(said({"diagnose", "7", "--modle=x"}),
            "unknown option --modle; did you mean \"--model\"? (see bench diagnose --help)");
  EXPECT_EQ(said({"device", "prob"}),
            "unknown command prob; did you mean \"probe\"? (see bench device --help)");
  EXPECT_EQ(said({"device", "probe", "-json"}),
            "unknown option -json; did you mean \"--json\"? (see bench device probe --help)");
  EXPECT_EQ(said({"device", "probe", "--conection", "x"}),
            "unknown option --conection; did you mean \"--connection\"? (see bench device probe "
            "--help)");
  EXPECT_EQ(said({"device", "probe", "--connection", "x"}), "");
  EXPECT_EQ(said({"quux"}), "unknown command quux (see bench --help)");
}

TEST(Mistyped, LeavesOtherMistakesToTheParser) {
  EXPECT_EQ(said({"diagnose", "7"}), "--model is required (see bench diagnose --help)");
  EXPECT_EQ(said({"diagnose", "7", "--model", "m", "-5", "-ofile"}).find("unknown"),
            std::string::npos);
  EXPECT_EQ(said({"diagnose", "7", "--model", "m"}), "");
}

}  // namespace
}  // namespace fogbench::daemon
