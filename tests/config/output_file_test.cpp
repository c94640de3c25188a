#include "config/output_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

namespace fogbench::config {
namespace {
namespace fs = std::filesystem;

class OutputFileTest : public testing::Test {
 protected:
  OutputFileTest()
      : folder_(fs::temp_directory_path() / ("fogbench-output-" + std::to_string(getpid()))) {
    fs::create_directory(folder_);
  }
  ~OutputFileTest() override { fs::remove_all(folder_); }

  static std::string read(const fs::path& path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(OutputFileTest, AppearsWholeOnCommit) {
  const fs::path path = folder_ / "a.csv";
  auto file = OutputFile::open(path);
  ASSERT_TRUE(file);
  ASSERT_TRUE((*file)->write("one\n"));
  EXPECT_FALSE(fs::exists(path));
  ASSERT_TRUE((*file)->write("two\n"));
  ASSERT_TRUE((*file)->commit());
  EXPECT_EQ(read(path), "one\ntwo\n");
  EXPECT_EQ(files(), 1U);
}

TEST_F(OutputFileTest, LeavesTheOldFileAndNoOtherWhenNotCommitted) {
  const fs::path path = folder_ / "a.csv";
  ASSERT_TRUE(write_file(path, "old"));
  {
    auto file = OutputFile::open(path);
    ASSERT_TRUE(file);
    ASSERT_TRUE((*file)->write("new"));
  }
  EXPECT_EQ(read(path), "old");
  EXPECT_EQ(files(), 1U);
}

TEST_F(OutputFileTest, RefusesADirectoryAndAMissingFolder) {
  const Status directory = write_file(folder_, "x");
  ASSERT_FALSE(directory);
  EXPECT_EQ(directory.error().code, ErrorCode::kBadInput);
  const Status missing = write_file(folder_ / "no" / "a.csv", "x");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("No such file"), std::string::npos);
}

TEST_F(OutputFileTest, ReportsAFullDevice) {
  const Status full = write_file("/dev/full", "x");
  ASSERT_FALSE(full);
  EXPECT_NE(full.error().message.find("No space left"), std::string::npos);
}

}  // namespace
}  // namespace fogbench::config
