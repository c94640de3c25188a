#include "acceptance/passport.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "acceptance/passport_json.hpp"
#include "acceptance/passport_page.hpp"
#include "config/paths.hpp"
#include "record/run_log.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::acceptance {
namespace {

using model::Conformity;
using procedures::Point;
using procedures::PointKind;
using testing::HasSubstr;
using testing::Not;

procedures::RunHeader header_of(const std::string& gyro) {
  procedures::RunHeader header;
  header.procedure = "acceptance";
  header.procedure_json = "{}";
  header.bench = "factory";
  header.bench_json = "{}";
  header.gyro_serial_number = gyro;
  header.operator_name = "Ivanova <night shift>";
  header.software_version = "0.1.0";
  header.started_at = "2026-03-01T00:00:00Z";
  header.frame_rate_hz = 1.0;
  return header;
}

Point window(PointKind kind, const std::string& segment, int test, double time_s, double rate) {
  Point point;
  point.kind = kind;
  point.segment = segment;
  point.test = test;
  point.time_s = time_s;
  point.duration_s = 100.0;
  point.rate_deg_per_h = rate;
  point.rate_std_error_deg_per_h = 0.01;
  point.temperature_c = 21.0;
  point.field_set_ut = point.target_c = std::nan("");
  return point;
}

/// A store with runs of a gyro whose K_z is 0.2 and whose rate rises by 0.01 deg/h/degC.
class PassportTest : public testing::Test {
 protected:
  PassportTest() {
    // Where the ready models are.
    setenv("FOGBENCH_CONFIG_DIR", (tests::source_tree() / "config").c_str(), 1);
  }
  ~PassportTest() override { unsetenv("FOGBENCH_CONFIG_DIR"); }

  void record(const std::string& gyro, procedures::RunOutcome outcome, int tests = 2) {
    auto log = record::RunLog::open(folder_ / "store.db");
    ASSERT_TRUE(log);
    procedures::RunHeader header = header_of(gyro);
    if (takes_up_ != 0) header.continues.emplace().run = takes_up_;
    ASSERT_TRUE(
        (*log)->begin_run(header, {{"gyro", "FOG", gyro, "", ""},
                                   {"magnetometer", "MAG", "M-1", "2025-02-01", "2026-02-01"},
                                   {"thermostat", "TH", "T-1", "2026-01-01", "2027-01-01"}}));
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0.0, 0.01);
    double time = 0.0;
    const auto add = [&](Point point) {
      point.time_s = time += 100.0;
      point.rate_deg_per_h += noise(random);
      ASSERT_TRUE((*log)->point(point));
    };
    for (int test = 1; test <= tests; ++test) {
      for (int i = 0; i < 10; ++i) add(window(PointKind::kTransient, "warm_up", test, 0, 1.0));
      add(window(PointKind::kBaseline, "coil/baseline", test, 0, 1.0));
      for (const double level : {0.0, 150.0, 300.0, 150.0, 0.0, -150.0, -300.0, -150.0, 0.0}) {
        Point point = window(PointKind::kAverage, "coil_z/up", test, 0, 1.0 + 0.002 * level);
        point.field_set_ut = point.field_z_ut = level;
        add(point);
      }
      for (const double target : {31.0, 41.0, 51.0}) {
        for (int i = 0; i < 3; ++i) {
          Point point = window(PointKind::kAverage, "thermostat/plateau", test, 0,
                               1.0 + 0.01 * (target - 21.0));
          point.target_c = point.temperature_c = target;
          point.heater_w = 3.0;
          add(point);
        }
      }
    }
    drivers::GyroBlock frames;
    for (int i = 0; i < 1200; ++i) {
      frames.index.push_back(i);
      frames.rate_deg_per_h.push_back(static_cast<float>(noise(random)));
    }
    ASSERT_TRUE((*log)->gyro_samples(frames));
    ASSERT_TRUE((*log)->end_run({outcome, "", true, "2026-03-01T10:00:00Z", {}}));
  }

