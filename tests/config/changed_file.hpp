#pragma once
// A ready file with a change, in a folder of its own: what bad input looks like in practice.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "config/json_file.hpp"
#include "config/result.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::config {

inline const std::filesystem::path kReady = tests::source_tree() / "config";

/// Relative names of device files stay valid: the copy lies as deep as the original, beside a link
/// to the ready devices.
class ChangedFile {
 public:
  ChangedFile() {
    std::filesystem::create_directory(folder_.path() / "files");
    std::filesystem::create_directory_symlink(kReady / "devices", folder_.path() / "devices");
  }
  const std::filesystem::path& path() const { return path_; }

  const std::filesystem::path& write(const std::string& text) {
    // A new file each time: a file system may flush one that is cut to nothing and written again.
    std::filesystem::remove(path_);
    std::ofstream(path_, std::ios::binary) << text;
    return path_;
  }
  /// The ready file `name` ("benches/simulated.json") patched with an RFC 6902 list.
  const std::filesystem::path& patch(const std::string& name, const std::string& patch) {
    const auto document = read_json_file(kReady / name);
    return write(document->patch(nlohmann::json::parse(patch)).dump(2));
  }

 private:
  support::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "files" / "changed.json";
};

/// The message of a kBadInput error, the folder of the file taken off; fails the test otherwise.
template <class T>
std::string message_of(const Result<T>& result) {
  if (result) {
    ADD_FAILURE() << "no error";
    return {};
  }
  EXPECT_EQ(result.error().code, ErrorCode::kBadInput);
  const std::string& message = result.error().message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  const auto name = message.find("changed.json");
  return name == std::string::npos ? message : message.substr(name);
}

}  // namespace fogbench::config
