#include "cli/load_table.hpp"

#include <gtest/gtest.h>

#include "cli/common_options.hpp"
#include "record/run_log.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::cli {
namespace {

class LoadTableTest : public testing::Test {
 protected:
  LoadTableTest() : store_((folder_ / "store.db").string()) {
    auto log = record::RunLog::open(store_);
    EXPECT_TRUE(log);
    for (const bool completed : {true, false}) {
      EXPECT_TRUE((*log)->begin_run({}, {}));
      for (const char* segment : {"coil_x/up", "coil_x/down", "coil_z/up"}) {
        procedures::Point point;
        point.segment = segment;
        point.test = 2;
        point.rate_deg_per_h = 0.5;
        EXPECT_TRUE((*log)->point(point));
      }
      if (completed) {
        EXPECT_TRUE((*log)->end_run({}));
      }
    }
  }

  void expect_refused(const DataOptions& options, ErrorCode code, const std::string& says) const {
    const auto table = load_table(options);
    ASSERT_FALSE(table);
    EXPECT_EQ(table.error().code, code);
    EXPECT_NE(table.error().message.find(says), std::string::npos) << table.error().message;
  }

  support::TemporaryFolder folder_;
  std::string store_;
};

TEST_F(LoadTableTest, TakesARunByNumberAndByStore) {
  for (const auto& options :
       {DataOptions{.data = {"1"}, .store = store_}, DataOptions{.data = {store_ + "#1"}}}) {
    const auto table = load_table(options);
    ASSERT_TRUE(table) << table.error().message;
    EXPECT_EQ(table->rows(), 3U);
    EXPECT_EQ(table->column("rate_deg_per_h")[0], 0.5);
    EXPECT_EQ(table->segment().at(2), "coil_z/up");
    EXPECT_EQ(table->run().at(0), "2");
  }
}

TEST_F(LoadTableTest, TakesOneTestOfARun) {
  for (const auto& options :
       {DataOptions{.data = {"1/2"}, .store = store_}, DataOptions{.data = {store_ + "#1/2"}},
        DataOptions{.data = {"1"}, .store = store_, .tests = {"2"}}}) {
    const auto table = load_table(options);
    ASSERT_TRUE(table) << table.error().message;
    EXPECT_EQ(table->rows(), 3U);
    EXPECT_EQ(table->run_word(), "test");
  }
  expect_refused({.data = {"1/1"}, .store = store_}, ErrorCode::kBadInput,
                 "has no test 1, expected one of 2");
  expect_refused({.data = {"1"}, .store = store_, .tests = {"3"}}, ErrorCode::kBadInput,
                 "has no test 3");
  EXPECT_EQ(data_name({.data = {"1/2"}, .store = store_}), "test 2 of run 1");
}

TEST_F(LoadTableTest, NeverTakesTwoGyrosForOneUnasked) {
  auto log = record::RunLog::open(store_);
  ASSERT_TRUE(log);
  for (const char* gyro : {"FOG-1", "FOG-1", "FOG-2"}) {
    procedures::RunHeader header;
    header.gyro_serial_number = gyro;
    ASSERT_TRUE((*log)->begin_run(header, {}));
    procedures::Point point;
    point.rate_deg_per_h = 0.5;
    ASSERT_TRUE((*log)->point(point));
    ASSERT_TRUE((*log)->end_run({}));
  }
  EXPECT_TRUE(load_table({.data = {"3", "4"}, .store = store_}));
  EXPECT_TRUE(load_table({.data = {"1", "3"}, .store = store_})) << "run 1 does not say its gyro";
  expect_refused({.data = {"3", "4", "5"}, .store = store_}, ErrorCode::kBadInput,
                 "run 3 is of gyro FOG-1 and run 5 of gyro FOG-2; fogbench compare 3 5");
  EXPECT_TRUE(load_table({.data = {"3", "5"}, .store = store_, .several_gyros = true}));
}

TEST_F(LoadTableTest, KeepsOnlyTheSegmentsThatMatch) {
  const auto table = load_table({.data = {"1"}, .segment = "coil_x/*", .store = store_});
  ASSERT_TRUE(table);
  EXPECT_EQ(table->rows(), 2U);
  expect_refused({.data = {"1"}, .segment = "coil_y/*", .store = store_}, ErrorCode::kBadInput,
                 "the segments are coil_x/up");
}

TEST_F(LoadTableTest, ARenamedColumnIsTakenToTheUnitOfItsNewName) {
  const std::string csv = folder_
                              .file("units.csv",
                                    "omega_deg_s,gyro [rad/s],T (K),B_nT,t_min,plain\n"
                                    "0.001,1e-6,300.15,48000,2,0.5\n")
                              .string();
  const auto value = [&](const std::string& column, const std::vector<std::string>& units = {}) {
    const auto table = load_table({.data = {csv}, .columns = {column}, .units = units});
    EXPECT_TRUE(table) << table.error().message;
    return table ? table->column(column.substr(0, column.find('=')))[0] : 0.0;
  };
  EXPECT_NEAR(value("rate_deg_per_h=omega_deg_s"), 3.6, 1e-12);
  EXPECT_NEAR(value("rate_deg_per_h=gyro [rad/s]"), 0.206264806, 1e-8);
  EXPECT_NEAR(value("temperature_c=T (K)"), 27.0, 1e-9);
  EXPECT_NEAR(value("field_x_ut=B_nT"), 48.0, 1e-12);
  EXPECT_NEAR(value("time_s=t_min"), 120.0, 1e-12);
  EXPECT_EQ(value("rate_deg_per_h=plain"), 0.5) << "nobody knows its unit";
  EXPECT_NEAR(value("rate_deg_per_h=plain", {"plain=deg/s"}), 1800.0, 1e-9);
  const auto in_place = load_table({.data = {csv}, .units = {"plain=mA"}});
  ASSERT_TRUE(in_place) << in_place.error().message;
  EXPECT_EQ(in_place->column("plain")[0], 0.5) << "its name ends in no unit to take it to";
}

TEST_F(LoadTableTest, RefusesAUnitOfAnotherKindAndOneThatNobodyKnows) {
  const std::string csv =
      folder_.file("units.csv", "gyro [K],odd [furlong],gyro_a\n1,2,3\n").string();
  expect_refused({.data = {csv}, .columns = {"rate_deg_per_h=gyro [K]"}}, ErrorCode::kBadInput,
                 "column gyro [K]: is in K, expected a rotation rate in deg/h");
  expect_refused({.data = {csv}, .columns = {"rate_deg_per_h=odd [furlong]"}}, ErrorCode::kBadInput,
                 "found the unit \"furlong\", expected one of");
  expect_refused({.data = {csv}, .units = {"gyro_a=parsec"}}, ErrorCode::kUsage,
                 "--unit gyro_a: found the unit \"parsec\"");
  expect_refused({.data = {csv}, .units = {"nobody=K"}}, ErrorCode::kBadInput, "--unit nobody: ");
  EXPECT_TRUE(load_table({.data = {csv}, .columns = {"rate_deg_per_h=gyro_a"}}))
      << "the a may be anything";
}

TEST_F(LoadTableTest, RenamesColumnsOfCsvAndOfRuns) {
  const std::string csv = folder_.file("a.csv", "omega,run\n1.5,1\n2.5,1\n").string();
  const auto table = load_table({.data = {csv}, .columns = {"rate_deg_per_h=omega"}});
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->column("rate_deg_per_h")[1], 2.5);
  const auto run =
      load_table({.data = {"1"}, .columns = {"temperature_c=target_c"}, .store = store_});
  ASSERT_TRUE(run);
  expect_refused({.data = {"1"}, .columns = {"temperature_c=wings"}, .store = store_},
                 ErrorCode::kBadInput, "column wings: not found");
  expect_refused({.data = {"1"}, .columns = {"omega"}, .store = store_}, ErrorCode::kUsage,
                 "wanted=name");
}

