#include "model/report/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/rounding.hpp"
#include "config/units.hpp"
#include "model/report/report.css.hpp"
#include "model/report/report.js.hpp"
#include "model/report/svg_plot.hpp"

namespace fogbench::model {
namespace {

/// A value and its expanded uncertainty, to the digits that the uncertainty leaves meaning in.
std::pair<std::string, std::string> value_and_uncertainty(const Estimate& e) {
  if (!e.unexcited.empty()) return {"not excited", ""};
  if (std::isnan(e.value)) return {"not determined", ""};
  if (e.held) return {fmt::format("{:.6g}", e.value), "held"};
  const double expanded = e.coverage_factor * e.standard_error;
  const config::Rounded r = config::rounded(e.value, expanded);
  return {r.value, std::isfinite(expanded) ? r.uncertainty : "unknown"};
}

/// Within quotes of a style sheet.
std::string css_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == '"' || c == '\\' || c == '<') {
      out += fmt::format("\\{:x} ", static_cast<unsigned char>(c));
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

std::string page_start(const std::string& title, std::string_view language,
                       std::string_view style) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}{}@page {{ @top-left {{ content: \"{}\"; }} }}\n</style>\n"
      "</head>\n<body>\n",
      language, escaped(title), kReportStyle, style, css_text(title));
}

std::string page_end(const std::string& rows_json) {
  if (rows_json.empty()) return "</body>\n</html>\n";
  return fmt::format(
      "<div id=\"tip\" hidden=\"hidden\"></div>\n"
      "<script type=\"application/json\" id=\"rows\">{}</script>\n<script>{}</script>\n"
      "</body>\n</html>\n",
      rows_json, kReportScript);
}

std::string provenance_text(const Table& table) {
  std::string out;
  for (const std::string& line : table.provenance()) {
    out += fmt::format("<p class=\"sub\">Data read as {}</p>\n", escaped(line));
  }
  return out;
}

std::string heading_of(const std::string& variable) {
  if (variable == "time_s") return "time, h";
  std::string words = variable;
  const std::string_view unit = config::unit_of(variable);
  for (const config::UnitSuffix& suffix : config::kUnitSuffixes) {
    if (!variable.ends_with(suffix.suffix)) continue;
    words = variable.substr(0, variable.size() - suffix.suffix.size());
    break;
  }
  std::replace(words.begin(), words.end(), '_', ' ');
  return words + with_unit(unit);
}

std::string with_unit(std::string_view unit) {
  return unit.empty() ? "" : fmt::format(", {}", unit);
}

std::string number_text(double value, std::string_view otherwise) {
  return std::isfinite(value) ? config::significant(value, 3) : std::string(otherwise);
}

std::string estimates_table(const std::vector<Estimate>& estimates,
                            const std::vector<std::string>& added) {
  std::string out =
      "<div class=\"wide\"><table><tr><th>term</th><th>estimate</th><th>&plusmn; (95.45 %)</th>"
      "<th class=\"text\">unit</th></tr>\n";
  for (const Estimate& e : estimates) {
    const auto [value, uncertainty] = value_and_uncertainty(e);
    const bool is_new = std::find(added.begin(), added.end(), e.name) != added.end();
    out += fmt::format("<tr{}><td>{}{}</td><td>{}</td><td>{}</td><td class=\"text\">{}</td></tr>\n",
                       is_new ? " class=\"added\"" : "", escaped(e.name), is_new ? " (added)" : "",
                       value, uncertainty, escaped(e.unit));
  }
  return out + "</table></div>\n";
}

}  // namespace fogbench::model
