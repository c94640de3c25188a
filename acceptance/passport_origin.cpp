// The last sections of a passport's page: where the data come from, the instruments, signatures.

#include <fmt/format.h>

#include <span>

#include "acceptance/passport_writer.hpp"
#include "model/report/svg_plot.hpp"
#include "record/chunk_codec.hpp"

namespace fogbench::acceptance {
using model::escaped;

namespace {

class Origin : public PassportWriter {
 public:
  using PassportWriter::PassportWriter;

  std::string html() {
    origin();
    instruments();
    signatures();
    return std::move(out_);
  }

 private:
  std::string hash(const std::string& content) const {
    return record::hexadecimal(record::sha256_of(std::as_bytes(std::span(content))));
  }

  void origin() {
    section(Text::kProvenance, true);
    out_ += "<div class=\"wide\"><table class=\"full origin\">\n";
    for (const RunProvenance& made : acceptance_.runs) origin_of(made);
    end_table();
    end_section();
  }

  void fact(Text what, const std::string& value, const char* kind = "free") {
    const std::string shown = value.empty() ? say(Text::kNotRecorded) : escaped(value);
    out_ += fmt::format("<tr><td>{}</td><td class=\"{}\">{}</td></tr>\n", say(what), kind, shown);
  }

  void origin_of(const RunProvenance& made) {
    const record::StoredRun& run = made.run;
    const procedures::RunHeader& header = run.header;
    fact(Text::kRun, std::to_string(run.run));
    fact(Text::kGyro, header.gyro_serial_number);
    fact(Text::kOperator, header.operator_name);
    fact(Text::kProcedure, header.procedure);
    fact(Text::kBench, header.bench);
    if (header.seed) fact(Text::kSeed, std::to_string(*header.seed));
    fact(Text::kStarted, date(header.started_at));
    fact(Text::kEnded, run.end ? date(run.end->ended_at) : "");
    const std::string outcome(outcome_name(run.outcome(), language_));
    fact(Text::kOutcome,
         made.taken_up ? fmt::format("{}; {}", outcome, say(Text::kTakenUp)) : outcome);
    fact(Text::kSoftware, "fogbench " + header.software_version);
    fact(Text::kConfiguration,
         hash(header.procedure_json + header.bench_json + header.scenario_json), "hash");
    fact(Text::kRawData,
         fmt::format("{} ({})", made.raw_sha256,
                     say(made.raw_data_intact ? Text::kIntact : Text::kChanged)),
         "hash");
    fact(Text::kPoints,
         run.points_void == 0
             ? std::to_string(run.points)
             : fmt::format("{}, {} {}", run.points, say(Text::kPointsVoid), run.points_void));
    fact(Text::kFrames, run.end
                            ? fmt::format("{}, {} {}", run.frames_stored, say(Text::kFramesMissing),
                                          run.end->stream.frames_missing)
                            : std::to_string(run.frames_stored));
  }

  void instruments() {
    section(Text::kInstruments, true);
    table({say(Text::kRun), say(Text::kInstrument), say(Text::kIdentity), say(Text::kSerialNumber),
           say(Text::kCalibrated), say(Text::kDue)},
          6);
    for (const RunProvenance& made : acceptance_.runs) {
      for (const procedures::InstrumentRecord& i : made.instruments) {
        const auto stated = [](const std::string& d) { return d.empty() ? "&ndash;" : escaped(d); };
        row({std::to_string(made.run.run), std::string(role_name(i.role, language_)),
             escaped(i.identity), escaped(i.serial_number), stated(i.calibrated_on),
             stated(i.calibration_due)});
      }
    }
    end_table();
    end_section();
  }

  void signatures() {
    section(Text::kSignatures, true);
    out_ += "<table class=\"signatures\">\n";
    for (const Text who : {Text::kTestedBy, Text::kCheckedBy, Text::kCustomer}) {
      out_ += fmt::format(
          "<tr><td>{}</td><td><div></div></td><td><div></div></td><td><div></div></td></tr>\n"
          "<tr class=\"under\"><td></td><td>{}</td><td>{}</td>"
          "<td>{}</td></tr>\n",
          say(who), say(Text::kName), say(Text::kSignature), say(Text::kDate));
    }
    out_ += "</table>\n";
    end_section();
  }
};

}  // namespace

std::string passport_origin(const Passport& passport, Language language) {
  return Origin(passport, language).html();
}

}  // namespace fogbench::acceptance
