#include "tests/benchmark/study_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

namespace fogbench::tests {
namespace {

using Pick = std::function<bool(const Record&)>;
using Good = std::function<bool(const Record&, Outcome)>;

constexpr long kSmall = 75;  // rows of the magnetic test
constexpr long kMany = 460;
constexpr double kTellable = 0.9;  // nearer effects cannot be told apart at these ratios
constexpr double kStrange = 0.5;   // no effect of the catalogue is near
constexpr double kNearTheFloor = 1.3;
constexpr std::string_view kTheirs = "baselines, in the order above";

bool named(Outcome o) {
  return o == Outcome::kRight || o == Outcome::kRightInSet;
}
bool silent(Outcome o) {
  return o == Outcome::kAdequate;
}
bool flagged(Outcome o) {
  return o == Outcome::kUnexplained || o == Outcome::kHedged;
}

bool slow(const Record& r) {
  return r.truth == "drift_linear" || r.truth == "warm_up" || r.truth == "bias_step";
}

bool of_the_family(const Record& r) {
  const auto family = noises_of_the_family();
  return std::find(family.begin(), family.end(), r.noise) != family.end();
}

/// One line of the table of figures.
struct Figure {
  std::string what, goal;
  Pick asked;
  Good good;
};

std::vector<Figure> figures() {
  const auto single = [](const Record& r) { return r.part == "effects"; };
  const Good is_named = [](const Record&, Outcome o) { return named(o); };
  const Good alarm = [](const Record&, Outcome o) { return !silent(o); };
  return {
      {"false alarms, noise of the fitted family", "<= 5 %",
       [](const Record& r) { return r.part == "nulls" && of_the_family(r); }, alarm},
      {"false alarms, other noise", "<= 5 %",
       [](const Record& r) { return r.part == "nulls" && !of_the_family(r); }, alarm},
      {"false alarms, records longer than ten hours", "<= 5 %",
       [](const Record& r) {
         return r.part == "nulls" && (r.design == "mixed" || r.design == "long");
       },
       alarm},
      {"false alarms, all noise, without \"a slow effect or random walk\"", "",
       [](const Record& r) { return r.part == "nulls"; },
       [](const Record&, Outcome o) { return !silent(o) && o != Outcome::kRightInSet; }},
      {"one effect named, s >= 8, 75 rows, rho <= 0.9", ">= 95 %",
       [=](const Record& r) {
         return single(r) && r.rows <= kSmall && r.cosine <= kTellable && !slow(r);
       },
       is_named},
      {"the same, 460 rows or more", ">= 99 %",
       [=](const Record& r) {
         return single(r) && r.rows >= kMany && r.cosine <= kTellable && !slow(r);
       },
       is_named},
      {"one effect named, s >= 8, any rho", "",
       [=](const Record& r) { return single(r) && !slow(r); }, is_named},
      {"slow effect named (drift, warm-up, step), s >= 12", ">= 85 %",
       [=](const Record& r) { return single(r) && slow(r) && r.s >= 12.0; }, is_named},
      {"the answer, where one is given, holds the truth", ">= 95 %",
       [=](const Record& r) { return single(r) && !silent(r.outcome); },
       [](const Record&, Outcome o) {
         return named(o) || o == Outcome::kLargeSet || o == Outcome::kExtra;
       }},
      {"extra effect beside the true one", "<= 5 %", single,
       [](const Record&, Outcome o) { return o == Outcome::kExtra; }},
      {"exactly the hidden pair", ">= 90 %", [](const Record& r) { return r.part == "pairs"; },
       is_named},
      {"another shape of the same physics named, s = 12 ... 50", "",
       [](const Record& r) { return r.part == "shapes"; }, is_named},
      {"outside the catalogue flagged, s >= 16, rho <= 0.5", ">= 95 %",
       [](const Record& r) { return r.part == "outside" && r.cosine <= kStrange; },
       [](const Record&, Outcome o) { return flagged(o); }},
      {"outside, rho > 0.5: flagged, or a set", ">= 95 %",
       [](const Record& r) { return r.part == "outside" && r.cosine > kStrange; },
       [](const Record&, Outcome o) { return flagged(o) || o == Outcome::kSetWithoutTruth; }},
      {"outside, unexplained: the formula leaves at most 1.3 noise floors on rows left out",
       ">= 80 %",
       [](const Record& r) { return r.part == "outside" && r.outcome == Outcome::kUnexplained; },
       [](const Record& r, Outcome o) {
         return o == Outcome::kUnexplained && r.formula_floors <= kNearTheFloor;
       }}};
}

struct Count {
  std::size_t trials = 0, asked_baselines = 0;
  std::array<std::size_t, kOutcomes> of{};
  std::array<std::size_t, kBaselines.size()> baseline_good{};
  std::vector<double> cosine;
  std::map<std::string, std::size_t> nearest;

