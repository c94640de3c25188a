#include "model/report/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/rounding.hpp"
#include "config/units.hpp"
#include "model/report/svg_plot.hpp"

namespace fogbench::model {
namespace {

// Ink on paper: readable in black and white. Blue and vermilion stay apart for every kind of colour
// sight (Okabe and Ito's palette); what matters has a shape of its own as well.
constexpr auto kStyle = R"(
:root { --ink: #1c2126; --soft: #5d6670; --rule: #d9dde1; --point: #0072b2; --fail: #b84a00;
        --before: #8a929a; }
* { box-sizing: border-box; }
body { font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; color: var(--ink); background: #fff;
       margin: 0 auto; max-width: 74rem; padding: 1.5rem 1.25rem 4rem; }
h1 { font-size: 1.5rem; margin: 0 0 .25rem; line-height: 1.25; overflow-wrap: anywhere; }
h2 { font-size: 1.1rem; margin: 2.25rem 0 .75rem; }
.sub, figcaption, footer, .legend { color: var(--soft); }
.sub { margin: 0 0 1.25rem; overflow-wrap: anywhere; }
.verdict { border-left: .3rem solid var(--point); padding: .1rem 0 .1rem 1rem; max-width: 52rem; }
.verdict.fails { border-color: var(--fail); }
.verdict p { margin: .5rem 0; overflow-wrap: anywhere; }
.plots { display: grid; gap: 1.25rem;
         grid-template-columns: repeat(auto-fill, minmax(min(100%, 26rem), 1fr)); }
figure { margin: 0; break-inside: avoid; min-width: 0; }
figcaption { font-size: .875rem; margin: .1rem 0 0 .9rem; }
svg { width: 100%; height: auto; display: block; }
svg text { font: 12px system-ui, "DejaVu Sans", sans-serif; fill: var(--soft); }
svg .title { font-size: 13.5px; font-weight: 600; fill: var(--ink); }
svg .number { font-weight: 700; fill: var(--fail); }
svg .middle { text-anchor: middle; } svg .end { text-anchor: end; }
svg .grid { stroke: var(--rule); } svg .model { stroke: var(--ink); stroke-width: 1.2; }
svg .noise { stroke: var(--soft); stroke-dasharray: 5 4; }
svg .band { fill: var(--fail); fill-opacity: .13; }
.dots { fill: none; stroke-linecap: round; stroke: var(--point); stroke-opacity: .8; }
.marks { fill: #fff; fill-opacity: 0; stroke: var(--before); }
.joint { fill: none; stroke: var(--before); }
.marks.rising { fill: var(--point); fill-opacity: 1; stroke: var(--point); }
.joint.rising { stroke: var(--point); }
.marks.falling { fill: #fff; fill-opacity: 1; stroke: var(--fail); }
.joint.falling { stroke: var(--fail); stroke-dasharray: 6 3; }
.here { fill: none; stroke: var(--ink); stroke-width: 2; }
.legend { font-size: .875rem; display: flex; flex-wrap: wrap; gap: .25rem 1.5rem; margin: 0 0 1rem;
          padding: 0; list-style: none; break-after: avoid; break-inside: avoid; }
.legend svg { width: 1.75rem; height: .9rem; display: inline-block; vertical-align: -.1rem;
              margin-right: .4rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .9rem .3rem 0; text-align: right; border-bottom: 1px solid var(--rule);
         white-space: nowrap; vertical-align: top; }
th { font-weight: 600; color: var(--soft); }
th:first-child, td:first-child, th.text, td.text { text-align: left; }
tr.fails td { color: var(--fail); font-weight: 600; }
.lead, .to-do { font-weight: 600; }
.figures { display: grid; gap: .75rem 2rem; margin: 1.5rem 0 0;
           grid-template-columns: repeat(auto-fit, minmax(11rem, max-content)); }
.figures dt { color: var(--soft); font-size: .875rem; }
.figures dd { margin: 0; font-size: 1.35rem; font-variant-numeric: tabular-nums; }
.switch { position: sticky; top: 0; z-index: 1; background: #fff; padding: .4rem 0; }
.switch label { margin-left: .75rem; }
[data-show="before"] .after, [data-show="after"] .before, .alone,
[data-show="after"] .together { display: none; }
[data-show="after"] .alone { display: block; }
.dots.before { stroke: var(--before); }
.joint.thin { stroke: var(--ink); stroke-width: 1.2; } .marks.thin { display: none; }
.bar { display: block; height: .6rem; min-width: 1px; margin: .15rem 0; border: 1px solid; }
.bar.fitted { background: var(--point); border-color: var(--point); }
.bar.heldout { border-color: var(--fail); background:
  repeating-linear-gradient(135deg, #fff 0 3px, var(--fail) 3px 4px); }
.bar.floor { border: 0; border-top: 3px dotted var(--soft); height: 0; margin-top: .7rem; }
.bar.key { display: inline-block; width: 1.75rem; margin: 0 .4rem 0 0; vertical-align: middle; }
table.ladder { width: 100%; } td.bars { width: 60%; padding-right: 0; }
table.ranking td.bars { width: 14rem; } tr.added td:first-child { font-weight: 600; }
.soft { color: var(--soft); } li { margin: .2rem 0; overflow-wrap: anywhere; }
footer { border-top: 1px solid var(--rule); margin-top: 2.5rem; font-size: .875rem; }
#tip { position: fixed; z-index: 2; pointer-events: none; background: #fff; font-size: .8125rem;
       border: 1px solid var(--soft); border-radius: .25rem; padding: .3rem .6rem; }
#tip td { border: 0; padding: 0 .6rem 0 0; }
@media (max-width: 40rem) {
  table { font-size: .875rem; } th, td:first-child { white-space: normal; }
  th, td { padding-right: .5rem; }
  table.ranking .text { display: none; }
  table.ladder tr { display: grid; grid-template-columns: 1fr 6rem 6rem; }
  table.ladder td { border: 0; } table.ladder th.bars { display: none; }
  table.ladder td.bars { grid-column: 1 / -1; width: auto; border-bottom: 1px solid var(--rule); }
  table.ranking td.bars { width: 5rem; }
}
@media print {
  html { font-size: 12.5px; }
  body { max-width: none; padding: 0; font-size: 1rem; }
  h2 { break-after: avoid; } tr, li { break-inside: avoid; } #tip, .here, .switch { display: none; }
  .plots { grid-template-columns: 1fr 1fr; gap: .75rem; }
  svg text { font-size: 13.5px; } svg .title { font-size: 14.5px; }
  .figures { grid-template-columns: repeat(4, auto); }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)";

/// A value and its expanded uncertainty, to the digits that the uncertainty leaves meaning in.
std::pair<std::string, std::string> value_and_uncertainty(const Estimate& e) {
  if (std::isnan(e.value)) return {"not determined", ""};
  if (e.held) return {fmt::format("{:.6g}", e.value), "held"};
  const double expanded = e.coverage_factor * e.standard_error;
  const config::Rounded r = config::rounded(e.value, expanded);
  return {r.value, std::isfinite(expanded) ? r.uncertainty : "unknown"};
}

}  // namespace

std::string page_start(const std::string& title, std::string_view language,
                       std::string_view style) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n",
      language, escaped(title), kStyle, style);
}

std::string page_end(const std::string& rows_json) {
  if (rows_json.empty()) return "</body>\n</html>\n";
  return fmt::format(
      "<div id=\"tip\" hidden=\"hidden\"></div>\n"
      "<script type=\"application/json\" id=\"rows\">{}</script>\n<script>{}</script>\n"
      "</body>\n</html>\n",
      rows_json, page_script());
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
