#include "daemon/session.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

TEST(PlanProcedure, RecordsAFileWhoseNameIsNotText) {
  const auto ready = tests::source_tree() / "config";
  const auto bench = config::load_bench(ready / "benches/simulated.json");
  ASSERT_TRUE(bench) << bench.error().message;
  const support::TemporaryFolder folder;
  const std::string text = support::read_text(ready / "procedures/coil-sweep.json");
  const auto file = folder.file(
      "proc\xe9"
      "dure.json",
      text);  // Latin-1
  const auto planned = plan_procedure(file.string(), *bench, {});
  ASSERT_TRUE(planned) << planned.error().message;
  const auto record = nlohmann::json::parse(planned->procedure_json, nullptr, false);
  ASSERT_TRUE(record.is_object());
  EXPECT_EQ(record["files"].begin().value(), text);
}

}  // namespace
}  // namespace fogbench::daemon