  void add(const Record& r, const std::function<bool(Outcome)>& good) {
    ++trials;
    ++of[static_cast<std::size_t>(r.outcome)];
    asked_baselines += r.baselines.empty() ? 0 : 1;
    for (std::size_t i = 0; i < r.baselines.size(); ++i) {
      baseline_good[i] += good(r.baselines[i]) ? 1 : 0;
    }
    cosine.push_back(r.cosine);
    ++nearest[r.nearest];
  }

  /// "1/0/2/0 of 3": in the order of kBaselines.
  std::string baselines_text() const {
    if (asked_baselines == 0) return "-";
    return fmt::format("{} of {}", fmt::join(baseline_good, "/"), asked_baselines);
  }
};

std::string quantile_text(std::vector<double> values, double level) {
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + std::lround(level * last);
  std::nth_element(values.begin(), at, values.end());
  return fmt::format("{:.2f}", *at);
}

}  // namespace

std::string times_text(const std::vector<Record>& records) {
  std::vector<double> seconds;
  for (const Record& r : records) {
    if (r.rows >= 40 && r.rows <= 400) seconds.push_back(r.seconds);
  }
  if (seconds.empty()) return "";
  return fmt::format(
      "A verdict on tables of 40 to 400 rows: {} s in the median, nineteen of twenty in {} s, the "
      "slowest {} s.\n",
      quantile_text(seconds, 0.5), quantile_text(seconds, 0.95), quantile_text(seconds, 1.0));
}

namespace {

void put_header(std::string& out, const std::vector<std::string>& names) {
  out += fmt::format("| {} |\n|{}\n", fmt::join(names, " | "),
                     fmt::join(std::vector<std::string>(names.size(), "---"), "|"));
  out.insert(out.size() - 1, "|");
}

std::string figures_table(const std::vector<Record>& records) {
  std::string out;
  std::vector<std::string> header{"figure", "goal", "trials", "diagnosis"};
  header.insert(header.end(), kBaselines.begin(), kBaselines.end());
  put_header(out, header);
  for (const Figure& figure : figures()) {
    std::size_t trials = 0, hits = 0, theirs = 0;
    std::array<std::size_t, kBaselines.size()> their_hits{};
    for (const Record& r : records) {
      if (!figure.asked(r)) continue;
      ++trials;
      hits += figure.good(r, r.outcome) ? 1 : 0;
      theirs += r.baselines.empty() ? 0 : 1;
      for (std::size_t i = 0; i < r.baselines.size(); ++i) {
        their_hits[i] += figure.good(r, r.baselines[i]) ? 1 : 0;
      }
    }
    out += fmt::format("| {} | {} | {} | {} |", figure.what, figure.goal, trials,
                       rate_text(hits, trials));
    for (const std::size_t count : their_hits) {
      const double percent = 100.0 * static_cast<double>(count) / static_cast<double>(theirs);
      out += theirs > 0 ? fmt::format(" {:.1f} % |", percent) : " - |";
    }
    out += "\n";
  }
  return out;
}

std::string nulls_table(const std::vector<Record>& records) {
  std::string out;
  put_header(out, {"noise", "trials", "named", "or random walk", "unexplained", "false alarms",
                   std::string(kTheirs)});
  std::map<std::string, Count> counts;
  for (const Record& r : records) {
    if (r.part != "nulls") continue;
    const auto alarm = [](Outcome o) { return !silent(o); };
    counts[r.noise].add(r, alarm);
  }
  for (const auto& [noise, count] : counts) {
    const auto quiet = count.of[static_cast<std::size_t>(Outcome::kAdequate)];
    const auto doubts = count.of[static_cast<std::size_t>(Outcome::kRightInSet)];
    const auto unexplained = count.of[static_cast<std::size_t>(Outcome::kUnexplained)];
    out += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", noise, count.trials,
                       count.trials - quiet - unexplained - doubts, doubts, unexplained,
                       rate_text(count.trials - quiet, count.trials), count.baselines_text());
  }
  return out;
}

bool right(const Record& r, Outcome o) {
  if (r.truth.starts_with("nothing")) return silent(o);
  return r.part == "outside" ? flagged(o) : named(o);
}

/// Truths in rows, every s together; outcomes in columns.
std::string confusion_table(const std::vector<Record>& records, const std::string& part) {
  std::string out;
  std::vector<std::string> header{"truth", "design", "rho, nearest", "trials"};
  for (std::size_t i = 0; i < kOutcomes; ++i) {
    header.emplace_back(name_of(static_cast<Outcome>(i)));
  }
  header.emplace_back(part == "outside" ? "flagged" : "right or in a set");
  header.emplace_back(kTheirs);
  put_header(out, header);
  using Key = std::pair<std::string, std::string>;
  std::map<Key, Count> counts;
  std::map<Key, std::size_t> hits;
  for (const Record& r : records) {
    if (r.part != part) continue;
    const Key key{r.truth, r.design};
    counts[key].add(r, [&](Outcome o) { return right(r, o); });
    hits[key] += right(r, r.outcome) ? 1 : 0;
  }
  for (const auto& [key, count] : counts) {
    const auto& [truth, design] = key;
    const auto nearest =
        std::max_element(count.nearest.begin(), count.nearest.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    out += fmt::format("| {} | {} | {} {} | {} |", truth, design, quantile_text(count.cosine, 0.5),
                       nearest->first, count.trials);
    for (const std::size_t n : count.of) out += n > 0 ? fmt::format(" {} |", n) : " |";
    out += fmt::format(" {} | {} |\n", rate_text(hits[key], count.trials), count.baselines_text());
  }
  return out;
}

std::string wrong_answers(const std::vector<Record>& records) {
  std::string out;
  put_header(out, {"part", "truth", "design", "noise", "s", "inner", "rho", "trial", "answer"});
  for (const Record& r : records) {
    if (right(r, r.outcome)) continue;
    std::string says = r.says;
    std::replace(says.begin(), says.end(), '|', '/');
    out += fmt::format("| {} | {} | {} | {} | {:g} | {:.4g} | {:.2f} | {} | {} |\n", r.part,
                       r.truth, r.design, r.noise, r.s, r.inner, r.cosine, r.trial, says);
  }
  return out;
}

constexpr std::string_view kPreamble =
    R"(# How often the diagnosis is right

Tables of measurements come from a simulator of their own (`tests/support/foreign_*`): it shares
no line with the effect catalogue or the simulated bench. In each a known effect is hidden, or two,
or none, or one that the catalogue does not hold, at a signal-to-noise ratio s = |L^-1 (I - P) g|:
the effect's column g in units of the true noise (covariance L L'), cleared of what the base model
takes up. rho is the cosine between the hidden effect and the nearest other effect of the catalogue
in the same metric. Rates are followed by their 95 % interval (Wilson). *Right in a set*: the answer
is at most three effects that cannot be told apart, the hidden one among them. Every trial's seed
follows from its name and number.

Beside the diagnosis stand four usual ways to choose terms, on the same tables with the catalogue's
own regressors: forward selection by BIC with independent errors, the same with errors whitened by
the noise estimated under the base model, LASSO, and sequential thresholding. For them *named* means
exactly the hidden effect and no other. They are spared effects whose signals do not move.

Made by:

)";

}  // namespace

