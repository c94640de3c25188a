#pragma once
// What the sections of a passport's page are written with: words, numbers and tables in the page's
// language.

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acceptance/passport.hpp"

namespace fogbench::acceptance {

class PassportWriter {
 public:
  PassportWriter(const Passport& passport, Language language)
      : passport_(passport), acceptance_(passport.acceptance), language_(language) {}

 protected:
  std::string say(Text which) const { return std::string(text(which, language_)); }
  /// The text with what stands in its places.
  template <class... Values>
  std::string say(Text which, const Values&... values) const {
    return fmt::format(fmt::runtime(text(which, language_)), values...);
  }
  std::string name(const std::string& quantity) const;
  std::string unit(const std::string& unit) const;

  /// "2026-03-01 12:00:00 UTC" of ISO 8601.
  static std::string date(const std::string& time);
  std::string number(double value) const;
  /// Empty for none.
  std::string number(const std::optional<double>& value) const;
  /// Value and expanded uncertainty, to the digits that mean something.
  std::pair<std::string, std::string> rounded(double value, double expanded) const;
  /// The two in one cell.
  std::string with_uncertainty(double value, double expanded) const;
  double expanded(const Figure& figure) const {
    return passport_.judged.coverage_factor * figure.standard_error;
  }

  /// `together` stays on one printed page.
  void section(Text title, bool together = false);
  void end_section() { out_ += "</section>\n"; }
  void note(const std::string& words);
  /// A heading whose first `text_columns` are of text.
  void table(const std::vector<std::string>& heads, std::size_t text_columns,
             const char* kind = "full");
  /// `last` is the class of the last cell.
  void row(const std::vector<std::string>& cells, const char* last = "");
  void end_table() { out_ += "</table></div>\n"; }

  const Passport& passport_;
  const Acceptance& acceptance_;
  Language language_;
  std::string out_;

 private:
  std::size_t text_columns_ = 0;
};

}  // namespace fogbench::acceptance
