// Every ready file, damaged in every way that an editor, a disk or a person can damage it: reading
// it gives a value, or one line that names a file. It never crashes and never hangs.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "config/bench.hpp"
#include "config/device_file.hpp"
#include "config/limits.hpp"
#include "config/model_file.hpp"
#include "config/procedure.hpp"
#include "config/scenario.hpp"
#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// What reading said: empty for success.
std::string error_of(const std::string& kind, const fs::path& file) {
  const auto say = [](const auto& result) { return result ? "" : result.error().message; };
  if (kind == "devices") return say(load_device(file));
  if (kind == "benches") return say(load_bench(file));
  if (kind == "scenarios") return say(load_scenario(file));
  if (kind == "procedures") return say(load_procedure(file));
  if (kind == "models") return say(load_model(file));
  return say(load_limits(file));
}

class Mutation : public testing::TestWithParam<const char*> {
 protected:
  void expect_value_or_one_line(const std::string& text) {
    const std::string error = error_of(GetParam(), file_.write(text));
    ++tried_;
    if (error.empty()) return;
    ++refused_;
    EXPECT_NE(error.find(".json: "), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    EXPECT_LT(error.size(), 1000U) << error;
  }

  template <class Damage>
  void for_each_ready_file(Damage damage) {
    std::vector<fs::path> files;
    std::error_code none_yet;
    for (const auto& entry : fs::directory_iterator(kReady / GetParam(), none_yet)) {
      if (entry.path().extension() == ".json") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) damage(*read_text_file(file));
  }

  ChangedFile file_;
  std::size_t tried_ = 0;
  std::size_t refused_ = 0;
};

TEST_P(Mutation, KeysDeletedAndValuesOfOtherTypes) {
  for_each_ready_file([&](const std::string& text) {
    const json original = json::parse(text);
    const json leaves = original.flatten();
    for (const auto& [pointer, value] : leaves.items()) {
      for (json::json_pointer at(pointer); !at.empty(); at = at.parent_pointer()) {
        json damaged = original;
        damaged = damaged.patch({{{"op", "remove"}, {"path", at.to_string()}}});
        expect_value_or_one_line(damaged.dump());
      }
      for (const json& other : {json(nullptr), json(true), json(-1), json(1e300), json("x"),
                                json(""), json::array(), json::object(), json::array({1, 2, 3})}) {
        json damaged = original;
        damaged[json::json_pointer(pointer)] = other;
        expect_value_or_one_line(damaged.dump());
      }
    }
  });
  EXPECT_GE(refused_ * 3, tried_) << "most of these changes are mistakes";
}

TEST_P(Mutation, FileCutShort) {
  for_each_ready_file([&](const std::string& text) {
    const std::size_t end = text.find_last_of('}');
    for (std::size_t size = 0; size <= end; size += 1 + end / 97) {
      expect_value_or_one_line(text.substr(0, size));
    }
  });
  EXPECT_EQ(refused_, tried_) << "no part of an object is an object";
}

TEST_P(Mutation, RandomBytesInPlaceOfGoodOnes) {
  std::mt19937 random(20260101);  // NOLINT(bugprone-random-generator-seed): repeatable
  for_each_ready_file([&](const std::string& text) {
    for (int round = 0; round < 60; ++round) {
      std::string damaged = text;
      for (std::size_t count = 1 + random() % 4; count > 0; --count) {
        damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
      }
      expect_value_or_one_line(damaged);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(AllKinds, Mutation,
                         testing::Values("devices", "benches", "scenarios", "procedures", "models",
                                         "limits"),
                         [](const auto& kind) { return std::string(kind.param); });

}  // namespace
}  // namespace fogbench::config