  Result<Acceptance> gather(const std::vector<std::int64_t>& runs, bool unfinished = false) {
    auto reader = record::RunLogReader::open(folder_ / "store.db");
    EXPECT_TRUE(reader);
    return gather_acceptance(**reader, runs, {.model = {}, .unfinished = unfinished});
  }

  static config::LimitsConfig limits(double maximum_of_k) {
    config::LimitsConfig limits;
    limits.name = "<limits>";
    limits.tests = 2;
    config::Limit k;
    k.quantity = "K_z";
    k.maximum = maximum_of_k;
    k.unit = "deg/h per 100 uT";
    limits.limits.push_back(k);
    return limits;
  }

  Result<Passport> passport(double maximum_of_k = 1.0, bool unfinished = false) {
    auto acceptance = gather({1}, unfinished);
    if (!acceptance) return acceptance.error();
    return make_passport(std::move(*acceptance), limits(maximum_of_k), "2026-03-02T00:00:00Z",
                         "0.1.0");
  }

  support::TemporaryFolder folder_;
  std::int64_t takes_up_ = 0;  ///< by the runs that are recorded from now on
};

const model::Measured* find(const Acceptance& acceptance, const std::string& quantity,
                            const std::string& test) {
  for (const model::Measured& m : acceptance.measured) {
    if (m.quantity == quantity && m.test == test) return &m;
  }
  return nullptr;
}

TEST_F(PassportTest, FindsEachTestsResultsWithinTheirUncertainty) {
  record("SN-7", procedures::RunOutcome::kCompleted);
  const auto acceptance = gather({1});
  ASSERT_TRUE(acceptance) << acceptance.error().message;
  ASSERT_EQ(acceptance->tests.size(), 2U);
  EXPECT_EQ(acceptance->tests[0].model, "general model");
  for (const std::string test : {"1", "2"}) {
    const auto* k = find(*acceptance, "K_z", test);
    const auto* coefficient = find(*acceptance, "magnetic_linear_z", test);
    const auto* sigma = find(*acceptance, "temperature_sigma", test);
    ASSERT_TRUE(k && coefficient && sigma);
    EXPECT_NEAR(k->value, 0.2, 4.0 * k->standard_error);
    EXPECT_GT(k->standard_error, 0.5 * 0.01 * std::sqrt(2.0) / 6.0);
    EXPECT_NEAR(coefficient->value, 0.2, 5.0 * coefficient->standard_error);
    EXPECT_NEAR(sigma->value, 0.01, 4.0 * sigma->standard_error);
    EXPECT_GT(sigma->coverage_factor, 2.2) << "6 degrees of freedom";
  }
  ASSERT_EQ(acceptance->noise.size(), 1U);
  EXPECT_EQ(acceptance->noise[0].samples, 1000U) << "ten windows of 100 s";
  EXPECT_NE(find(*acceptance, "angle_random_walk", "1"), nullptr);
}

TEST_F(PassportTest, ARunThatWasNotCompletedIsTakenOnlyWhenAskedForAndNeverPasses) {
  record("SN-7", procedures::RunOutcome::kAborted);
  const auto refused = passport();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "run 1 was not completed (aborted); --unfinished takes what it has");
  const auto asked = passport(1.0, true);
  ASSERT_TRUE(asked) << asked.error().message;
  EXPECT_EQ(asked->judged.results[0].verdict, Conformity::kPass);
  EXPECT_EQ(asked->judged.overall, Conformity::kIndeterminate);
  EXPECT_THAT(passport_html(*asked, Language::kRussian), HasSubstr("прерван оператором"));
}

