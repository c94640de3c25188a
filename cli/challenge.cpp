// fogbench challenge: a sealed simulated gyro to practise on.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "cli/challenge_bench.hpp"
#include "cli/challenge_file.hpp"
#include "cli/command.hpp"
#include "cli/output.hpp"
#include "cli/shell_word.hpp"
#include "config/bench.hpp"
#include "config/output_file.hpp"
#include "config/paths.hpp"
#include "daemon/run_options.hpp"
#include "record/export.hpp"
#include "record/file_hash.hpp"

namespace fogbench::cli {
namespace fs = std::filesystem;

namespace {

constexpr auto kSays =
    "A simulated gyro that hides nothing, one effect of the catalogue (fogbench effects) or two. "
    "measurements.csv is what the bench measured, model.json is the model to start from. "
    "fogbench reveal opens the seal and scores an answer.";

struct ChallengeOptions {
  std::optional<std::uint64_t> seed;
  std::optional<std::string> bench;
  std::string folder;
  bool json = false;
};

/// A folder that appears whole or not at all, in the place of none or of an empty one.
class NewFolder {
 public:
  /// Errors: kBadInput when something is there already, or the folder cannot be made.
  static Result<std::unique_ptr<NewFolder>> open(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::exists(status) && !fs::is_directory(status)) {
      return Error{ErrorCode::kBadInput, path.string() + ": is a file, expected a new folder"};
    }
    if (fs::is_directory(status) && !fs::is_empty(path, error)) {
      return Error{ErrorCode::kBadInput,
                   path.string() + ": has content already, expected a new or an empty folder"};
    }
    std::unique_ptr<NewFolder> folder(new NewFolder(path));
    fs::create_directory(folder->temporary_, error);
    if (error) return folder->error("cannot be made", error);
    return folder;
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  ~NewFolder() {
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);
  }

  fs::path operator/(const std::string& name) const { return temporary_ / name; }
  Status commit() const {
    std::error_code error;
    fs::rename(temporary_, path_, error);
    return error ? Status{this->error("cannot be made", error)} : Status{};
  }

 private:
  explicit NewFolder(fs::path path)
      : path_(std::move(path)),
        temporary_(fmt::format("{}.{}.partial", path_.string(), getpid())) {}
  Error error(const char* what, const std::error_code& because) const {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: {}: {}", path_.string(), what, because.message())};
  }

