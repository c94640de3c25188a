#include "config/output_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace fogbench::config {
namespace fs = std::filesystem;

namespace {

Error error_for(const fs::path& path) {
  return Error{ErrorCode::kBadInput, fmt::format("{}: cannot be written: {}", path.string(),
                                                 std::generic_category().message(errno))};
}

}  // namespace

OutputFile::OutputFile(fs::path path, fs::path temporary, std::FILE* file)
    : path_(std::move(path)), temporary_(std::move(temporary)), file_(file) {}

Error OutputFile::error() const {
  return error_for(path_);
}

Result<std::unique_ptr<OutputFile>> OutputFile::open(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: is a directory; a file name was expected", path.string())};
  }
  fs::path target = path, temporary;
  std::FILE* file = nullptr;
  if (path == "-") {
    target = "standard output";
    file = fdopen(dup(STDOUT_FILENO), "w");
  } else if (fs::exists(status) && !fs::is_regular_file(status)) {
    file = std::fopen(path.c_str(), "we");
  } else {
    if (fs::is_symlink(fs::symlink_status(path, ignored)))
      target = fs::weakly_canonical(path, ignored);
    temporary = fmt::format("{}.{}.partial", target.string(), getpid());
    file = std::fopen(temporary.c_str(), "wxe");
  }
  if (file == nullptr) return error_for(target);
  return std::unique_ptr<OutputFile>(new OutputFile(target, temporary, file));
}

OutputFile::~OutputFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

Status OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) return error();
  return {};
}

Status OutputFile::commit() {
  if (std::fflush(file_) != 0) return error();
  if (!temporary_.empty()) {
    if (fsync(fileno(file_)) != 0) return error();
    if (std::rename(temporary_.c_str(), path_.c_str()) != 0) return error();
  }
  const int closed = std::fclose(std::exchange(file_, nullptr));
  return closed == 0 ? Status{} : Status{error()};
}

Status write_file(const fs::path& path, std::string_view text) {
  auto file = OutputFile::open(path);
  if (!file) return file.error();
  if (const Status written = (*file)->write(text); !written) return written;
  return (*file)->commit();
}

}  // namespace fogbench::config
