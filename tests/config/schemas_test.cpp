// The schemas in config/schemas/ are what the code writes, and every ready file satisfies its own.
//
// After a change to a description, write them anew with
//   FOGBENCH_UPDATE_SCHEMAS=1 build/release/schemas_test
// and commit them with the change.

#include "config/schemas.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "config/json_file.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::config {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

const fs::path kConfig = tests::source_tree() / "config";

fs::path schema_file(std::string_view kind) {
  return kConfig / "schemas" / fmt::format("{}.schema.json", kind);
}

/// The library's own words for the first violation; empty when there is none.
std::string violation(std::string_view kind, const json& document) {
  const json tree = json::parse(schema_text(kind));
  valijson::Schema schema;
  valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
  parser.populateSchema(Adapter(tree), schema);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(schema, Adapter(document), &results)) return {};
  valijson::ValidationResults::Error error;
  results.popError(error);
  return fmt::format("{}: {}", fmt::join(error.context, ""), error.description);
}

/// Ready files of a kind stand in the folder of its plural.
std::vector<fs::path> ready_files(std::string_view kind) {
  const std::string plural = kind == "limits"  ? "limits"
                             : kind == "bench" ? "benches"
                                               : std::string(kind) + "s";
  std::vector<fs::path> files;
  std::error_code none_yet;
  for (const auto& entry : fs::directory_iterator(kConfig / plural, none_yet)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

class SchemaFiles : public testing::TestWithParam<std::string_view> {};

TEST_P(SchemaFiles, AreWhatTheCodeWrites) {
  const fs::path file = schema_file(GetParam());
  if (std::getenv("FOGBENCH_UPDATE_SCHEMAS") != nullptr) {
    std::ofstream(file) << schema_text(GetParam());
  }
  const auto text = read_text_file(file);
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, schema_text(GetParam())) << "the first comment of this test says what to do";
}

TEST_P(SchemaFiles, AcceptEveryReadyFile) {
  for (const fs::path& file : ready_files(GetParam())) {
    const auto document = read_json_file(file);
    ASSERT_TRUE(document) << document.error().message;
    EXPECT_EQ(violation(GetParam(), *document), "") << file;
  }
}

TEST_P(SchemaFiles, RefuseAnUnknownAndAMissingKey) {
  for (const fs::path& file : ready_files(GetParam())) {
    json document = *read_json_file(file);
    document["surplus"] = 1;
    EXPECT_NE(violation(GetParam(), document), "") << file;
    document.erase("surplus");
    if (GetParam() == "scenario") continue;  // it requires nothing
    document.erase("name");
    EXPECT_NE(violation(GetParam(), document), "") << file;
  }
}

constexpr std::string_view kKeysHeading = "| step | key | what it is | default |\n";

/// Every key of every step, in the words of the schema, as a table of markdown.
std::string table_of_keys() {
  std::string table = std::string(kKeysHeading) + "|---|---|---|---|\n";
  const auto schema = nlohmann::ordered_json::parse(schema_text("procedure"));
  for (const auto& step : schema["definitions"]["step"]["oneOf"]) {
    const auto& required = step["required"];
    for (const auto& [key, value] : step["properties"].items()) {
      if (key == "step") continue;
      const bool needed = std::find(required.begin(), required.end(), key) != required.end();
      const auto set = value.find("default");
      table += fmt::format("| `{}` | `{}` | {} | {} |\n",
                           step["properties"]["step"]["const"].get<std::string>(), key,
                           value["description"].get<std::string>(),
                           needed               ? "has to be given"
                           : set == value.end() ? "-"
                           : set->is_number()   ? fmt::format("{:g}", set->get<double>())
                                                : set->dump());
    }
  }
  return table;
}

TEST(ProcedureSchema, TheReadmeOfTheLanguageHasItsWords) {
  const fs::path file = tests::source_tree() / "procedures/README.md";
  auto text = read_text_file(file);
  ASSERT_TRUE(text) << text.error().message;
  const std::size_t begin = text->find(kKeysHeading);
  ASSERT_NE(begin, std::string::npos);
  const std::size_t end = text->find("\n\n", begin) + 1;
  const std::string table = table_of_keys();
  if (std::getenv("FOGBENCH_UPDATE_SCHEMAS") != nullptr) {
    text->replace(begin, end - begin, table);
    std::ofstream(file) << *text;
  }
  EXPECT_NE(text->find(table), std::string::npos)
      << "the first comment of this test says what to do";
}

INSTANTIATE_TEST_SUITE_P(AllKinds, SchemaFiles, testing::ValuesIn(kSchemaKinds),
                         [](const auto& kind) { return std::string(kind.param); });

}  // namespace
}  // namespace fogbench::config
