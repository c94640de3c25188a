#include "model/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/report/svg_plot.hpp"
#include "tests/model/models.hpp"
#include "tests/support/markup.hpp"

namespace fogbench::model {
namespace {

using testing::HasSubstr;
using testing::Not;

Comparison thermal_comparison(Table& table, config::ModelFile& model) {
  table = published_thermal();
  model = model_of({term("bias", 0.1), term("temperature_linear", 0.02)});
  model.name = "published <thermal> model";
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
  EXPECT_EQ(support::markup_error(page), "");
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("src=")));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(RoundTicks, AreRoundAndInside) {
  EXPECT_THAT(round_ticks(30.1, 55.9), testing::ElementsAre(35, 40, 45, 50, 55));
  for (double tick : round_ticks(-0.013, 0.027)) {
    EXPECT_GE(tick, -0.013);
    EXPECT_LE(tick, 0.027);
  }
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t out = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++out;
  }
  return out;
}

TEST(SvgPlot, LeavesOutWhatIsNotANumber) {
  SvgPlot plot{.title = "t", .x_label = "x", .y_label = "y"};
  plot.series = {
      {.points = {{1.0, 2.0}, {std::nan(""), 1.0}, {3.0, 4.0}}, .rows = {"7", "8", "9"}}};
  const std::string svg = plot.svg();
  EXPECT_EQ(count(svg, "h0"), 2u) << "one mark a point";
  EXPECT_THAT(svg, HasSubstr("data-rows=\"7 9\""));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  plot.series = {{.points = {{1.0, std::nan("")}}}};
  EXPECT_EQ(plot.svg(), "");
  plot.series = {{.points = {{1.0, 2.0}}}};  // one point still has axes
  EXPECT_THAT(plot.svg(), HasSubstr("h0"));
  EXPECT_THAT(plot.svg(), Not(HasSubstr("inf")));
}

TEST(SvgPlot, BreaksALineWhereAPointIsMissing) {
  SvgPlot plot{.title = "t", .x_label = "x", .y_label = "y"};
  plot.series = {
      {.kind = "a", .joined = true, .points = {{0, 0}, {1, 1}, {2, std::nan("")}, {3, 1}, {4, 0}}}};
  const std::string svg = plot.svg();
  const std::size_t at = svg.find("class=\"joint a\"");
  ASSERT_NE(at, std::string::npos);
  const std::string line = svg.substr(at, svg.find('>', at) - at);
  EXPECT_EQ(count(line, "M"), 2u) << line;
  EXPECT_EQ(count(line, "L"), 2u) << line;
}

TEST(SvgPlot, MarksSeriesWithShapesOfTheirOwn) {
  SvgPlot plot{.title = "t", .x_label = "x", .y_label = "y"};
  std::vector<std::string> pictures;
  for (const auto mark :
       {SvgPlot::Mark::kDot, SvgPlot::Mark::kSquare, SvgPlot::Mark::kRight, SvgPlot::Mark::kLeft}) {
    plot.series = {{.mark = mark, .points = {{0.0, 0.0}}}};
    pictures.push_back(plot.svg());
  }
  std::sort(pictures.begin(), pictures.end());
  EXPECT_EQ(std::unique(pictures.begin(), pictures.end()), pictures.end());
}

TEST(SvgPlot, DrawsTheNumbersOfBandsThatHaveRoomTheFirstBandsFirst) {
  SvgPlot plot{.title = "t", .x_label = "x", .y_label = "y"};
  plot.series = {{.points = {{0.0, 0.0}, {100.0, 1.0}}}};
  plot.bands = {{50, 50, "worst", "1"}, {51, 51, "beside it", "2"}, {90, 90, "apart", "3"}};
  const std::string svg = plot.svg();
  EXPECT_EQ(count(svg, "class=\"band\""), 3u);
  EXPECT_THAT(svg, HasSubstr(">1</text>"));
  EXPECT_THAT(svg, Not(HasSubstr(">2</text>")));
  EXPECT_THAT(svg, HasSubstr(">3</text>"));
}

TEST(MarkupError, SeesWhatIsNotClosedInOrder) {
  EXPECT_EQ(support::markup_error("<p>a<br>b</p><svg><line x=\"1\"/></svg>"), "");
  EXPECT_NE(support::markup_error("<p><b>a</p></b>"), "");
  EXPECT_NE(support::markup_error("<p>a"), "");
  EXPECT_NE(support::markup_error("<p>1 < 2</p>"), "");
  EXPECT_NE(support::markup_error("<p title=\"<b>\">a</p>"), "");
  EXPECT_NE(support::markup_error("<script>a"), "");
}

}  // namespace
}  // namespace fogbench::model