TEST_F(PassportTest, ARunThatTakesUpAnInterruptedOneCountsWithIt) {
  {
    auto log = record::RunLog::open(folder_ / "store.db");
    ASSERT_TRUE(log);
    ASSERT_TRUE((*log)->begin_run(header_of("SN-7"), {}));
  }
  takes_up_ = 1;
  record("SN-7", procedures::RunOutcome::kCompleted);
  const auto both = gather({2});
  ASSERT_TRUE(both) << both.error().message;
  ASSERT_EQ(both->runs.size(), 2U);
  EXPECT_TRUE(both->runs[0].taken_up);
  EXPECT_EQ(both->runs[0].run.outcome(), "interrupted");
  const auto made = make_passport(*both, limits(1.0), "2026-03-02T00:00:00Z", "0.1.0");
  ASSERT_TRUE(made);
  EXPECT_EQ(made->judged.overall, Conformity::kPass);
  EXPECT_FALSE(gather({1})) << "alone it is an interrupted run";
}

TEST_F(PassportTest, RunsOfTwoGyrosAreRefused) {
  record("SN-7", procedures::RunOutcome::kCompleted, 1);
  record("SN-8", procedures::RunOutcome::kCompleted, 1);
  const auto two = gather({1, 2});
  ASSERT_FALSE(two);
  EXPECT_EQ(two.error().message,
            "run 1 is of gyro \"SN-7\" and run 2 of \"SN-8\"; expected runs of one gyro");
  EXPECT_FALSE(gather({1, 1}));
}

TEST_F(PassportTest, SeveralRunsOfOneGyroAreSoManyTests) {
  record("SN-7", procedures::RunOutcome::kCompleted, 1);
  record("SN-7", procedures::RunOutcome::kCompleted, 1);
  const auto two = gather({1, 2});
  ASSERT_TRUE(two) << two.error().message;
  EXPECT_EQ(two->tests[0].name, "1/1");
  EXPECT_EQ(two->tests[1].name, "2/1");
}

TEST_F(PassportTest, ChangedRawDataNeverPass) {
  record("SN-7", procedures::RunOutcome::kCompleted);
  EXPECT_EQ(passport()->judged.overall, Conformity::kPass);
  auto database = record::Database::open(folder_ / "store.db", record::Database::Mode::kWrite);
  ASSERT_TRUE(database);
  ASSERT_TRUE((*database)->execute("UPDATE runs SET raw_sha256 = 'other'"));
  const auto changed = passport();
  ASSERT_TRUE(changed);
  EXPECT_EQ(changed->judged.overall, Conformity::kIndeterminate);
  EXPECT_THAT(passport_html(*changed, Language::kEnglish), HasSubstr("NOT as they were written"));
}

TEST_F(PassportTest, ThePageHoldsEverythingAndNothingFromOutside) {
  record("SN-7", procedures::RunOutcome::kCompleted);
  const auto made = passport(0.1);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->judged.overall, Conformity::kFail);
  for (const Language language : {Language::kEnglish, Language::kRussian}) {
    const std::string page = passport_html(*made, language);
    EXPECT_THAT(page, HasSubstr("SN-7"));
    EXPECT_THAT(page, HasSubstr("Ivanova &lt;night shift&gt;"));
    EXPECT_THAT(page, HasSubstr(made->acceptance.runs[0].raw_sha256));
    EXPECT_THAT(page, HasSubstr("<svg"));
    for (const char* outside : {"http:", "https:", "src=", "@import", "<script", "nan", "{}"}) {
      EXPECT_THAT(page, Not(HasSubstr(outside)));
    }
  }
  EXPECT_THAT(passport_html(*made, Language::kEnglish), HasSubstr("overdue for calibration"));
  const std::string russian = passport_html(*made, Language::kRussian);
  EXPECT_THAT(russian, HasSubstr("не соответствует"));
  EXPECT_THAT(russian, HasSubstr("Представитель ОТК"));
  EXPECT_THAT(russian, HasSubstr("0,1"));
}

