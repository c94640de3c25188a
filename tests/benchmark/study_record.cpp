#include "tests/benchmark/study_record.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <fstream>
#include <sstream>

#include "tests/benchmark/candidate_columns.hpp"

namespace fogbench::tests {
namespace {

constexpr std::size_t kFields = 17;

Answer answer_of_names(const std::vector<std::string>& names) {
  Answer out;
  if (!names.empty()) out.verdict = model::Verdict::kMissingEffect;
  for (const std::string& name : names) out.sets.push_back({name});
  return out;
}

Outcome outcome_at(int index) {
  return static_cast<Outcome>(index);
}

Result<Record> parse_record(const std::string& line) {
  std::vector<std::string> field;
  std::istringstream in(line);
  for (std::string part; std::getline(in, part, '\t');) field.push_back(part);
  const Error bad{ErrorCode::kBadInput, "not a record of the study"};
  if (field.size() != kFields) return bad;
  Record out{.part = field[0], .design = field[1], .noise = field[2], .truth = field[3]};
  std::istringstream baselines(field[9]);
  int outcome = 0;
  try {
    out.s = std::stod(field[4]);
    out.rows = std::stol(field[5]);
    out.trial = std::stoull(field[6]);
    out.seed = std::stoull(field[7]);
    out.outcome = outcome_at(std::stoi(field[8]));
    while (baselines >> outcome) out.baselines.push_back(outcome_at(outcome));
    out.cosine = std::stod(field[10]);
    out.seconds = std::stod(field[12]);
    out.inner = std::stod(field[13]);
    out.formula_floors = std::stod(field[16]);
  } catch (const std::exception&) {
    return bad;
  }
  out.nearest = field[11];
  out.says = field[14];
  if (field[15] != "-") out.contradiction = field[15];
  return out;
}

}  // namespace

std::string truth_of(const DiagnosisCase& what) {
  std::string out =
      what.hidden.empty() ? "nothing" : fmt::format("{}", fmt::join(what.hidden, " + "));
  if (what.shape == Shape::kOther) out += ", other shape";
  return what.variant.empty() ? out : out + ", " + what.variant;
}

Record run_trial(TrialMaker& maker, const DiagnosisCase& what, std::uint64_t number,
                 bool with_baselines) {
  const Trial trial = maker.make(what, number);
  Record out{.part = what.part,
             .design = name_of(what.design),
             .noise = what.noise,
             .truth = truth_of(what),
             .s = what.s,
             .rows = static_cast<long>(trial.table.rows()),
             .trial = number,
             .seed = trial.seed};
  const auto begin = std::chrono::steady_clock::now();
  const Answer answer = answer_of(trial);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  out.outcome = judge(answer, what.hidden);
  out.says = answer.says;
  out.contradiction = answer.contradiction;
  out.formula_floors = answer.formula_floors;
  if (with_baselines) {
    const auto answers = baseline_answers(trial.table, trial.model);
    for (const auto& names : answers) {
      out.baselines.push_back(judge(answer_of_names(names), what.hidden));
    }
  }
  if (!trial.hidden.empty()) {
    const auto bench = maker.bench(what);
    const model::Signals signals(trial.table, trial.model.reference_temperature_c);
    const auto candidates = candidate_columns(
        signals, trial.model, [&](const Eigen::MatrixXd& a) { return bench->in_noise(a); });
    const auto nearest = candidates.nearest(
        bench->clear_in_noise(bench->column(trial.hidden.front())), trial.hidden.front().id);
    out.inner = trial.hidden.front().inner;
    out.cosine = nearest.cosine;
    out.nearest = nearest.effect;
  }
  return out;
}

std::string to_line(const Record& r) {
  std::vector<int> baselines;
  for (const Outcome one : r.baselines) baselines.push_back(static_cast<int>(one));
  return fmt::format(
      "{}\t{}\t{}\t{}\t{:g}\t{}\t{}\t{}\t{}\t{}\t{:.4f}\t{}\t{:.3f}\t{:.4g}\t{}\t{}\t{:.3f}",
      r.part, r.design, r.noise, r.truth, r.s, r.rows, r.trial, r.seed, static_cast<int>(r.outcome),
      baselines.empty() ? "-" : fmt::format("{}", fmt::join(baselines, " ")), r.cosine,
      r.nearest.empty() ? "-" : r.nearest, r.seconds, r.inner, r.says,
      r.contradiction.empty() ? "-" : r.contradiction, r.formula_floors);
}

Result<std::vector<Record>> read_records(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) return Error{ErrorCode::kBadInput, fmt::format("{}: cannot be read", file.string())};
  std::vector<Record> out;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    auto record = parse_record(line);
    if (!record) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("{}:{}: {}", file.string(), number, record.error().message)};
    }
    out.push_back(std::move(*record));
  }
  return out;
}

}  // namespace fogbench::tests
