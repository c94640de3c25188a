// fogbench passport: a gyro's passport, as a page that prints and as JSON.

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "acceptance/passport_json.hpp"
#include "acceptance/passport_page.hpp"
#include "cli/command.hpp"
#include "cli/output.hpp"
#include "cli/page_file.hpp"
#include "cli/passport_options.hpp"
#include "config/output_file.hpp"
#include "daemon/run_options.hpp"

namespace fogbench::cli {
namespace {

struct PassportCommandOptions {
  PassportOptions passport;
  std::string output;
  acceptance::Language language = acceptance::Language::kEnglish;
  bool json = false;
};

bool is_json(const std::string& path) {
  return std::filesystem::path(path).extension() == ".json";
}

std::string json_document(const acceptance::Passport& passport) {
  return acceptance::passport_json(passport).dump(
             2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
         "\n";
}

Result<ExitStatus> run_passport(const PassportCommandOptions& options) {
  if (options.output.empty() && !options.json) {
    return Error{ErrorCode::kUsage,
                 "-o FILE or --json was expected (see fogbench passport --help)"};
  }
  std::optional<PageFile> page;
  if (!options.output.empty() && !is_json(options.output)) {
    auto opened = PageFile::open(options.output);
    if (!opened) return opened.error();
    page = std::move(*opened);
  }
  const auto passport = judge_runs(options.passport);
  if (!passport) return passport.error();
  if (!options.output.empty()) {
    const Status written = page
                               ? page->write(acceptance::passport_html(*passport, options.language))
                               : config::write_file(options.output, json_document(*passport));
    if (!written) return written.error();
  }
  if (options.json) {
    print_json(acceptance::passport_json(*passport));
  } else if (options.output != "-") {
    fmt::print("{}: gyro {}; {}\n", name_of(passport->judged.overall), passport->acceptance.gyro(),
               options.output);
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_passport(CLI::App& app, Action& action) {
  using acceptance::Language;
  add_command<PassportCommandOptions>(
      app, action, "passport", "Write a gyro's passport: results, verdict, where they come from",
      "  fogbench passport 7 -o passport.html --language ru\n"
      "  fogbench passport 7 -o passport.pdf\n"
      "  fogbench passport 7 --limits my-gyro.json -o passport.json",
      [](CLI::App& command, PassportCommandOptions& options) {
        add_passport_options(command, options.passport);
        command.add_option(
            "-o,--output,--out", options.output,
            "File to write: one HTML page, its print when the name ends with .pdf (by "
            "Chromium), JSON with .json");
        std::map<std::string, Language> languages;
        for (const Language language : acceptance::kLanguages) {
          languages.emplace(acceptance::text(acceptance::Text::kLanguageCode, language), language);
        }
        daemon::add_choice_option<Language>(command, "--language", options.language, languages,
                                            "Of the page (default: en)");
        command.add_flag("--json", options.json, "The passport as JSON on stdout");
      },
      run_passport);
}

}  // namespace fogbench::cli
