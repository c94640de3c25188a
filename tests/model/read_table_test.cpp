#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <clocale>
#include <cmath>
#include <fstream>

#include "model/table/read_table.hpp"
#include "model/table/write_csv.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::model {
namespace {

using support::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

class ReadTable : public testing::Test {
 protected:
  Result<Table> read(const std::string& text,
                     const std::map<std::string, std::string>& renames = {},
                     std::size_t most_rows = kEveryRow) {
    const std::filesystem::path file = folder_ / "data.csv";
    std::ofstream(file, std::ios::binary) << text;
    return read_table(file, {.columns = renames, .most_rows = most_rows});
  }
  /// The error's text after the file's name.
  std::string error(const std::string& text,
                    const std::map<std::string, std::string>& renames = {}) {
    const auto table = read(text, renames);
    if (table) return "no error";
    EXPECT_EQ(table.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(table.error().message.find('\n'), std::string::npos);
    const std::string name = (folder_ / "data.csv").string();
    EXPECT_EQ(table.error().message.substr(0, name.size()), name);
    return table.error().message.substr(name.size());
  }

  TemporaryFolder folder_;
};

std::vector<double> values(const Table& table, const std::string& name) {
  const auto column = table.column(name);
  return {column.begin(), column.end()};
}

TEST_F(ReadTable, ReadsNumbersTextsAndMissingValues) {
  const auto table = read(
      "\xEF\xBB\xBFrun, segment ,time_s,rate_deg_per_h,other\r\n"
      "1,\"coil_z/down, \"\"slow\"\"\",10,-1.5e-3,7\r\n"
      "1,coil_z/up, +20 ,,8\r\n"
      "\r\n"
      "2,coil_z/up,nan,NaN,\"9\"");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->rows(), 3u);
  EXPECT_THAT(values(*table, "other"), ElementsAre(7, 8, 9));
  EXPECT_EQ(table->column("time_s")[1], 20.0);
  EXPECT_EQ(table->column("rate_deg_per_h")[0], -1.5e-3);
  EXPECT_TRUE(std::isnan(table->column("rate_deg_per_h")[1]));
  EXPECT_TRUE(std::isnan(table->column("time_s")[2]));
  EXPECT_EQ(table->segment().at(0), "coil_z/down, \"slow\"");
  EXPECT_EQ(table->run().at(2), "2");
  EXPECT_EQ(table->segment().values.size(), 2u);
}

TEST_F(ReadTable, TakesTheDialectsOfSpreadsheets) {
  const std::vector<std::pair<std::string, std::string>> dialects = {
      {"time_s;rate_deg_per_h;segment\n0;1,25;a\n60;-0,5;\"b;c\"\n120;-;a,b\n",
       "separated by semicolons, with decimal commas"},
      {"time_s\trate_deg_per_h\tsegment\n0\t1.25\ta\n60\t-0.5\tb;c\n120\t#N/A\ta,b\n",
       "separated by tabs"},
      {"time_s|rate_deg_per_h|segment\r\n0|1.25|a\r\n60|-5e-1|b;c\r\n120||a,b\r\n",
       "separated by bars"},
      {"  time_s   rate_deg_per_h segment\n 0  1.25\ta\n  60 -0.5 b;c\n 120   NaN  a,b\n",
       "separated by blanks"},
      {"% from a bench\n// at night\ntime_s,rate_deg_per_h,segment\n0,1.25,a\n# a "
       "pause\n60,-0.5,b;c\n"
       "120,NA,\"a,b\"\n",
       ""}};
  for (const auto& [text, says] : dialects) {
    const auto table = read(text);
    ASSERT_TRUE(table) << table.error().message;
    EXPECT_EQ(table->provenance(), says.empty() ? std::vector<std::string>() : std::vector{says});
    EXPECT_THAT(values(*table, "time_s"), ElementsAre(0, 60, 120)) << text;
    ASSERT_EQ(table->rows(), 3U);
    EXPECT_EQ(table->column("rate_deg_per_h")[0], 1.25) << text;
    EXPECT_EQ(table->column("rate_deg_per_h")[1], -0.5) << text;
    EXPECT_TRUE(std::isnan(table->column("rate_deg_per_h")[2])) << text;
    EXPECT_EQ(table->segment().at(1), "b;c") << text;
    EXPECT_EQ(table->segment().at(2), "a,b") << text;
  }
}

TEST_F(ReadTable, GuessesNoNumber) {
  EXPECT_THAT(error("time_s;rate_deg_per_h\n0;1,234\n1;2,500\n"),
              HasSubstr("found '2,500': 2.500 or 2500?"));
  EXPECT_TRUE(read("time_s;rate_deg_per_h\n0;1,234\n1;2,5\n")) << "the second says it";
  EXPECT_TRUE(read("time_s;rate_deg_per_h\n0;0,234\n"));
  EXPECT_THAT(error("time_s;rate_deg_per_h\n0;1.234,5\n"),
              HasSubstr("found '1.234,5', expected numbers without separators of thousands"));
  EXPECT_THAT(error("time_s;rate_deg_per_h\n0;1,2\n1;1.5\n"),
              HasSubstr("found '1,2' and '1.5', expected decimal commas or decimal points"));
  std::string late = "time_s;rate_deg_per_h\n";
  for (int i = 0; i < 9000; ++i) late += std::to_string(i) + ";1.5\n";
  EXPECT_THAT(error(late + "9000;1,5\n"), HasSubstr(":9002: column rate_deg_per_h: found '1,5'"));
}

TEST_F(ReadTable, EveryNumberIsCorrectlyRounded) {
  const char* const numbers[] = {"0.1",
                                 "-0",
                                 "5.",
                                 ".5",
                                 "-.25",
                                 "123456789.123456",
                                 "0.000000000000001",
                                 "999999999999999",
                                 "1234567890.1234567",
                                 "9007199254740993",
                                 "18446744073709551617",
                                 "1e5",
                                 "-2.5E-3",
                                 "4.9e-324",
                                 "00012.500",
                                 "0.3000000000000000444089209850062616169452667236328125"};
  for (const char* number : numbers) {
    const auto table = read(std::string("x,y\n") + number + "," + number + "\n");
    ASSERT_TRUE(table) << table.error().message;
    EXPECT_EQ(table->column("x")[0], std::strtod(number, nullptr)) << number;
    EXPECT_EQ(table->column("y")[0], std::strtod(number, nullptr)) << number;
  }
  for (const char* text : {".", "-.", "1.2.3", "--1", "+-1", "1-"}) {
    EXPECT_THAT(error(std::string("rate_deg_per_h\n") + text + "\n"), HasSubstr(text));
  }
}

TEST_F(ReadTable, SkipsCommentLinesBeforeTheNames) {
  const auto table = read("# source: a paper\nrate_deg_per_h\n1\n2\n");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_THAT(values(*table, "rate_deg_per_h"), ElementsAre(1, 2));
  EXPECT_EQ(table->run().at(1), "1");
  EXPECT_EQ(table->segment().at(1), "");
}

TEST_F(ReadTable, DecimalPointIsADotWhateverTheLocale) {
  for (const char* name : {"de_DE.UTF-8", "ru_RU.UTF-8", "C.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) == nullptr) continue;
    const auto table = read("rate_deg_per_h\n0.25\n");
    std::setlocale(LC_ALL, "C");
    ASSERT_TRUE(table);
    EXPECT_EQ(table->column("rate_deg_per_h")[0], 0.25) << name;
  }
}

TEST_F(ReadTable, RenamesColumnsAndDropsTheOneInTheWay) {
  const auto table = read("omega,rate_deg_per_h\n1,2\n", {{"rate_deg_per_h", "omega"}});
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_THAT(table->column_names(), ElementsAre("rate_deg_per_h"));
  EXPECT_EQ(table->column("rate_deg_per_h")[0], 1.0);
  EXPECT_THAT(error("a\n1\n", {{"rate_deg_per_h", "omega"}}),
              HasSubstr(":1: column omega: not found"));
}

TEST_F(ReadTable, DropsTextInForeignColumnsAndRemembersWhy) {
  const auto table = read("rate_deg_per_h,operator\n1,Ivanov\n2,3\n");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_FALSE(table->has("operator"));
  EXPECT_THAT(table->why_missing("operator"), HasSubstr(":2: column operator: found 'Ivanov'"));
  EXPECT_THAT(table->why_missing("field_x_ut"), HasSubstr("found only rate_deg_per_h"));
}

TEST_F(ReadTable, NamesFileLineColumnAndWhatWasFound) {
  EXPECT_EQ(error("rate_deg_per_h,time_s\n1,2\n1,abc\n"),
            ":3: column time_s: found 'abc', expected a finite number, a date or nothing");
  EXPECT_THAT(error("rate_deg_per_h\n1,5\n"),
              HasSubstr(":2: found 2 fields, expected 1 as in the line of names; with decimal "
                        "commas, something else than commas must separate the columns"));
  EXPECT_THAT(error("rate_deg_per_h,time_s\n1\n"), HasSubstr(":2: found 1 fields, expected 2"));
  EXPECT_THAT(error("rate_deg_per_h,time_s\n1,2,3,4\n"), HasSubstr("found 4 fields, expected 2"));
  EXPECT_THAT(error("rate_deg_per_h\n1e999\n"), HasSubstr("found '1e999'"));
  EXPECT_THAT(error("rate_deg_per_h\ninf\n"), HasSubstr("found 'inf'"));
  EXPECT_THAT(error("rate_deg_per_h\n-Infinity\n"), HasSubstr("found '-Infinity'"));
  EXPECT_THAT(error("rate_deg_per_h\n0x10\n"), HasSubstr("found '0x10'"));
  EXPECT_THAT(error("rate_deg_per_h\n1 2\n"), HasSubstr("found '1 2'"));
  EXPECT_THAT(error("rate_deg_per_h,segment\n\"1,2\n"), HasSubstr(":2: column rate_deg_per_h: "
                                                                  "found a quote"));
}

TEST_F(ReadTable, RefusesWhatIsNotATable) {
  EXPECT_THAT(error(""), HasSubstr("found an empty file"));
  EXPECT_THAT(error("rate_deg_per_h,time_s\n"), HasSubstr("found a header and no rows"));
  EXPECT_THAT(error("a,b,a\n1,2,3\n"), HasSubstr(":1: column a: found twice"));
  EXPECT_THAT(error(std::string("\x7f"
                                "ELF\x02\x01\x01\0\0\0\0",
                                11)),
              HasSubstr("a text file?"));
  EXPECT_THAT(error(std::string("rate_deg_per_h\n1\0\n", 18)), HasSubstr("found '1\\x00'"));
  EXPECT_THAT(error(std::string("rate_deg_per_h,segment\n1,a\0b\n", 29)),
              HasSubstr("column segment: found 'a\\x00b'"));
  const auto directory = read_table(folder_.path());
  ASSERT_FALSE(directory);
  EXPECT_THAT(directory.error().message, HasSubstr("found a directory"));
  const auto nothing = read_table(folder_ / "no.csv");
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().message, HasSubstr("no.csv: cannot be opened"));
}

TEST_F(ReadTable, RefusesALineOfTwoGigabytesAtOnce) {
  const std::filesystem::path file = folder_ / "data.csv";
  std::ofstream(file) << "rate_deg_per_h\n1\n";
  // A sparse file: two gigabytes of zeros without a line end.
  std::filesystem::resize_file(file, std::uintmax_t{2} << 30);
  const auto table = read_table(file);
  ASSERT_FALSE(table);
  EXPECT_THAT(table.error().message, HasSubstr(":3: found a line longer than 1 MiB"));
}

TEST_F(ReadTable, RefusesAHundredThousandColumns) {
  std::string names = "c0", row = "0";
  for (int i = 1; i < 100'000; ++i) {
    names += ",c" + std::to_string(i);
    row += ",0";
  }
  EXPECT_THAT(error(names + "\n" + row + "\n"),
              HasSubstr(":1: found 100000 columns, expected at most 4096"));
}

TEST_F(ReadTable, ReadsArchivesOfSeveralPartsToTheirEnd) {
  const std::filesystem::path file = folder_ / "parts.csv.gz";
  for (const char* const part : {"rate_deg_per_h\n1\n", "2\n"}) {
    gzFile out = gzopen(file.c_str(), "ab");
    gzputs(out, part);
    gzclose(out);
  }
  const auto table = read_table(file);
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_THAT(values(*table, "rate_deg_per_h"), ElementsAre(1, 2));
}

TEST_F(ReadTable, RefusesAnArchiveThatGrowsIntoOneLine) {
  const std::filesystem::path file = folder_ / "bomb.csv.gz";
  gzFile out = gzopen(file.c_str(), "wb1");
  const std::string zeros(1 << 20, '0');
  gzputs(out, "rate_deg_per_h\n");
  for (int i = 0; i < 64; ++i) gzwrite(out, zeros.data(), static_cast<unsigned>(zeros.size()));
  gzclose(out);
  const auto table = read_table(file);
  ASSERT_FALSE(table);
  EXPECT_THAT(table.error().message, HasSubstr("found a line longer than 1 MiB"));
}

TEST_F(ReadTable, TakesALineOfOneMebibyteAndNoMore) {
  const std::string fits = "\n1" + std::string((1 << 20) - 1, ' ') + "\n2\n";
  const auto table = read("rate_deg_per_h" + fits);
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_THAT(values(*table, "rate_deg_per_h"), ElementsAre(1, 2));
  EXPECT_THAT(error("rate_deg_per_h\n1" + std::string(1 << 20, ' ') + "\n2\n"),
              HasSubstr(":2: found a line longer"));
}

TEST_F(ReadTable, LinesThatStraddleTheBufferStayWhole) {
  std::string text = "rate_deg_per_h,time_s\n";
  for (int i = 0; i < 700'000; ++i) text += std::to_string(i) + "," + std::to_string(i) + "\n";
  const auto table = read(text);
  ASSERT_TRUE(table) << table.error().message;
  ASSERT_EQ(table->rows(), 700'000u);
  for (std::size_t i = 0; i < table->rows(); ++i) {
    ASSERT_EQ(table->column("time_s")[i], static_cast<double>(i));
  }
}

TEST_F(ReadTable, WhatWasWrittenReadsBack) {
  const auto table =
      read("run,segment,time_s,rate_deg_per_h\nb,\"x, \"\"y\"\"\",1,0.1\na,,2,\nb,z,3,-1e-300\n");
  ASSERT_TRUE(table);
  const std::filesystem::path copy = folder_ / "copy.csv";
  ASSERT_TRUE(write_csv(*table, copy));
  const auto back = read_table(copy);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->run().at(1), "a");
  EXPECT_EQ(back->segment().at(0), "x, \"y\"");
  EXPECT_EQ(back->column("rate_deg_per_h")[0], 0.1);
  EXPECT_TRUE(std::isnan(back->column("rate_deg_per_h")[1]));
  EXPECT_EQ(back->column("rate_deg_per_h")[2], -1e-300);
}

TEST_F(ReadTable, TestsStandApartAsRunsDo) {
  const auto tests = read("test,rate_deg_per_h\n1,0.1\n2,0.2\n");
  ASSERT_TRUE(tests);
  EXPECT_EQ(tests->run_word(), "test");
  EXPECT_EQ(tests->run().at(1), "2");
  const auto runs = read("run,test,rate_deg_per_h\n7,1,0.1\n8,1,0.2\n");
  ASSERT_TRUE(runs);
  EXPECT_EQ(runs->run_word(), "run");
  EXPECT_EQ(runs->run().at(1), "8");
  EXPECT_EQ(runs->column("test")[1], 1.0);
  const std::filesystem::path copy = folder_ / "copy.csv";
  ASSERT_TRUE(write_csv(*tests, copy));
  EXPECT_EQ(read_table(copy)->run_word(), "test");
}

/// Rows at 1 s, two segments of `each` rows, rate = row number.
std::string long_text(int each) {
  std::string text = "time_s,duration_s,rate_std_error_deg_per_h,segment,rate_deg_per_h\n";
  for (int i = 0; i < 2 * each; ++i) {
    text +=
        std::to_string(i) + ",1,0.2," + (i < each ? "up" : "down") + "," + std::to_string(i) + "\n";
  }
  return text;
}

TEST_F(ReadTable, AveragesNeighboursOfASegmentWhereRowsAreManyMoreThanAsked) {
  const auto table = read(long_text(50), {}, 40);
  ASSERT_TRUE(table);
  // Averaged by twos at the 40th row, by fours at the 70th; the last of each segment has two.
  EXPECT_EQ(table->rows_averaged(), 4U);
  ASSERT_EQ(table->rows(), 26U);
  EXPECT_EQ(table->column("rate_deg_per_h")[0], 1.5);
  EXPECT_EQ(table->column("time_s")[11], 45.5);
  EXPECT_EQ(table->column("duration_s")[11], 4.0);
  EXPECT_DOUBLE_EQ(table->column("rate_std_error_deg_per_h")[11], 0.1);
  EXPECT_EQ(table->segment().at(12), "up");
  EXPECT_EQ(table->column("rate_deg_per_h")[12], 48.5);
  EXPECT_EQ(table->segment().at(13), "down");
}

TEST_F(ReadTable, AveragesNoMoreThanItMust) {
  const auto table = read(long_text(4000), {}, 300);
  ASSERT_TRUE(table);
  EXPECT_GE(table->rows(), 100U);
  EXPECT_LE(table->rows(), 300U);
  EXPECT_EQ(table->column("rate_deg_per_h")[0], 31.5);
}

TEST_F(ReadTable, KeepsEveryRowWhereTheyAreFew) {
  const auto table = read(long_text(50), {}, 101);
  ASSERT_TRUE(table);
  EXPECT_EQ(table->rows_averaged(), 1U);
  EXPECT_EQ(table->rows(), 100U);
}

TEST_F(ReadTable, KeepsEveryRowWhereTheirOrderIsNotThatOfTime) {
  std::string text = long_text(50);
  text += "3,1,0.2,down,3\n";
  const auto table = read(text, {}, 40);
  ASSERT_TRUE(table);
  EXPECT_EQ(table->rows_averaged(), 1U);
  EXPECT_EQ(table->rows(), 101U);
}

TEST_F(ReadTable, AMissingNumberDoesNotCountInAnAverage) {
  const auto table = read("time_s,x\n0,1\n1,\n2,5\n3,7\n4,9\n5,\n", {}, 6);
  ASSERT_TRUE(table);
  EXPECT_THAT(table->column("x"), ElementsAre(1.0, 6.0, 9.0));
}

TEST_F(ReadTable, ManyShortSegmentsStayApart) {
  std::string text = "segment,rate_deg_per_h\n";
  for (int i = 0; i < 60; ++i) text += std::to_string(i) + "," + std::to_string(i) + "\n";
  const auto table = read(text, {}, 8);
  ASSERT_TRUE(table);
  EXPECT_EQ(table->rows(), 60U);
}

}  // namespace
}  // namespace fogbench::model
