#include "acceptance/passport_writer.hpp"

#include <cmath>

#include "config/rounding.hpp"
#include "model/report/svg_plot.hpp"

namespace fogbench::acceptance {
using model::escaped;

std::string PassportWriter::name(const std::string& quantity) const {
  return escaped(quantity_name(quantity, language_));
}

std::string PassportWriter::unit(const std::string& unit) const {
  return escaped(unit_name(unit, language_));
}

std::string PassportWriter::date(const std::string& time) {
  std::string out = time;
  if (const std::size_t t = out.find('T'); t != std::string::npos) out[t] = ' ';
  if (out.ends_with('Z')) out.replace(out.size() - 1, 1, " UTC");
  return out;
}

std::string PassportWriter::number(double value) const {
  return std::isfinite(value) ? localised(fmt::format("{:.4g}", value), language_) : "&ndash;";
}

std::string PassportWriter::number(const std::optional<double>& value) const {
  return value ? localised(fmt::format("{:g}", *value), language_) : "";
}

std::pair<std::string, std::string> PassportWriter::rounded(double value, double expanded) const {
  if (std::isnan(value)) return {"&ndash;", ""};
  const config::Rounded r = config::rounded(value, expanded);
  const bool known = std::isfinite(expanded) && expanded > 0.0;
  return {localised(r.value, language_), known ? localised(r.uncertainty, language_) : "&ndash;"};
}

std::string PassportWriter::with_uncertainty(double value, double expanded) const {
  const auto [v, u] = rounded(value, expanded);
  return u.empty() ? v : fmt::format("{} &plusmn; {}", v, u);
}

void PassportWriter::section(Text title, bool together) {
  out_ +=
      fmt::format("<section{}>\n<h2>{}</h2>\n", together ? " class=\"together\"" : "", say(title));
}

void PassportWriter::note(const std::string& words) {
  out_ += fmt::format("<p class=\"soft\">{}</p>\n", words);
}

void PassportWriter::table(const std::vector<std::string>& heads, std::size_t text_columns,
                           const char* kind) {
  out_ += fmt::format("<div class=\"wide\"><table class=\"{}\"><thead><tr>", kind);
  for (std::size_t i = 0; i < heads.size(); ++i) {
    out_ += fmt::format("<th{}>{}</th>", i < text_columns ? " class=\"text\"" : "", heads[i]);
  }
  out_ += "</tr></thead>\n";
  text_columns_ = text_columns;
}

void PassportWriter::row(const std::vector<std::string>& cells, const char* last) {
  out_ += "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const char* kind = i < text_columns_ ? "text" : i + 1 == cells.size() ? last : "";
    out_ += fmt::format("<td class=\"{}\">{}</td>", kind, cells[i]);
  }
  out_ += "</tr>\n";
}

}  // namespace fogbench::acceptance
