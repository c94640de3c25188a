#include "cli/page_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <vector>

#include "config/scratch_folder.hpp"

namespace fogbench::cli {
namespace fs = std::filesystem;

namespace {

/// Debian's name first, then those of others.
constexpr const char* kPrinters[] = {"chromium", "chromium-browser", "google-chrome"};

/// The first of kPrinters on the PATH; empty: none.
std::string find_printer() {
  const char* const path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe)
  for (const char* const name : kPrinters) {
    std::istringstream folders(path != nullptr ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
      const std::string program = (fs::path(folder) / name).string();
      std::error_code error;
      if (fs::is_regular_file(program, error) && access(program.c_str(), X_OK) == 0) return program;
    }
  }
  return "";
}

/// True when the program ran and said that all is well; what it says itself goes nowhere.
bool run_quietly(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  posix_spawn_file_actions_addopen(&streams, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&streams, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawn(&child, argv[0], &streams, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&streams);
  if (failed != 0) return false;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return false;
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

Result<std::string> printed(const std::string& printer, const std::string& html) {
  const auto folder = config::ScratchFolder::make();
  if (!folder) return folder.error();
  const fs::path page = folder->path() / "page.html", sheet = folder->path() / "page.pdf";
  if (Status written = config::write_file(page, html); !written) return written.error();
  std::vector<std::string> arguments{printer,
                                     "--headless",
                                     "--disable-gpu",
                                     "--no-first-run",
                                     "--no-pdf-header-footer",
                                     "--user-data-dir=" + (folder->path() / "profile").string(),
                                     "--print-to-pdf=" + sheet.string()};
  // Chromium refuses to be root in its sandbox; the page is our own, from this machine.
  if (geteuid() == 0) arguments.emplace_back("--no-sandbox");
  arguments.push_back("file://" + page.string());
  const bool ran = run_quietly(std::move(arguments));
  std::ifstream in(sheet, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (!ran || !bytes.view().starts_with("%PDF-")) {
    return Error{
        ErrorCode::kDevice,
        fmt::format("{} did not print the page; write it as .html and print that", printer)};
  }
  return bytes.str();
}

}  // namespace

Result<PageFile> PageFile::open(const std::string& path) {
  const std::string ending = fs::path(path).extension().string();
  std::string printer;
  if (ending == ".pdf") {
    printer = find_printer();
    if (printer.empty()) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("{}: PDF is printed by Chromium, which was not found (apt install "
                               "chromium); or write {} and print it from a browser",
                               path, fs::path(path).replace_extension(".html").string())};
    }
  } else if (!ending.empty() && ending != ".html" && ending != ".htm" && ending != ".xhtml") {
    return Error{
        ErrorCode::kBadInput,
        fmt::format("{}: found a name that ends with {}, expected .html or .pdf for a page", path,
                    ending)};
  }
  auto file = config::OutputFile::open(path);
  if (!file) return file.error();
  return PageFile(path, std::move(printer), std::move(*file));
}

Status PageFile::write(const std::string& html) {
  if (printer_.empty()) {
    const Status written = file_->write(html);
    return written ? file_->commit() : written;
  }
  const auto sheet = printed(printer_, html);
  if (!sheet) return Error{sheet.error().code, path_ + ": " + sheet.error().message};
  const Status written = file_->write(*sheet);
  return written ? file_->commit() : written;
}

}  // namespace fogbench::cli
