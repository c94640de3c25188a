// Files as other programs write them (tests/data/dialects/README.md): one small table, read from
// each to the same numbers, or refused in words that say what to do.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "model/table/read_table.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::model {
namespace {

using testing::HasSubstr;

const std::vector<double> kTimes = {0, 60, 120, 180, 240};
const std::vector<double> kRates = {1.25, -0.5, 0.7, 13.8, 2.05};
const std::vector<double> kTemperatures = {21.5, 22.25, 23, 24.75, 25.5};

enum class Holds { kAll, kNoTemperature, kRefused };

struct DialectCase {
  const char* file;
  Holds holds;
  const char* says;  ///< a part of the provenance, or of the error
  std::map<std::string, std::string> columns = {};
  std::map<std::string, std::string> units = {};
  const char* inside = "";
};

const std::vector<DialectCase> kDialectCases = {
    {"excel-english.csv", Holds::kAll,
     "time_s from Time (s) in s; rate_deg_per_h from Gyro (deg/h) in deg/h; temperature_c from "},
    {"excel-german.csv", Holds::kAll, "Latin-1, separated by semicolons, with decimal commas; "},
    {"excel-russian.csv", Holds::kAll,
     "Windows-1251, separated by semicolons, with decimal commas; "},
    {"excel-french.csv", Holds::kAll, "rate_deg_per_h from Vitesse angulaire (°/h)"},
    {"excel-unicode.txt",
     Holds::kAll,
     "UTF-16, separated by tabs, with decimal commas",
     {{"time_s", "Время, с"}, {"rate_deg_per_h", "Гироскоп [град/ч]"}}},
    {"utf16-big-endian.csv", Holds::kAll, "UTF-16"},
    {"excel-german-thousands.csv", Holds::kRefused,
     "found '1.234,5', expected numbers without separators of thousands"},
    {"excel-french-thousands.csv", Holds::kRefused, "expected numbers without separators of"},
    {"excel-ambiguous.csv", Holds::kRefused, "found '2,500': 2.500 or 2500?"},
    {"excel-points-and-commas.csv", Holds::kRefused, "found '1,25' and '2.5', expected decimal"},
    {"excel-missing.csv", Holds::kAll, ""},
    {"excel-quoted-decimals.csv", Holds::kAll, "separated by commas, with decimal commas"},
    {"excel.xlsx", Holds::kRefused, "found a spreadsheet (xlsx, ods)"},
    {"labview.lvm", Holds::kAll, "separated by tabs, 21 lines before the names"},
    {"labview-german.lvm", Holds::kAll, "with decimal commas, 21 lines before the names"},
    {"labview-dates.txt", Holds::kAll, "dates without a time zone, taken as UTC"},
    {"matlab-writetable.csv", Holds::kAll, "rate_deg_per_h from gyro_rad_s in rad/s"},
    {"matlab-struct.mat", Holds::kAll, "MATLAB 5, log; rate_deg_per_h from gyro_deg_s in deg/s"},
    {"matlab-matrix.mat", Holds::kAll, "MATLAB 5, data; rate_deg_per_h from gyro [deg/h]"},
    {"matlab-two-structs.mat", Holds::kRefused,
     "found several tables, expected one of them to be named: FILE#rig1, FILE#rig2"},
    {"matlab-two-structs.mat", Holds::kAll, "MATLAB 5, rig1; ", {}, {}, "rig1"},
    {"matlab-two-structs.mat", Holds::kRefused, "found no rig3 in it", {}, {}, "rig3"},
    {"matlab-level4.mat", Holds::kAll, "MATLAB 4, variables; "},
    {"matlab-7.3.mat", Holds::kAll, "MATLAB 7.3, log; "},
    {"matlab-cut-off.mat", Holds::kRefused, "MATLAB file is damaged"},
    {"octave-v6.mat", Holds::kAll, "MATLAB 5, variables; "},
    {"octave-v7.mat", Holds::kAll, "rate_deg_per_h from omega, whose unit is not stated, as deg/h"},
    {"octave.h5", Holds::kAll, "HDF5, /; "},
    {"octave-csvwrite.csv",
     Holds::kAll,
     "without names: its columns are called 1 to 3",
     {{"time_s", "1"}, {"rate_deg_per_h", "2"}, {"temperature_c", "3"}}},
    {"octave-text.txt",
     Holds::kAll,
     "separated by blanks, without names",
     {{"time_s", "1"}, {"rate_deg_per_h", "2"}, {"temperature_c", "3"}}},
    {"h5py-group.h5", Holds::kAll, "HDF5, /night; rate_deg_per_h from omega in deg/s"},
    {"h5py-two-groups.h5", Holds::kRefused, "FILE#/run1, FILE#/run2"},
    {"h5py-two-groups.h5", Holds::kAll, "HDF5, /run2", {}, {}, "/run2"},
    {"h5py-records.h5", Holds::kAll, "HDF5, /log"},
    {"h5py-matrix.h5", Holds::kAll, "HDF5, /log"},
    {"h5py-cut-off.h5", Holds::kRefused, "HDF5 file is damaged or cut off"},
    {"numpy-savetxt.txt", Holds::kAll, "separated by blanks, names in a comment"},
    {"numpy-savetxt-commas.csv", Holds::kAll, "names in a comment"},
    {"numpy-without-names.txt",
     Holds::kAll,
     "without names: its columns are called 1 to 3",
     {{"time_s", "1"}, {"rate_deg_per_h", "2"}, {"temperature_c", "3"}}},
    {"numpy.npy", Holds::kRefused, "found an array of numpy"},
    {"pandas-index.csv", Holds::kAll, ""},
    {"pandas-dates.csv", Holds::kAll, "dates with their time zone"},
    {"pandas-german.csv", Holds::kAll, "separated by semicolons, with decimal commas"},
    {"pandas.csv.gz", Holds::kAll, "gzip"},
    {"pandas-cut-off.csv.gz", Holds::kRefused, "gzip archive ends too early"},
    {"pandas-damaged.csv.gz", Holds::kRefused, "gzip archive is damaged"},
    {"logger.csv.zst", Holds::kAll, "zstd"},
    {"logger-cut-off.csv.zst", Holds::kRefused, "zstd archive"},
    {"r-write-csv.csv", Holds::kAll, ""},
    {"r-write-csv2.csv", Holds::kAll, "separated by semicolons, with decimal commas"},
    {"r-write-table.txt", Holds::kAll, "separated by blanks, the rows' own names left out"},
    {"gnuplot-data.dat", Holds::kAll, "rate_deg_per_h from omega[deg/h] in deg/h"},
    {"gnuplot-table.dat",
     Holds::kNoTemperature,
     "names in a comment",
     {{"time_s", "x"}, {"rate_deg_per_h", "y"}}},
    {"ros-imu.csv", Holds::kAll, "Unix stamps in ns", {}, {{"field.angular_velocity.z", "rad/s"}}},
    {"ros-imu-three-axes.csv", Holds::kRefused,
     "--column rate_deg_per_h=field.angular_velocity.x, --column "
     "rate_deg_per_h=field.angular_velocity.y"},
    {"grafana.csv", Holds::kAll, "dates with their time zone"},
    {"grafana-unix.csv", Holds::kAll, "Unix stamps in ms"},
    {"influx.csv", Holds::kAll, "time_s from _time"},
    {"tektronix.csv",
     Holds::kAll,
     "10 lines before the names",
     {{"rate_deg_per_h", "CH1"}, {"temperature_c", "CH2"}}},
    {"keysight.csv", Holds::kRefused, "column Volt: found twice"},
    {"keysight-one-channel.csv",
     Holds::kNoTemperature,
     "1 line before the names",
     {{"time_s", "second"}, {"rate_deg_per_h", "Volt"}}},
    {"lecroy.csv", Holds::kNoTemperature, "3 lines before the names", {{"rate_deg_per_h", "Ampl"}}},
    {"origin-units-row.txt", Holds::kAll,
     "units in the row below the names; time_s from Time in ms"},
    {"bars.txt", Holds::kAll, "separated by bars"},
    {"psql.txt", Holds::kRefused, "found 1 fields, expected 3"},
    {"blanks.txt", Holds::kAll, "time_s from time [h] in h"},
    {"counter-that-wraps.csv", Holds::kAll, "the counter of 32 bits wrapped once"},
    {"past-midnight.csv", Holds::kAll, "times of day, midnight passed once"},
    {"american-dates.csv", Holds::kAll, "dates with the month first"},
    {"dates-that-may-be-two.csv", Holds::kRefused, "day 3 of month 4, or day 4 of month 3?"},
    {"commas-for-everything.csv", Holds::kRefused, "found 4 fields, expected 2"},
    {"two-whole-columns.txt", Holds::kRefused, "two columns, or 0.5?"},
    {"unknown-unit.csv",
     Holds::kRefused,
     "found the unit \"furlong/fortnight\", expected one of deg/h",
     {{"rate_deg_per_h", "gyro [furlong/fortnight]"}}},
    {"wrong-kind-of-unit.csv",
     Holds::kRefused,
     "column gyro: is in K, expected a rotation rate",
     {{"rate_deg_per_h", "gyro"}},
     {{"gyro", "K"}}},
    {"fields.csv", Holds::kAll, "field_y_ut from By (A/m) in A/m (in vacuum)"},
    {"two-thermometers.csv", Holds::kAll, "temperature_c from T1", {{"temperature_c", "T1"}}},
    {"comments-and-empty-lines.csv", Holds::kAll, ""},
    {"trailing-separators.csv", Holds::kAll, "separated by semicolons"},
    {"photograph.jpg", Holds::kRefused, "is this a text file?"},
    {"octave-text-vectors.txt", Holds::kRefused, "found only 1, expected it"},
};

std::filesystem::path dialects() {
  return tests::source_tree() / "tests" / "data" / "dialects";
}

void expect_column(const Table& table, const char* name, const std::vector<double>& expected,
                   double first) {
  ASSERT_TRUE(table.has(name)) << table.why_missing(name);
  std::vector<double> found;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!std::isnan(table.column("rate_deg_per_h")[row])) found.push_back(table.column(name)[row]);
  }
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(found[i] - first, expected[i], 2e-5 * (1.0 + std::abs(expected[i]))) << name;
  }
}

