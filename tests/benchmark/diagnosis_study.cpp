// Prototype study driver.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>

#include "model/diagnose/diagnose.hpp"
#include "tests/support/foreign_bench.hpp"

using namespace fogbench;
using namespace fogbench::tests;

static model::Diagnosis run(const model::Table& table, Design design) {
  config::ModelFile file;
  for (const auto& t : base_terms(design)) file.terms.push_back({.effect = t});
  auto r = model::diagnose(table, file, {});
  if (!r) { fmt::print("{}\n", r.error().message); std::exit(1); }
  return *r;
}

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "nulls";
  const int trials = argc > 2 ? std::atoi(argv[2]) : 20;
  const Design design = argc > 3 && std::string(argv[3]) == "thermal" ? Design::kThermal
                        : argc > 3 && std::string(argv[3]) == "cooling" ? Design::kThermalCooling
                        : argc > 3 && std::string(argv[3]) == "mixed" ? Design::kMixed
                                                                       : Design::kMagnetic;
  ForeignNoise noise = argc > 4 && std::string(argv[4]) == "tactical" ? kTactical : kNavigation;
  if (argc > 4 && std::string(argv[4]) == "white") noise = {0.002, 0.0, 0.0};
  if (argc > 4 && std::string(argv[4]) == "walk") noise = {0.002, 0.0, 0.02};
  const double snr = argc > 5 ? std::atof(argv[5]) : 10.0;
  const double inner = argc > 6 ? std::atof(argv[6]) : 0.0;
  int alarms = 0, right = 0, sets = 0;
  std::map<std::string, int> answers;
  const auto t0 = std::chrono::steady_clock::now();
  for (int i = 0; i < trials; ++i) {
    std::vector<ForeignEffect> hidden;
    if (what != "nulls") {
      ForeignEffect e{what, 1.0, inner, 0.6};
      const auto probe = make_foreign_table(design, {0.001, 0, 0}, {e}, 1);
      double s = 0;
      double m = 0;
      for (double h : probe.hidden) m += h / double(probe.hidden.size());
      for (double h : probe.hidden) s += (h - m) * (h - m);
      s = std::sqrt(s / double(probe.hidden.size()));
      // crude: rms of effect = snr * sigma_row / sqrt(n)
      double sr = 0;
      const auto nn = make_foreign_table(design, noise, {}, 77);
      double mm = 0;
      for (double h : nn.noise) mm += h / double(nn.noise.size());
      for (double h : nn.noise) sr += (h - mm) * (h - mm);
      sr = std::sqrt(sr / double(nn.noise.size()));
      e.amplitude = snr * sr / s / std::sqrt(double(probe.hidden.size()));
      hidden = {e};
    }
    const auto t = make_foreign_table(design, noise, hidden, 1000 + std::uint64_t(i));
    const auto r = run(t.table, design);
    std::string name;
    for (const auto& m : r.missing) {
      const auto& f = m.found;
      name += f.effect + fmt::format("({:.3g}", f.inner);
      for (double x : f.more_inner) name += fmt::format(",{:.3g}", x);
      name += fmt::format(" p{:.1g})", f.p_value);
      if (!f.rivals.empty()) {
        name += "{";
        for (const auto& x : f.rivals) name += fmt::format("{} {:.2f},", x.effect, x.probability);
        name += "}";
      }
      if (!f.or_shape.empty()) name += "|" + f.or_shape;
      name += " + ";
    }
    if (r.verdict == model::Verdict::kUnexplained) name += fmt::format(" UNEXPLAINED p{:.1g} {} {}", r.unexplained.p_value, r.unexplained.suggestion, r.unexplained.depends_on.empty()?"":r.unexplained.depends_on[0]);
    if (argc > 7 || i < 3) fmt::print("{:3d} p {:.2g} {}\n", i, r.p_adequate, name);
    alarms += r.verdict != model::Verdict::kNothingMissing;
    if (!r.missing.empty() && r.missing[0].found.effect == what) ++right;
    std::string key(model::name_of(r.verdict));
    for (const auto& m : r.missing) { key += " " + m.found.effect; if (!m.found.rivals.empty()) { key += "{"; for (const auto& x : m.found.rivals) key += x.effect + " "; key += "}"; } }
    ++answers[key];
  }
  const double secs = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
  fmt::print("{}: {} trials, found {}, first right {}, {:.2f} s each\n", what, trials, alarms, right, secs / trials);
  for (const auto& [k, v] : answers) fmt::print("   {:4d} {}\n", v, k);
}