TEST_F(LoadTableTest, SeveralTablesKeepTheirRunsApart) {
  const std::string csv = folder_.file("a.csv", "rate_deg_per_h,run\n1.5,2\n").string();
  const auto table = load_table({.data = {"1", csv}, .store = store_});
  ASSERT_TRUE(table);
  EXPECT_EQ(table->rows(), 4U);
  EXPECT_NE(table->run().at(0), table->run().at(3));
}

TEST_F(LoadTableTest, AnInterruptedRunOnlyOnRequest) {
  expect_refused({.data = {"2"}, .store = store_}, ErrorCode::kBadInput, "--unfinished");
  EXPECT_TRUE(load_table({.data = {"2"}, .store = store_, .unfinished = true}));
}

TEST_F(LoadTableTest, SaysWhatIsNotThere) {
  expect_refused({.data = {"9"}, .store = store_}, ErrorCode::kBadInput, "no run 9");
  expect_refused({.data = {"missing.csv"}}, ErrorCode::kBadInput, "missing.csv");
  expect_refused({.data = {"missing.db#1"}}, ErrorCode::kBadInput, "missing.db");
}

TEST(Parameters, AreNumbersAndListsOfNumbers) {
  const auto parameters = parse_parameters({"a=1.5", "b=1,-2e3,3", "c= 0, 50 ,100 "});
  ASSERT_TRUE(parameters);
  EXPECT_EQ(std::get<std::vector<double>>(parameters->at("c")),
            (std::vector<double>{0.0, 50.0, 100.0}));
  EXPECT_EQ(std::get<double>(parameters->at("a")), 1.5);
  EXPECT_EQ(std::get<std::vector<double>>(parameters->at("b")),
            (std::vector<double>{1.0, -2000.0, 3.0}));
  for (const char* wrong : {"a", "=1", "a=", "a=x", "a=1,", "a=inf", "a=1 2"}) {
    const auto refused = parse_parameters({wrong});
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  }
}

}  // namespace
}  // namespace fogbench::cli
