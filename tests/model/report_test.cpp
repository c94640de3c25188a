#include "model/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/svg_plot.hpp"

namespace fogbench::model {
namespace {

using testing::HasSubstr;
using testing::Not;

Comparison thermal_comparison(Table& table, config::ModelFile& model) {
  table.set_column("temperature_c", {31, 35, 40, 45, 50, 55});
  table.set_column("rate_deg_per_h", {0.489, 0.346, 0.498, 0.540, 0.919, 1.564});
  table.set_column("sigma_deg_per_h", {0.081, 0.051, 0.051, 0.043, 0.043, 0.019});
  model.name = "published <thermal> model";
  model.terms.resize(2);
  model.terms[0].effect = "bias";
  model.terms[0].coefficient = 0.1;
  model.terms[1].effect = "temperature_linear";
  model.terms[1].coefficient = 0.02;
  auto result = compare(table, model, {.as_is = true});
  return result ? std::move(*result) : Comparison{};
}

TEST(ReportHtml, HoldsTheWordsThePlotsAndTheTablesAndNothingFromOutside) {
  Table table;
  config::ModelFile model;
  const Comparison comparison = thermal_comparison(table, model);
  const std::string page = report_html(comparison, table, model, "a & b.csv");
  EXPECT_THAT(page, HasSubstr("published &lt;thermal&gt; model against the measurements"));
  EXPECT_THAT(page, HasSubstr("a &amp; b.csv"));
  for (const std::string& sentence : comparison.sentences) {
    EXPECT_THAT(page, HasSubstr(escaped(sentence)));
  }
  EXPECT_THAT(page, HasSubstr("Residual by temperature, degC"));
  EXPECT_THAT(page, HasSubstr("class=\"band\""));
  EXPECT_THAT(page, HasSubstr("<tr class=\"fails\">"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(RoundTicks, AreRoundAndInside) {
  EXPECT_THAT(round_ticks(30.1, 55.9), testing::ElementsAre(35, 40, 45, 50, 55));
  for (double tick : round_ticks(-0.013, 0.027)) {
    EXPECT_GE(tick, -0.013);
    EXPECT_LE(tick, 0.027);
  }
}

TEST(SvgPlot, LeavesOutWhatIsNotANumber) {
  SvgPlot plot{.title = "t", .x_label = "x", .y_label = "y"};
  plot.points = {{1.0, 2.0}, {std::nan(""), 1.0}, {3.0, 4.0}};
  const std::string svg = plot.svg();
  std::size_t circles = 0;
  for (std::size_t at = svg.find("<circle"); at != std::string::npos;
       at = svg.find("<circle", at + 1)) {
    ++circles;
  }
  EXPECT_EQ(circles, 2u);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  plot.points = {{1.0, std::nan("")}};
  EXPECT_EQ(plot.svg(), "");
  plot.points = {{1.0, 2.0}};  // one point still has axes
  EXPECT_THAT(plot.svg(), HasSubstr("<circle"));
  EXPECT_THAT(plot.svg(), Not(HasSubstr("inf")));
}

}  // namespace
}  // namespace fogbench::model
