// Files of other programs through the real executable: what was understood is said once, the same
// numbers give the same verdict, and what cannot be read is one line and leaves nothing behind.

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

class ForeignTablesTest : public FogbenchTest {
 protected:
  static std::string dialect(const std::string& name) {
    return (tests::source_tree() / "tests" / "data" / "dialects" / name).string();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
};

std::vector<std::string> split_at(const std::string& line, char separator) {
  std::vector<std::string> fields;
  std::istringstream in(line + separator);
  for (std::string field; std::getline(in, field, separator);) fields.push_back(field);
  return fields;
}

/// What a German spreadsheet makes of a table: rates in deg/s, temperatures in K.
std::string as_in_a_german_spreadsheet(const std::string& file) {
  const std::map<std::string, std::string> names = {{"rate_deg_per_h", "Drehrate [°/s]"},
                                                    {"temperature_c", "Temperatur [K]"},
                                                    {"time_s", "Zeit [s]"}};
  std::ifstream in(file);
  std::string line, out;
  std::getline(in, line);
  const std::vector<std::string> columns = split_at(line, ',');
  for (const std::string& column : columns) {
    const auto german = names.find(column);
    out += (out.empty() ? "" : ";") + (german == names.end() ? column : german->second);
  }
  while (std::getline(in, line)) {
    out += "\n";
    const std::vector<std::string> fields = split_at(line, ',');
    for (std::size_t i = 0; i < fields.size(); ++i) {
      std::string field = fields[i];
      if (!field.empty() && columns[i] == "rate_deg_per_h") {
        field = fmt::format("{}", std::stod(field) / 3600.0);
      } else if (!field.empty() && columns[i] == "temperature_c") {
        field = fmt::format("{}", std::stod(field) + 273.15);
      }
      const bool is_text = columns[i] == "run" || columns[i] == "segment";
      if (!is_text) std::replace(field.begin(), field.end(), '.', ',');
      out += (i > 0 ? ";" : "") + field;
    }
  }
  return out + "\n";
}

TEST_F(ForeignTablesTest, AChallengeInAnotherDialectAndUnitGetsTheSameVerdict) {
  ASSERT_EQ(fogbench({"challenge", "--seed", "23", "-o", path("sealed")}).status, 0);
  const std::string model = path("sealed/model.json");
  const auto original =
      json({"diagnose", path("sealed/measurements.csv"), "--model", model, "--json"});
  const std::string german =
      folder_.file("messung.csv", as_in_a_german_spreadsheet(path("sealed/measurements.csv")))
          .string();
  const Finished done = fogbench({"diagnose", german, "--model", model, "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(done.err.find("messung.csv: read as separated by semicolons, with decimal commas; "),
            std::string::npos)
      << done.err;
  EXPECT_NE(done.err.find("rate_deg_per_h from Drehrate [°/s] in deg/s"), std::string::npos);
  EXPECT_NE(done.err.find("temperature_c from Temperatur [K] in K"), std::string::npos);
  const auto foreign = nlohmann::json::parse(done.out);
  EXPECT_EQ(foreign.at("verdict"), original.at("verdict"));
  EXPECT_EQ(foreign.at("ambiguous"), original.at("ambiguous"));
  ASSERT_EQ(foreign.at("missing").size(), original.at("missing").size());
  EXPECT_GT(foreign.at("missing").size(), 0U);
  for (std::size_t i = 0; i < original.at("missing").size(); ++i) {
    const auto &a = original.at("missing")[i], &b = foreign.at("missing")[i];
    EXPECT_EQ(b.at("effect"), a.at("effect"));
    for (const auto& [name, value] : a.at("coefficients").items()) {
      EXPECT_NEAR(b.at("coefficients").at(name).get<double>(), value.get<double>(), 1e-6) << name;
    }
  }
  EXPECT_EQ(original.at("read_as"), nlohmann::json::array());
  EXPECT_EQ(foreign.at("read_as").size(), 1U);
}

TEST_F(ForeignTablesTest, InspectSaysWhatItWouldUnderstand) {
  const Finished text = fogbench({"inspect", dialect("excel-russian.csv")});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_NE(text.out.find("5 rows, 3 columns"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("a row each 60 s"), std::string::npos) << text.out;
  const auto found = json({"inspect", dialect("matlab-two-structs.mat") + "#rig2", "--json"});
  EXPECT_EQ(found.at("rows"), 5);
  EXPECT_EQ(found.at("time").at("usual_step_s"), 60.0);
  EXPECT_EQ(found.at("columns").size(), 3U);
  EXPECT_EQ(found.at("columns")[0].at("name"), "rate_deg_per_h");
  EXPECT_EQ(found.at("columns")[0].at("unit"), "deg/h");
  EXPECT_EQ(found.at("columns")[0].at("most"), 27.6);
}

TEST_F(ForeignTablesTest, ImportJoinsAveragesAndReadsBackPlain) {
  std::string gyro = "t [ms];omega [deg/s]\n", thermometer = "time_s,temp (K)\n";
  for (int i = 0; i < 1200; ++i) gyro += fmt::format("{};0,00{}\n", 100 * i, 1 + i % 3);
  for (int i = 0; i < 13; ++i) thermometer += fmt::format("{}.02,{}\n", 10 * i, 294.15 + i);
  const std::string a = folder_.file("gyro.txt", gyro).string();
  const std::string b = folder_.file("thermometer.csv", thermometer).string();
  const std::string table = path("table.csv");
  const Finished done =
      fogbench({"import", a, b, "-o", table, "--tolerance", "6", "s", "--average", "60", "s"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(done.out.find("temperature_c joined to 1200 of 1200 rows, within 6 s"),
            std::string::npos)
      << done.out;
  const Finished back = fogbench({"inspect", table, "--json"});
  EXPECT_EQ(back.err, "") << "a clean table has nothing to be said of it";
  const auto found = nlohmann::json::parse(back.out);
  EXPECT_EQ(found.at("rows"), 2);
  std::vector<std::string> names;
  for (const auto& column : found.at("columns")) names.push_back(column.at("name"));
  EXPECT_EQ(names,
            (std::vector<std::string>{"duration_s", "rate_deg_per_h", "rate_std_error_deg_per_h",
                                      "temperature_c", "time_s"}));
  EXPECT_NEAR(found.at("columns")[1].at("mean").get<double>(), 7.2, 1e-9);
}

TEST_F(ForeignTablesTest, WhatIsDoubtfulIsSaidWithItsCause) {
  const std::string file =
      folder_.file("kelvin.csv", "time_s,rate_deg_per_h,temp\n0,1,294\n1,2,300\n2,1,310\n")
          .string();
  const Finished done = fogbench({"inspect", file});
  EXPECT_EQ(done.status, 0);
  EXPECT_NE(
      done.err.find("warning: temperature_c goes from 294 to 310 degC: probably numbers in K"),
      std::string::npos)
      << done.err;
}

TEST_F(ForeignTablesTest, WhatCannotBeReadIsOneLineAndNothingIsWritten) {
  const std::string table = path("table.csv");
  std::string wide = "c0";
  for (int i = 1; i < 100'000; ++i) wide += fmt::format(",c{}", i);
  const std::string many = folder_.file("wide.csv", wide + "\n").string();
  const std::string line = folder_.file("line.csv", "rate_deg_per_h\n1\n").string();
  std::filesystem::resize_file(line, std::uintmax_t{2} << 30);  // sparse: a line of 2 GB
  for (const auto& [file, says] : std::vector<std::pair<std::string, std::string>>{
           {dialect("pandas-cut-off.csv.gz"), "gzip archive ends too early"},
           {dialect("pandas-damaged.csv.gz"), "gzip archive is damaged"},
           {dialect("logger-cut-off.csv.zst"), "zstd archive"},
           {dialect("matlab-cut-off.mat"), "it was cut off"},
           {dialect("h5py-cut-off.h5"), "damaged or cut off"},
           {dialect("excel-ambiguous.csv"), "2.500 or 2500?"},
           {many, "found 100000 columns, expected at most 4096"},
           {line, "found a line longer than 1 MiB"}}) {
    expect_refused(fogbench({"import", file, "-o", table}), 3, says);
    expect_refused(fogbench({"inspect", file, "--json"}), 3, says);
    EXPECT_FALSE(std::filesystem::exists(table)) << file;
  }
  expect_refused(fogbench({"import", dialect("bars.txt"), "-o", table, "--average", "red"}), 2,
                 "--average red: a length of time was expected");
  expect_refused(fogbench({"inspect", dialect("bars.txt"), "--unit", "temperature_c=parsec"}), 2,
                 "found the unit \"parsec\"");
}

}  // namespace
}  // namespace fogbench::system_tests
