#pragma once
// What the HTML pages share: the frame with its style and script, headings with units, numbers, and
// the table of coefficients. One file, nothing from outside; prints on paper; readable without the
// script.
//
// report.css: ink on paper, readable in black and white. Blue and vermilion stay apart for every
// kind of colour sight (Okabe and Ito's palette); what matters has a shape of its own as well.
// report.js: a path's marks begin with "M x y" each and stand for the rows that data-rows lists in
// the same order. The pointer (or the arrow keys) chooses a row; a ring marks it in every plot.

#include <string>
#include <string_view>
#include <vector>

#include "model/fit/fit.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// Everything up to the body's first element. `style` follows the pages' own. Each printed sheet
/// carries the title and its number.
std::string page_start(const std::string& title, std::string_view language = "en",
                       std::string_view style = {});
/// The rest, with `rows_json` for the script: what a pointed-at row shows (report_plots.hpp).
/// Without it the page has no script.
std::string page_end(const std::string& rows_json = {});

/// What was recognised in the data's files; nothing where they have the plain form.
std::string provenance_text(const Table& table);

/// "temperature, degC" of "temperature_c"; time is printed in hours.
std::string heading_of(const std::string& variable);
/// ", deg/h", or nothing for no unit: what follows a label.
std::string with_unit(std::string_view unit);
/// Three digits; `otherwise` when it is not a number.
std::string number_text(double value, std::string_view otherwise = "unknown");

/// Estimates with their expanded uncertainty; those named in `added` are marked as such.
std::string estimates_table(const std::vector<Estimate>& estimates,
                            const std::vector<std::string>& added = {});

}  // namespace fogbench::model
