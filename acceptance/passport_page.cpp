#include "acceptance/passport_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acceptance/conditions.hpp"
#include "acceptance/passport.css.hpp"
#include "acceptance/passport_plots.hpp"
#include "acceptance/passport_writer.hpp"
#include "model/report/report_page.hpp"
#include "model/report/svg_plot.hpp"
#include "record/file_hash.hpp"

namespace fogbench::acceptance {
using model::Conformity;
using model::escaped;

namespace {

const char* kind_of(Conformity verdict) {
  return verdict == Conformity::kPass ? "pass" : verdict == Conformity::kFail ? "fail" : "";
}

/// Writes the page in one language.
class Page : public PassportWriter {
 public:
  using PassportWriter::PassportWriter;

  std::string html() {
    const std::string title = fmt::format("{} {}", say(Text::kTitle), acceptance_.gyro());
    out_ = model::page_start(title, say(Text::kLanguageCode), kPassportStyle);
    out_ += fmt::format("<h1>{}</h1>\n<p class=\"sub\">{} {} &middot; fogbench {}</p>\n",
                        escaped(title), say(Text::kIssued), date(passport_.issued_at),
                        passport_.software_version);
    verdict();
    limits();
    repeatability();
    coefficients();
    thermal();
    magnetic();
    plots();
    noise();
    origin();
    instruments();
    signatures();
    return out_ + model::page_end();
  }

 private:
  void verdict() {
    const Conformity overall = passport_.judged.overall;
    const bool pass = overall == Conformity::kPass, fail = overall == Conformity::kFail;
    out_ += fmt::format("<div class=\"verdict{}\">\n<h2>{}</h2>\n",
                        fail   ? " fails"
                        : pass ? ""
                               : " open",
                        say(pass   ? Text::kOverallPass
                            : fail ? Text::kOverallFail
                                   : Text::kOverallIndeterminate));
    if (!passport_.remarks.empty()) {
      out_ += fmt::format("<p>{}</p>\n<ul>\n", say(Text::kRemarks));
      for (const Remark& remark : passport_.remarks) {
        out_ += fmt::format("<li>{}</li>\n", escaped(remark_text(remark, language_)));
      }
      out_ += "</ul>\n";
    }
    out_ += "</div>\n";
  }

  void limits() {
    section(Text::kLimits);
    table({say(Text::kQuantity), say(Text::kUnit), say(Text::kTest), say(Text::kConditions),
           say(Text::kMinimum), say(Text::kMaximum), say(Text::kValue), say(Text::kUncertainty),
           say(Text::kVerdict)},
          4);
    for (const model::Judgement& r : passport_.judged.results) {
      const bool missing = r.test.empty();
      auto [value, uncertainty] = rounded(r.value, r.expanded_uncertainty);
      if (missing) value = say(Text::kMissing);
      row({name(r.quantity), unit(r.unit),
           missing ? say(Text::kTooFewTests, r.tests_measured, r.tests_expected) : escaped(r.test),
           conditions_text(r.conditions, "°C", say(Text::kMicrotesla)), number(r.minimum),
           number(r.maximum), value, uncertainty, std::string(verdict_name(r.verdict, language_))},
          kind_of(r.verdict));
    }
    end_table();
    const config::LimitsConfig& config = passport_.limits;
    note(fmt::format("&laquo;{}&raquo;{}{}", escaped(config.name),
                     config.description.empty() ? "" : ": ", escaped(config.description)));
    note(say(Text::kRule, number(passport_.judged.coverage_factor)));
    end_section();
  }

  void repeatability() {
    if (passport_.judged.repeats.empty()) return;
    section(Text::kRepeatability);
    table({say(Text::kQuantity), say(Text::kUnit), say(Text::kTest), say(Text::kValue),
           say(Text::kDifference), say(Text::kUncertainty), say(Text::kLimit), say(Text::kVerdict)},
          3);
    for (const model::Repeat& r : passport_.judged.repeats) {
      const bool missing = std::isnan(r.difference);
      const auto [difference, uncertainty] = rounded(r.difference, r.expanded_uncertainty);
      const std::string says = r.verdict
                                   ? std::string(verdict_name(*r.verdict, language_))
                                   : say(r.significant ? Text::kBeyondNoise : Text::kWithinNoise);
      row({name(r.quantity), unit(r.unit),
           missing ? say(Text::kMissing) : fmt::format("{} &rarr; {}", r.test_a, r.test_b),
           missing ? ""
                   : fmt::format("{} &rarr; {}", rounded(r.value_a, r.expanded_uncertainty).first,
                                 rounded(r.value_b, r.expanded_uncertainty).first),
           difference, uncertainty, number(r.limit), says},
          r.verdict ? kind_of(*r.verdict) : "");
    }
    end_table();
    for (const model::RunChange& change : acceptance_.changes) {
      note(escaped(change_text(change, passport_.judged.coverage_factor, language_)));
    }
    end_section();
  }

  void coefficients() {
    const auto fitted = std::find_if(acceptance_.tests.begin(), acceptance_.tests.end(),
                                     [](const TestResults& test) { return test.fit.has_value(); });
    if (fitted == acceptance_.tests.end()) return;
    section(Text::kCoefficients, true);
    std::vector<std::string> heads{say(Text::kQuantity), say(Text::kUnit)}, ids;
    for (const TestResults& test : acceptance_.tests) {
      if (!test.fit) continue;
      heads.push_back(fmt::format("{} {}, &plusmn; U", say(Text::kTest), escaped(test.name)));
      for (const model::Estimate& e : test.fit->estimates) {
        if (std::find(ids.begin(), ids.end(), e.name) == ids.end()) ids.push_back(e.name);
      }
    }
    table(heads, 2, "");
    for (const std::string& id : ids) row(coefficient(id));
    end_table();
    for (const TestResults& test : acceptance_.tests) {
      if (!test.fit) continue;
      note(fmt::format("{} {}: {} &laquo;{}&raquo;, {} {}, RMS {} {}", say(Text::kTest),
                       escaped(test.name), say(Text::kModel), escaped(test.model),
                       test.fit->rows.size(), say(Text::kPointsOfFit), number(test.fit->rms),
                       unit("deg/h")));
    }
    note(say(Text::kUncertaintyScope, number(fitted->fit->fitted.reference_temperature_c)));
    end_section();
  }

