#include "config/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <optional>

namespace fogbench::config {
namespace {

TEST(ScratchFolder, GoesWithAllThatIsInIt) {
  std::filesystem::path path;
  {
    auto made = ScratchFolder::make();
    ASSERT_TRUE(made) << made.error().message;
    path = made->path();
    const ScratchFolder moved = std::move(*made);
    std::ofstream(moved.path() / "file") << "text";
    EXPECT_TRUE(std::filesystem::is_directory(path));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ScratchFolder, SaysWhereNoneCanBeMade) {
  const char* const before = std::getenv("TMPDIR");  // NOLINT(concurrency-mt-unsafe)
  const std::optional<std::string> kept =
      before == nullptr ? std::nullopt : std::optional<std::string>(before);
  setenv("TMPDIR", "/proc", 1);
  const auto made = ScratchFolder::make();
  kept ? setenv("TMPDIR", kept->c_str(), 1) : unsetenv("TMPDIR");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kStore);
  EXPECT_NE(made.error().message.find("/proc"), std::string::npos) << made.error().message;
}

}  // namespace
}  // namespace fogbench::config