  fs::path path_, temporary_;
};

/// A seed that was given names its folder; one that was drawn must not.
fs::path folder_for(const ChallengeOptions& options) {
  if (!options.folder.empty()) {
    const fs::path path = fs::path(options.folder).lexically_normal();
    return path.has_filename() ? path : path.parent_path();
  }
  if (options.seed) return fmt::format("challenge-{}", *options.seed);
  int number = 1;
  std::error_code ignored;
  while (fs::exists(fmt::format("challenge-{}", number), ignored)) ++number;
  return fmt::format("challenge-{}", number);
}

Result<ChallengeRoom> room_for(const ChallengeOptions& options) {
  ChallengeRoom room{.bench = options.bench};
  if (!room.bench) return room;
  const auto file = config::find_config("benches", *room.bench);
  if (!file) return file.error();
  const auto bench = config::load_bench(*file);
  if (!bench) return bench.error();
  for (const auto& channel : config::auxiliary_channels(*bench)) {
    room.channels.push_back(channel.name);
  }
  return room;
}

std::vector<std::string> effects_of(const config::ModelFile& model) {
  std::vector<std::string> names;
  for (const config::ModelTerm& term : model.terms) names.push_back(term.effect);
  return names;
}

Status write_file_of(const std::vector<procedures::Point>& points, const fs::path& file) {
  auto out = config::OutputFile::open(file);
  if (!out) return out.error();
  if (const Status written = record::write_points(points, **out); !written) return written;
  return (*out)->commit();
}

/// Measures what was drawn, and writes the three files. The number of rows.
Result<std::size_t> make(std::uint64_t seed, const ChallengeDraw& draw, const NewFolder& folder) {
  const auto bench = ChallengeBench::open(draw);
  if (!bench) return bench.error();
  const auto sized = size_effects(draw, *bench);
  if (!sized) return sized.error();
  const auto points = bench->measure(sized->scenario);
  if (!points) return points.error();

  const fs::path data = folder / kMeasurementsFile;
  if (const Status ok = write_file_of(*points, data); !ok) return ok.error();
  const auto sha256 = record::file_sha256(data);
  if (!sha256) return sha256.error();
  const std::string sealed = sealed_text({.says = kSays,
                                          .software_version = FOGBENCH_VERSION,
                                          .noise = draw.noise,
                                          .bench = draw.bench,
                                          .procedure = draw.procedure,
                                          .set = draw.set,
                                          .data_sha256 = *sha256},
                                         {.seed = std::to_string(seed),
                                          .scenario = sized->scenario,
                                          .visible_deg_per_h = sized->visible_deg_per_h,
                                          .noise_deg_per_h = sized->noise_deg_per_h});
  if (const Status ok = config::write_file(folder / kSealedFile, sealed); !ok) return ok.error();
  const std::string model = config::to_json_text(draw.model);
  if (const Status ok = config::write_file(folder / kModelFile, model); !ok) return ok.error();
  return points->size();
}

Result<ExitStatus> run_challenge(const ChallengeOptions& options) {
  const fs::path path = folder_for(options);
  const auto folder = NewFolder::open(path);
  if (!folder) return folder.error();
  const std::uint64_t seed = options.seed.value_or(daemon::random_seed());
  const auto room = room_for(options);
  if (!room) return room.error();
  const ChallengeDraw draw = draw_challenge(seed, *room);
  const auto rows = make(seed, draw, **folder);
  if (!rows) return rows.error();
  if (const Status done = (*folder)->commit(); !done) return done.error();

  const std::string data = (path / kMeasurementsFile).string();
  const std::string model = (path / kModelFile).string();
  if (options.json) {
    print_json({{"folder", path.string()},
                {"procedure", draw.procedure},
                {"noise", draw.noise},
                {"rows", *rows},
                {"measurements", data},
                {"model", model},
                {"sealed", (path / kSealedFile).string()}});
    return ExitStatus::kDone;
  }
  fmt::print("{}: a {}-grade gyro that hides nothing, one effect or two, after {}\n", path.string(),
             draw.noise, draw.procedure);
  fmt::print("  {:<17} what the bench measured, {} rows\n", kMeasurementsFile, *rows);
  fmt::print("  {:<17} the model to start from: {}\n", kModelFile,
             fmt::join(effects_of(draw.model), ", "));
  fmt::print("  {:<17} what is hidden\n\n", kSealedFile);
  const std::string named = fmt::format("{} --model {}", shell_word(data), shell_word(model));
  fmt::print("Next: fogbench compare {}\n", named);
  fmt::print("      fogbench diagnose {}\n", named);
  fmt::print("When you know what hides: fogbench reveal {} --answer EFFECT, or --answer nothing\n",
             shell_word(path.string()));
  return ExitStatus::kDone;
}

}  // namespace

void add_challenge(CLI::App& app, Action& action) {
  add_command<ChallengeOptions>(
      app, action, "challenge", "Make a sealed simulated gyro to practise on",
      "  fogbench challenge\n"
      "  fogbench challenge --seed 7 -o gyro-7\n"
      "  fogbench challenge --bench simulated-auxiliary\n"
      "It hides nothing, one effect of the catalogue or two, of a size that the data tell; on a\n"
      "bench with auxiliary sensors one of them may be what they measure. The seal keeps you\n"
      "from seeing the answer by accident; it does not keep a secret.",
      [](CLI::App& command, ChallengeOptions& options) {
        daemon::add_seed_option(command, options.seed);
        command.get_option("--seed")->description(
            "Of everything: the same challenge again (default: drawn, and sealed)");
        command.add_option("--bench", options.bench,
                           "A simulated bench file, or a ready one (default: simulated)");
        command.add_option("-o,--output", options.folder,
                           "Folder to make (default: challenge-SEED, or the first free "
                           "challenge-1, challenge-2...)");
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_challenge);
}

}  // namespace fogbench::cli