TEST_F(PassportTest, TheDocumentSaysWhereItsNumbersComeFrom) {
  record("SN-7", procedures::RunOutcome::kCompleted);
  const auto made = passport();
  ASSERT_TRUE(made);
  const auto document = passport_json(*made);
  EXPECT_EQ(document["verdict"], "pass");
  const auto& origin = document["origin"][0];
  for (const char* key : {"gyro_serial_number", "operator", "software_version", "procedure_sha256",
                          "bench_sha256", "raw_sha256", "started_at", "ended_at"}) {
    EXPECT_TRUE(origin[key].is_string() && !origin[key].get<std::string>().empty()) << key;
  }
  EXPECT_EQ(origin["raw_data_intact"], true);
  EXPECT_EQ(origin["instruments"][1]["calibration_due"], "2026-02-01");
  EXPECT_EQ(document["tests"].size(), 2U);
}

TEST(PassportTexts, EveryLimitedAndFittedQuantityHasAName) {
  const auto config = tests::source_tree() / "config";
  const auto limits = config::load_limits(config / "limits/acceptance.json");
  ASSERT_TRUE(limits);
  for (const auto& limit : limits->limits) EXPECT_TRUE(has_name(limit.quantity)) << limit.quantity;
  for (const char* name : {"general", "magnetic", "thermal"}) {
    const auto model = config::load_model(config / "models" / (std::string(name) + ".json"));
    ASSERT_TRUE(model);
    for (const auto& term : model->terms) EXPECT_TRUE(has_name(term.effect)) << term.effect;
  }
  EXPECT_EQ(quantity_name("my_term", Language::kRussian), "my_term");
}

TEST(PassportTexts, RussianNumbersHaveAComma) {
  EXPECT_EQ(localised("-0.25", Language::kRussian), "-0,25");
  EXPECT_EQ(localised("-0.25", Language::kEnglish), "-0.25");
}

TEST(SetPoints, SigmaIsPooledAboutEachSetPointsOwnMean) {
  std::vector<Point> points{window(PointKind::kBaseline, "b", 1, 100, 1.0)};
  for (const auto& [target, rate] : {std::pair{31.0, 2.0}, {31.0, 4.0}, {41.0, 9.0}, {41.0, 9.0}}) {
    points.push_back(window(PointKind::kAverage, "p", 1, points.back().time_s + 200, rate));
    points.back().target_c = target;
    points.back().heater_w = 3.0;
  }
  const auto groups = set_points_of(points, nullptr);
  ASSERT_TRUE(groups);
  ASSERT_EQ(groups->size(), 2U);
  EXPECT_DOUBLE_EQ((*groups)[0].deviation_deg_per_h.value, 2.0);
  EXPECT_DOUBLE_EQ((*groups)[1].deviation_deg_per_h.value, 8.0);
  const PooledSigma pooled = pooled_sigma(*groups);
  EXPECT_DOUBLE_EQ(pooled.degrees_of_freedom, 2.0);
  EXPECT_DOUBLE_EQ(pooled.sigma_deg_per_h.value, 1.0);
  EXPECT_DOUBLE_EQ(pooled.sigma_deg_per_h.standard_error, 0.5);
  EXPECT_TRUE(std::isnan(pooled_sigma({}).sigma_deg_per_h.value));
}

TEST(QuietStretch, IsTheLongestInWhichNothingIsDone) {
  std::vector<Point> points;
  const auto add = [&](int count, auto change) {
    for (int i = 0; i < count; ++i) {
      const double time = points.empty() ? 50.0 : points.back().time_s + 100.0;
      points.push_back(window(PointKind::kTransient, "wait", 1, time, 1.0));
      change(points.back());
    }
  };
  add(4, [](Point&) {});
  add(9, [](Point& p) { p.heater_w = 3.0; });
  add(9, [](Point& p) { p.temperature_rate_c_per_h = -1.0; });
  add(5, [](Point&) {});
  add(9, [](Point& p) { p.kind = PointKind::kAverage; });
  const auto stretch = quiet_stretch(points);
  ASSERT_TRUE(stretch);
  EXPECT_DOUBLE_EQ(stretch->from_s, 2200.0);
  EXPECT_DOUBLE_EQ(stretch->to_s, 2700.0);
  points.resize(2);
  EXPECT_FALSE(quiet_stretch(points)) << "200 s make no curve";
}

}  // namespace
}  // namespace fogbench::acceptance