  /// Its row: name, unit, and what each test's fit made of it.
  std::vector<std::string> coefficient(const std::string& id) const {
    std::vector<std::string> cells{name(id), ""};
    for (const TestResults& test : acceptance_.tests) {
      if (!test.fit) continue;
      cells.emplace_back();
      for (const model::Estimate& e : test.fit->estimates) {
        if (e.name != id) continue;
        cells[1] = unit(e.unit);
        const double u =
            0.5 * e.coverage_factor * passport_.judged.coverage_factor * e.standard_error;
        cells.back() =
            std::isnan(e.value) ? say(Text::kNotDetermined) : with_uncertainty(e.value, u);
      }
    }
    return cells;
  }

  void thermal() {
    if (std::all_of(acceptance_.tests.begin(), acceptance_.tests.end(),
                    [](const TestResults& test) { return test.set_points.empty(); })) {
      return;
    }
    section(Text::kThermal, true);
    table({say(Text::kTest), say(Text::kSetPoint), say(Text::kTemperature), say(Text::kAverages),
           say(Text::kDeviation), say(Text::kSigma)},
          1, "");
    for (const TestResults& test : acceptance_.tests) {
      for (const SetPoint& p : test.set_points) {
        row({escaped(test.name), number(p.target_c),
             localised(fmt::format("{:.2f}", p.temperature_c), language_),
             std::to_string(p.averages),
             with_uncertainty(p.deviation_deg_per_h.value, expanded(p.deviation_deg_per_h)),
             localised(fmt::format("{:.2g}", p.sigma_deg_per_h), language_)});
      }
    }
    end_table();
    end_section();
  }

  /// K with the uncertainty that the fit's noise gives it.
  std::string k_of(const TestResults& test, char axis) const {
    for (const model::Measured& m : acceptance_.measured) {
      if (m.test != test.name || m.quantity != fmt::format("K_{}", axis)) continue;
      return with_uncertainty(m.value, expanded_uncertainty(m, passport_.judged.coverage_factor));
    }
    return "&ndash;";
  }

  void magnetic() {
    if (std::all_of(acceptance_.tests.begin(), acceptance_.tests.end(),
                    [](const TestResults& test) { return test.results.sweeps.empty(); })) {
      return;
    }
    section(Text::kMagnetic, true);
    table({say(Text::kTest), say(Text::kAxis), say(Text::kK), say(Text::kClosure)}, 2, "");
    for (const TestResults& test : acceptance_.tests) {
      std::string done;
      for (const SweepResult& sweep : test.results.sweeps) {
        if (done.find(sweep.axis) != std::string::npos) continue;
        done += sweep.axis;
        row({escaped(test.name), fmt::format("O{}", static_cast<char>(sweep.axis - 'x' + 'X')),
             k_of(test, sweep.axis),
             with_uncertainty(sweep.closure_deg_per_h.value, expanded(sweep.closure_deg_per_h))});
      }
    }
    end_table();
    note(say(Text::kClosureScope));
    end_section();
  }

  void plots() {
    const std::string figures = passport_plots(acceptance_, language_);
    if (figures.empty()) return;
    section(Text::kPlots, true);
    out_ += figures;
    end_section();
  }

  void noise() {
    section(Text::kNoise, true);
    if (acceptance_.noise.empty()) note(say(Text::kNoNoiseRecord));
    for (const NoiseTerms& terms : acceptance_.noise) {
      note(say(Text::kNoiseRecord, terms.samples, number(terms.interval_s), terms.stretch.test,
               escaped(terms.stretch.segment)));
      if (!terms.fit) continue;
      const config::NoiseCoefficients& n = terms.fit->noise;
      const config::NoiseCoefficients& e = terms.fit->standard_error;
      table({say(Text::kNoiseTerm), say(Text::kUnit), say(Text::kValue), say(Text::kUncertainty)},
            2, "");
      const auto term = [&](const std::string& name, const char* in, double value, double error) {
        const auto [v, u] = rounded(value, passport_.judged.coverage_factor * error);
        const bool seen = value > 0.0;
        row({name, unit(in), seen ? v : say(Text::kNotSeen), seen ? u : ""});
      };
      term(name("angle_random_walk"), "deg/sqrt(h)", n.angle_random_walk_deg_per_sqrt_h,
           e.angle_random_walk_deg_per_sqrt_h);
      term(name("bias_instability"), "deg/h", n.bias_instability_deg_per_h,
           e.bias_instability_deg_per_h);
      term(name("rate_random_walk"), "deg/h/sqrt(h)", n.rate_random_walk_deg_per_h_per_sqrt_h,
           e.rate_random_walk_deg_per_h_per_sqrt_h);
      term(say(Text::kQuantisation), "deg", n.quantisation_deg, e.quantisation_deg);
      end_table();
    }
    end_section();
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
         record::text_sha256(header.procedure_json + header.bench_json + header.scenario_json),
         "hash");
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

std::string passport_html(const Passport& passport, Language language) {
  return Page(passport, language).html();
}

}  // namespace fogbench::acceptance