TEST(Dialects, EachFileIsReadToTheSameNumbersOrRefusedInTheRightWords) {
  for (const DialectCase& one : kDialectCases) {
    SCOPED_TRACE(one.file);
    const auto table =
        read_table(dialects() / one.file, {.columns = one.columns, .units = one.units}, one.inside);
    if (one.holds == Holds::kRefused) {
      std::string said;
      if (!table) {
        EXPECT_EQ(table.error().code, ErrorCode::kBadInput);
        said = table.error().message;
        EXPECT_THAT(said, HasSubstr(one.file));
      } else if (!table->has("rate_deg_per_h")) {
        said = table->why_missing("rate_deg_per_h");
      }
      EXPECT_THAT(said, HasSubstr(one.says));
      EXPECT_EQ(said.find('\n'), std::string::npos);
      continue;
    }
    if (!table) {
      ADD_FAILURE() << table.error().message;
      continue;
    }
    std::string says;
    for (const std::string& line : table->provenance()) says += line;
    EXPECT_THAT(says, HasSubstr(one.says));
    ASSERT_TRUE(table->has("time_s")) << says;
    ASSERT_TRUE(table->has("rate_deg_per_h")) << says;
    expect_column(*table, "time_s", kTimes, table->column("time_s")[0]);
    expect_column(*table, "rate_deg_per_h", kRates, 0.0);
    if (one.holds == Holds::kAll) expect_column(*table, "temperature_c", kTemperatures, 0.0);
  }
}