std::string rate_text(std::size_t hits, std::size_t trials) {
  if (trials == 0) return "-";
  constexpr double kZ = 1.959964;
  const auto n = static_cast<double>(trials);
  const double p = static_cast<double>(hits) / n;
  const double middle = (p + kZ * kZ / (2.0 * n)) / (1.0 + kZ * kZ / n);
  const double half =
      kZ / (1.0 + kZ * kZ / n) * std::sqrt(p * (1.0 - p) / n + kZ * kZ / (4.0 * n * n));
  return fmt::format("{:.1f} % ({:.1f} ... {:.1f})", 100.0 * p,
                     100.0 * std::max(middle - half, 0.0), 100.0 * std::min(middle + half, 1.0));
}

std::string study_page(const std::vector<Record>& records, const std::string& command) {
  std::string out(kPreamble);
  out += fmt::format("    {}\n\n{} trials", command, records.size());
  const auto contradict = [](const Record& r) { return !r.contradiction.empty(); };
  out += fmt::format("; {} verdicts contradict themselves",
                     std::count_if(records.begin(), records.end(), contradict));
  std::set<std::string> rules;
  for (const Record& r : records) {
    if (contradict(r)) rules.insert(r.contradiction);
  }
  if (!rules.empty()) out += fmt::format(" ({})", fmt::join(rules, "; "));
  out += ".\n\n## Figures\n\n" + figures_table(records);
  out += "\n## Nothing hidden\n\n" + nulls_table(records);
  const std::vector<std::pair<std::string, std::string>> parts{
      {"effects", "One effect"},
      {"pairs", "Two effects"},
      {"outside", "Outside the catalogue"},
      {"shapes", "Another shape of the same physics"},
      {"sizes", "Small, long and repeated tables"},
      {"columns", "Fewer columns, and a static record"}};
  for (const auto& [part, title] : parts) {
    const bool there = std::any_of(records.begin(), records.end(),
                                   [&part = part](const Record& r) { return r.part == part; });
    if (there) out += fmt::format("\n## {}\n\n{}", title, confusion_table(records, part));
  }
  out += "\n## Every answer that was not right\n\n" + wrong_answers(records);
  return out;
}

}  // namespace fogbench::tests
