#include "cli/challenge_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <span>

#include "config/describe_scenario.hpp"
#include "record/chunk_codec.hpp"
#include "record/file_hash.hpp"

namespace fogbench::cli {

template <class Visitor>
void describe(Visitor& v, ChallengeSecret& s) {
  v.required("seed", s.seed, "Of the draw and of all noise.");
  v.required("scenario", s.scenario, "What the gyro is and hides.");
  v.optional("visible_deg_per_h", s.visible_deg_per_h, "By hidden effect.");
  v.required("noise_deg_per_h", s.noise_deg_per_h, "What is left when nothing is hidden.");
}

template <class Visitor>
void describe(Visitor& v, ChallengeFile& f) {
  v.required("says", f.says, "What this is.");
  v.required("software_version", f.software_version, "That made it.");
  v.required("noise", f.noise, "Grade of the gyro.");
  v.optional("bench", f.bench, "That it was measured on, where not the usual one.");
  v.required("procedure", f.procedure, "That measured it.");
  v.optional("set", f.set, "Parameters of the procedure.");
  v.required("data_sha256", f.data_sha256, "Of measurements.csv.");
  v.optional("hidden", f.hidden, "What is hidden, in hexadecimal digits.");
  v.required("seal", f.seal, "SHA-256 of the rest.");
}

namespace {

std::string seal_of(ChallengeFile file) {
  file.seal.clear();
  return record::text_sha256(config::Codec<ChallengeFile>::write(file).dump());
}

/// The text that record::hexadecimal() was given.
std::string text_of_digits(std::string_view digits) {
  std::string text;
  for (std::size_t at = 0; at + 1 < digits.size(); at += 2) {
    unsigned char byte = 0;
    std::from_chars(digits.data() + at, digits.data() + at + 2, byte, 16);
    text += static_cast<char>(byte);
  }
  return text;
}

}  // namespace

std::string sealed_text(ChallengeFile file, const ChallengeSecret& secret) {
  const std::string text = config::Codec<ChallengeSecret>::write(secret).dump();
  file.hidden = record::hexadecimal(std::as_bytes(std::span(text)));
  file.seal = seal_of(file);
  return config::pretty_json(config::Codec<ChallengeFile>::write(file));
}

Result<ChallengeSecret> open_challenge(const std::filesystem::path& folder) {
  const std::filesystem::path name = folder / kSealedFile;
  const auto file = config::read_config<ChallengeFile>(name);
  if (!file) return file.error();
  if (file->hidden.empty()) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: has no /hidden: it was sealed by an older version, whose seals "
                             "this one does not open",
                             name.string())};
  }
  const std::filesystem::path data = folder / kMeasurementsFile;
  const auto sha256 = record::file_sha256(data);
  if (!sha256) return sha256.error();
  if (*sha256 != file->data_sha256) {
    return Error{
        ErrorCode::kBadInput,
        fmt::format("{}: found SHA-256 {}, expected {} as in {}: the seal opens with the "
                    "data that were sealed only",
                    data.string(), *sha256, config::one_line(file->data_sha256), name.string())};
  }
  if (file->seal != seal_of(*file)) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: /seal: the seal is broken: the file is not as it was made",
                             name.string())};
  }
  const auto tree = config::parse_json(text_of_digits(file->hidden), name.string());
  if (!tree) return tree.error();
  config::ReadState state{name, std::nullopt};
  ChallengeSecret secret;
  if (!config::Codec<ChallengeSecret>::read(config::Place(*tree, state), secret, {})) {
    return *state.error;
  }
  if (secret.visible_deg_per_h.size() != secret.scenario.hidden.size()) {
    return Error{
        ErrorCode::kBadInput,
        fmt::format("{}: /hidden: {} sizes of {} hidden effects, expected one of each",
                    name.string(), secret.visible_deg_per_h.size(), secret.scenario.hidden.size())};
  }
  return secret;
}

}  // namespace fogbench::cli
