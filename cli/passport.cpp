// fogbench passport: a gyro's passport, as a page that prints and as JSON.

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "acceptance/passport_json.hpp"
#include "acceptance/passport_page.hpp"
#include "cli/command.hpp"
#include "cli/output.hpp"
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

std::string document_of(const acceptance::Passport& passport,
                        const PassportCommandOptions& options) {
  if (std::filesystem::path(options.output).extension() == ".json") {
    return acceptance::passport_json(passport).dump(
               2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
           "\n";
  }
  return acceptance::passport_html(passport, options.language);
}

Result<ExitStatus> run_passport(const PassportCommandOptions& options) {
  if (options.output.empty() && !options.json) {
    return Error{ErrorCode::kUsage,
                 "-o FILE or --json was expected (see fogbench passport --help)"};
  }
  const auto passport = judge_runs(options.passport);
  if (!passport) return passport.error();
  if (!options.output.empty()) {
    const Status written = config::write_file(options.output, document_of(*passport, options));
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
      "  fogbench passport 7 --limits my-gyro.json -o passport.json",
      [](CLI::App& command, PassportCommandOptions& options) {
        add_passport_options(command, options.passport);
        command.add_option("-o,--output,--out", options.output,
                           "File to write: JSON when its name ends with .json, else one HTML page");
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
