#include "model/report/diagnosis_report.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>

#include "model/report/report_plots.hpp"
#include "model/report/svg_plot.hpp"
#include "tests/model/models.hpp"
#include "tests/support/markup.hpp"

namespace fogbench::model {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Two sweeps of a field, up and down, and a rate that lags behind the field; the segments' name
/// would end the page's script if it were not escaped.
Table swept_table() {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.004);
  std::vector<double> time, duration, error, field, temperature, rate;
  TextColumn segment{{"coil_z/</script>up", "coil_z/</script>down"}, {}};
  double play = 0.0;
  for (int i = 0; i < 164; ++i) {
    const int step = i % 82;
    const double h = step <= 40 ? -300.0 + 15.0 * step : 300.0 - 15.0 * (step - 41);
    play = std::clamp(play, h / 100.0 - 0.6, h / 100.0 + 0.6);
    time.push_back(60.0 * i);
    duration.push_back(60.0);
    error.push_back(0.004);
    field.push_back(h);
    temperature.push_back(25.0 + 0.05 * i);
    rate.push_back(10.0 - 0.1 * h / 100.0 + 0.05 * play + noise(random));
    segment.index.push_back(step <= 40 ? 0 : 1);
  }
  Table table;
  table.set_column("time_s", time);
  table.set_column("duration_s", duration);
  table.set_column("rate_std_error_deg_per_h", error);
  table.set_column("field_z_ut", field);
  table.set_column("temperature_c", temperature);
  table.set_column("rate_deg_per_h", rate);
  table.set_segment(segment);
  return table;
}

/// What a diagnosis of the swept table says, filled by hand but for the fits.
Diagnosis hysteresis_found(const config::ModelFile& model) {
  Diagnosis d;
  d.verdict = Verdict::kAmbiguous;
  d.p_adequate = 2.5e-7;
  d.table = swept_table();
  d.rows_per_bin = 12;
  auto before = compare(d.table, model, {});
  auto after =
      fit(d.table, model_of_effects({"bias", "magnetic_linear_z", "magnetic_hysteresis_z"}), {});
  EXPECT_TRUE(before) << before.error().message;
  EXPECT_TRUE(after) << after.error().message;
  if (!before || !after) return d;
  d.before = std::move(*before);
  d.after = std::move(*after);
  d.before.noise_known = true;
  // More than the list shows at once, and some that do not fail.
  const std::vector<Region> regions = d.before.regions;
  while (d.before.regions.size() < 40) {
    d.before.regions.insert(d.before.regions.end(), regions.begin(), regions.end());
  }
  for (std::size_t k = 0; k < d.before.regions.size(); ++k) {
    d.before.regions[k].p_family_wise = k < 30 ? 0.001 : 0.5;
    d.before.regions[k].says += fmt::format(" (<{}>)", k);
  }
  d.heldout_rms = 1.1 * d.before.fit.rms;
  d.noise_floor = 0.004;
  d.noise = {.angle_random_walk_deg_per_sqrt_h = 0.00052, .bias_instability_deg_per_h = 0.0011};
  MissingEffect missing;
  missing.found.effect = "magnetic_hysteresis_z";
  missing.found.p_value = 2.5e-7;
  missing.found.probability = 0.93;
  missing.found.rivals = {{"magnetic_settling_z", 0.05}, {"random_walk", 0.02}};
  missing.found.or_shape = "sign(dH) < 0";
  missing.found.inner_at_edge = true;
  for (const Estimate& e : d.after.estimates) {
    if (e.name.starts_with("magnetic_hysteresis_z")) missing.estimates.push_back(e);
  }
  missing.rms_after = d.after.rms;
  missing.heldout_rms_after = 1.05 * d.after.rms;
  d.ladder = {{"", d.before.fit.rms, d.heldout_rms},
              {"magnetic_hysteresis_z", d.after.rms, missing.heldout_rms_after}};
  d.missing = {missing};
  d.ambiguous = {{"magnetic_hysteresis_z", "magnetic_settling_z", "random_walk"}};
  d.not_testable = {{"magnetic_cross_xy", "the table has no <field_x_ut>"},
                    {"magnetic_cross_zx", "the table has no <field_x_ut>"},
                    {"warm_up", "every row is later than \"5 h\""}};
  d.bounds = {{"magnetic_quadratic_z", 0.0021, "deg/h/(100 uT)^2"},
              {"temperature_rate", 0.013, "deg/h/(degC/h)"}};
  d.next_measurements = {{{"magnetic_hysteresis_z", "magnetic_settling_z"},
                          "average each field point in two windows, early & late"}};
  d.verdict = Verdict::kAmbiguous;
  return d;
}

class DiagnosisHtml : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    model_ = new config::ModelFile(model_of_effects({"bias", "magnetic_linear_z"}));
    model_->name = "fields & <nothing else>";
    diagnosis_ = new Diagnosis(hysteresis_found(*model_));
    words_ = new VerdictWords(verdict_in_words(*diagnosis_, "fogbench fit"));
    page_ = new std::string(diagnosis_html(*diagnosis_, *words_, *model_, "a & <b>.csv"));
    // To look at it: DIAGNOSIS_PAGE=/tmp/page.html build/.../model_test
    if (const char* file = std::getenv("DIAGNOSIS_PAGE")) std::ofstream(file) << *page_;
  }
  static void TearDownTestSuite() {
    delete model_;
    delete diagnosis_;
    delete words_;
    delete page_;
  }

  static inline config::ModelFile* model_ = nullptr;
  static inline Diagnosis* diagnosis_ = nullptr;
  static inline VerdictWords* words_ = nullptr;
  static inline std::string* page_ = nullptr;
};