TEST(Dialects, EveryFileIsInTheTable) {
  std::set<std::string> known{"README.md"};
  for (const DialectCase& one : kDialectCases) known.insert(one.file);
  EXPECT_GE(known.size(), 41U);
  for (const auto& entry : std::filesystem::directory_iterator(dialects())) {
    EXPECT_EQ(known.count(entry.path().filename().string()), 1U) << entry.path();
  }
}

TEST(Dialects, AFieldStrengthIsTakenForItsFluxDensityInVacuum) {
  const auto table = read_table(dialects() / "fields.csv");
  ASSERT_TRUE(table) << table.error().message;
  for (const char* const name : {"field_x_ut", "field_y_ut", "field_z_ut"}) {
    EXPECT_NEAR(table->column(name)[0], name[6] == 'y' ? 100.0 : 50.0, 1e-6) << name;
  }
}

TEST(Dialects, SeveralCandidatesAreLeftToThePersonWhoKnows) {
  const auto table = read_table(dialects() / "two-thermometers.csv");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_FALSE(table->has("temperature_c"));
  EXPECT_THAT(table->why_missing("temperature_c"),
              HasSubstr("expected one of --column temperature_c=T1, --column temperature_c=T2"));
  EXPECT_TRUE(table->has("T1"));
}

TEST(Dialects, ANameThatTheModelAsksForIsTakenForNothingElse) {
  const auto table = read_table(dialects() / "pandas-index.csv", {.kept = {"rate_deg_per_h"}});
  ASSERT_TRUE(table);
  const auto kept = read_table(dialects() / "matlab-writetable.csv", {.kept = {"gyro_rad_s"}});
  ASSERT_TRUE(kept);
  EXPECT_TRUE(kept->has("gyro_rad_s"));
  EXPECT_FALSE(kept->has("rate_deg_per_h"));
}

}  // namespace
}  // namespace fogbench::model
