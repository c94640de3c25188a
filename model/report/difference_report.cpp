#include "model/report/difference_report.hpp"

#include <fmt/format.h>

#include "config/rounding.hpp"
#include "model/report/report_page.hpp"
#include "model/report/svg_plot.hpp"

namespace fogbench::model {
namespace {

std::string cell(double value, double expanded) {
  const config::Rounded r = config::rounded(value, expanded);
  return fmt::format("<td>{} &plusmn; {}</td>", r.value, r.uncertainty);
}

}  // namespace

std::string difference_html(const Difference& difference, const std::vector<std::string>& sentences,
                            const std::string& name_a, const std::string& name_b,
                            const std::string& model) {
  std::string out = page_start(fmt::format("{} against {}", name_b, name_a));
  out += fmt::format("<h1>{} against {}</h1>\n<p class=\"sub\">{}</p>\n<div class=\"verdict{}\">\n",
                     escaped(name_b), escaped(name_a), escaped(model),
                     difference.differs() ? " fails" : "");
  for (const std::string& sentence : sentences) {
    out += fmt::format("<p{}>{}</p>\n", &sentence == &sentences.front() ? " class=\"lead\"" : "",
                       escaped(sentence));
  }
  out += fmt::format(
      "</div>\n<h2>Coefficients</h2>\n<div class=\"wide\"><table><tr><th>term</th>"
      "<th class=\"text\">unit</th><th>{} &plusmn; U</th><th>{} &plusmn; U</th>"
      "<th>difference &plusmn; U</th><th>p of all</th></tr>\n",
      escaped(name_a), escaped(name_b));
  for (const CoefficientDifference& c : difference.coefficients) {
    out += fmt::format("<tr{}><td>{}</td><td class=\"text\">{}</td>{}{}{}<td>{}</td></tr>\n",
                       c.differs() ? " class=\"fails\"" : "", escaped(c.name), escaped(c.unit),
                       cell(c.a, c.expanded_a), cell(c.b, c.expanded_b),
                       cell(c.difference, c.expanded_uncertainty),
                       c.p_of_all < 1e-4 ? "&lt; 0.0001" : fmt::format("{:.2g}", c.p_of_all));
  }
  return out +
         "</table></div>\n<p class=\"sub\">U: expanded uncertainty, 95.45 %. p of all: chance that "
         "noise lets any of the coefficients differ so much.</p>\n" +
         page_end();
}

}  // namespace fogbench::model