TEST_F(DiagnosisHtml, HoldsEverySentence) {
  for (const std::string& sentence : words_->sentences()) {
    EXPECT_THAT(*page_, HasSubstr(escaped(sentence)));
  }
  EXPECT_THAT(*page_, HasSubstr("<h1>" + escaped(words_->verdict) + "</h1>"));
}

TEST_F(DiagnosisHtml, HoldsEveryFailingRegionsSentenceAndMarksItInAPlot) {
  const auto failing = failing_regions(diagnosis_->before);
  ASSERT_EQ(failing.size(), 30u);
  for (const Region* region : failing) {
    EXPECT_THAT(*page_, HasSubstr("<li>" + escaped(region->says) + "</li>"));
    if (region->variable.empty()) continue;
    EXPECT_THAT(*page_, HasSubstr("<title>" + escaped(region->says) + "</title></rect>"));
  }
}

TEST_F(DiagnosisHtml, IsOneWellFormedFileThatFetchesNothing) {
  EXPECT_EQ(support::markup_error(*page_), "");
  for (const char* outside : {"http", "src=", "@import", "url(", "href"}) {
    EXPECT_THAT(*page_, Not(HasSubstr(outside))) << outside;
  }
  EXPECT_THAT(*page_, Not(HasSubstr(">nan")));
  EXPECT_THAT(*page_, Not(HasSubstr(">inf")));
}

TEST_F(DiagnosisHtml, EscapesTextOfTheData) {
  EXPECT_THAT(*page_, HasSubstr("a &amp; &lt;b&gt;.csv"));
  EXPECT_THAT(*page_, HasSubstr("fields &amp; &lt;nothing else&gt;"));
  EXPECT_THAT(*page_, HasSubstr("the table has no &lt;field_x_ut&gt;"));
  EXPECT_THAT(*page_, HasSubstr("sign(dH) &lt; 0"));
  EXPECT_THAT(*page_, Not(HasSubstr("coil_z/</script>")));
}

TEST_F(DiagnosisHtml, HoldsWhatWasFoundWithItsRivalsAndWhatWasNot) {
  EXPECT_THAT(*page_, HasSubstr("<td>+ magnetic_hysteresis_z</td>"));
  EXPECT_THAT(*page_, HasSubstr("<td>or random_walk</td>"));
  EXPECT_THAT(*page_, HasSubstr("<td>93 %</td>"));
  EXPECT_THAT(*page_, HasSubstr("<td>&lt; 0.0001</td>"));
  EXPECT_THAT(*page_, HasSubstr("magnetic_hysteresis_z.width (added)"));
  EXPECT_THAT(*page_, HasSubstr("<td>magnetic_quadratic_z</td><td>0.0021</td>"));
  EXPECT_THAT(*page_, HasSubstr("magnetic_cross_xy, magnetic_cross_zx: the table has no"));
  EXPECT_THAT(*page_, HasSubstr("early &amp; late"));
  EXPECT_THAT(*page_, HasSubstr("the mean of up to 12 rows"));
}

TEST_F(DiagnosisHtml, DrawsTheLoopInBothDirections) {
  EXPECT_THAT(*page_, HasSubstr("Loop over field z, uT"));
  EXPECT_THAT(*page_, HasSubstr("class=\"joint before rising\""));
  EXPECT_THAT(*page_, HasSubstr("class=\"joint before falling\""));
  EXPECT_THAT(*page_, Not(HasSubstr("Loop over temperature"))) << "it only rises";
}

TEST_F(DiagnosisHtml, OffersNoSwitchWhereNothingWasAdded) {
  EXPECT_THAT(*page_, HasSubstr("<form class=\"switch\""));
  Diagnosis nothing;
  nothing.table = diagnosis_->table;
  nothing.before = diagnosis_->before;
  nothing.after = diagnosis_->before.fit;
  nothing.noise_floor = std::nan("");
  nothing.heldout_rms = std::nan("");
  nothing.ladder = {{"", 0.01, std::nan("")}};
  const std::string page =
      diagnosis_html(nothing, verdict_in_words(nothing, "fogbench fit"), *model_, "data.csv");
  EXPECT_EQ(support::markup_error(page), "");
  EXPECT_THAT(page, HasSubstr("Nothing is missing"));
  EXPECT_THAT(page, Not(HasSubstr("<form")));
  EXPECT_THAT(page, Not(HasSubstr("noise alone</td>"))) << "it is not known";
  EXPECT_THAT(page, Not(HasSubstr("angle random walk"))) << "nor are the noise's coefficients";
  EXPECT_THAT(*page_, HasSubstr("<td>N, angle random walk</td><td>0.00052</td>"));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace fogbench::model
