#pragma once
// A gyro's passport: what was measured in its runs, held against limits, with everything that made
// the numbers. As JSON (without a language) and as one page that prints; acceptance/passport.md
// describes both.

#include <string>
#include <vector>

#include "acceptance/acceptance.hpp"
#include "acceptance/passport_texts.hpp"
#include "config/limits.hpp"

namespace fogbench::acceptance {

/// What a reader must know before he trusts the verdict: a text with a run or test, and what it is
/// about: instruments by role, with a date in brackets, an outcome, or a sentence.
struct Remark {
  Text text;
  std::string of;
  std::vector<std::string> about;
};

struct Passport {
  Acceptance acceptance;
  config::LimitsConfig limits;
  model::Judged judged;
  std::vector<Remark> remarks;
  std::string issued_at;  ///< ISO 8601, UTC
  std::string software_version;
};

/// Judges and remarks. The verdict is no better than indeterminate when a run was not completed or
/// its raw data are not as they were written. Errors: as judge_results.
Result<Passport> make_passport(Acceptance acceptance, config::LimitsConfig limits,
                               std::string issued_at, std::string software_version);

std::string remark_text(const Remark& remark, Language language);
/// `coverage_factor` of the printed uncertainty.
std::string change_text(const model::RunChange& change, double coverage_factor, Language language);

}  // namespace fogbench::acceptance
