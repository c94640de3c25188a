#pragma once
// A file that takes an HTML page: as it is, or printed when its name ends with .pdf. Chromium
// prints, as a program of its own: no library of Debian's draws HTML with SVG as browsers do.

#include <memory>
#include <string>

#include "config/output_file.hpp"
#include "config/result.hpp"

namespace fogbench::cli {

class PageFile {
 public:
  /// Before the work, so that a path that cannot be written is known at once. "-" is standard
  /// output. kBadInput: the name ends with something else than .html or .pdf, PDF is wanted and
  /// Chromium is not there, or as config::OutputFile.
  static Result<PageFile> open(const std::string& path);
  /// Writes `html`, or prints it, and commits. kDevice when Chromium does not print.
  Status write(const std::string& html);

 private:
  PageFile(std::string path, std::string printer, std::unique_ptr<config::OutputFile> file)
      : path_(std::move(path)), printer_(std::move(printer)), file_(std::move(file)) {}

  std::string path_, printer_;  ///< the program that prints; empty: HTML
  std::unique_ptr<config::OutputFile> file_;
};

}  // namespace fogbench::cli
