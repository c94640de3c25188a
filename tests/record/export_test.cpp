#include "record/export.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "record/run_log.hpp"
#include "record/store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::record {
namespace {

class ExportTest : public testing::Test {
 protected:
  ExportTest() {
    auto log = RunLog::open(folder_ / "store.db");
    EXPECT_TRUE(log);
    log_ = std::move(*log);
    procedures::RunHeader header;
    header.frame_rate_hz = 1000.0;
    header.reference_rate_deg_per_h = 12.0;
    EXPECT_TRUE(log_->begin_run(header, {}));
  }

  void point(const std::string& segment, int block = 0) {
    procedures::Point point;
    point.segment = segment;
    point.block = block;
    point.rate_deg_per_h = 0.1 + 0.2;
    point.field_set_ut = std::numeric_limits<double>::quiet_NaN();
    ASSERT_TRUE(log_->point(point));
  }

  std::string exported(bool raw = false) {
    auto reader = RunLogReader::open(folder_ / "store.db");
    auto out = config::OutputFile::open(folder_ / "out.csv");
    EXPECT_TRUE(reader && out);
    const Status written = raw ? write_gyro(**reader, *(*reader)->run(1), **out)
                               : write_points(*valid_points(**reader, 1, true), **out);
    EXPECT_TRUE(written);
    EXPECT_TRUE((*out)->commit());
    return support::read_text(folder_ / "out.csv");
  }

  support::TemporaryFolder folder_;
  std::unique_ptr<RunLog> log_;
};

TEST_F(ExportTest, NumbersReadBackTheSameAndMissingOnesAreEmpty) {
  point("a,b");
  const std::string text = exported();
  EXPECT_EQ(text.substr(0, text.find(",rate_std_deg")),
            "test,segment,kind,time_s,duration_s,rate_deg_per_h");
  EXPECT_NE(text.find("\n1,\"a,b\",average,0,0,0.30000000000000004,0"), std::string::npos);
  EXPECT_NE(text.find(",0,,0,0,0,0,0,0\n"), std::string::npos);  // field_set_ut is missing
}

TEST_F(ExportTest, AuxiliaryChannelsStandBehindTheBenchsOwn) {
  procedures::RunHeader header;
  header.auxiliary = {{"pressure_hpa", "air pressure"}};
  ASSERT_TRUE(log_->end_run({}));
  ASSERT_TRUE(log_->begin_run(header, {}));
  for (const double pressure : {1013.5, std::numeric_limits<double>::quiet_NaN()}) {
    procedures::Point point;
    point.auxiliary["pressure_hpa"] = pressure;
    ASSERT_TRUE(log_->point(point));
  }
  auto reader = RunLogReader::open(folder_ / "store.db");
  auto out = config::OutputFile::open(folder_ / "out.csv");
  ASSERT_TRUE(reader && out);
  ASSERT_TRUE(write_points(*valid_points(**reader, 2, true), **out));
  ASSERT_TRUE((*out)->commit());
  const std::string text = support::read_text(folder_ / "out.csv");
  EXPECT_NE(text.find(",frames,frames_dropped,pressure_hpa\n"), std::string::npos) << text;
  EXPECT_NE(text.find(",0,0,1013.5\n"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with(",0,0,\n")) << text;
}

TEST_F(ExportTest, VoidPointsAreLeftOut) {
  point("first", 1);
  ASSERT_TRUE(log_->void_block(1, 0.0, "paused"));
  point("second", 1);
  const std::string text = exported();
  EXPECT_EQ(text.find("first"), std::string::npos);
  EXPECT_NE(text.find("second"), std::string::npos);
}

TEST_F(ExportTest, AnInterruptedRunIsTakenOnlyOnRequest) {
  point("a");
  auto reader = RunLogReader::open(folder_ / "store.db");
  ASSERT_TRUE(reader);
  const auto refused = valid_points(**reader, 1, false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
  EXPECT_NE(refused.error().message.find("under way"), std::string::npos);
  EXPECT_TRUE(valid_points(**reader, 1, true));
  log_.reset();
  const auto still = valid_points(**reader, 1, false);
  ASSERT_FALSE(still);
  EXPECT_NE(still.error().message.find("interrupted"), std::string::npos);
}

TEST_F(ExportTest, ACompletedRunIsTaken) {
  point("a");
  ASSERT_TRUE(log_->end_run({}));
  auto reader = RunLogReader::open(folder_ / "store.db");
  ASSERT_TRUE(reader);
  EXPECT_TRUE(valid_points(**reader, 1, false));
}

TEST_F(ExportTest, ARunWithoutPointsIsBadInput) {
  auto reader = RunLogReader::open(folder_ / "store.db");
  ASSERT_TRUE(reader);
  const auto refused = valid_points(**reader, 1, true);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("no points"), std::string::npos);
}

TEST_F(ExportTest, TheRawStreamHasATimeAndTheReferenceTakenOff) {
  drivers::GyroBlock block;
  block.index = {0, 1, 3};
  block.rate_deg_per_h = {12.5F, 11.5F, std::numeric_limits<float>::quiet_NaN()};
  block.temperature_c = {21.0F, 21.0F, 22.0F};
  ASSERT_TRUE(log_->gyro_samples(block));
  ASSERT_TRUE(log_->end_run({}));
  EXPECT_EQ(exported(true),
            "time_s,rate_deg_per_h,temperature_c\n"
            "0.000000,0.5,21\n0.001000,-0.5,21\n0.003000,,22\n");
}

}  // namespace
}  // namespace fogbench::record
