// Prototype study driver.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>

#include "model/diagnose/search.hpp"
#include "tests/support/foreign_bench.hpp"

using namespace fogbench;
using namespace fogbench::tests;

static model::SearchResult run(const model::Table& table, Design design) {
  static thread_local config::ModelFile file;
  file = {};
  for (const auto& t : base_terms(design)) {
    file.terms.push_back({});
    file.terms.back().effect = t;
  }
  const model::Signals signals(table, 21.0);
  Eigen::MatrixXd base(static_cast<Eigen::Index>(signals.rows()),
                       static_cast<Eigen::Index>(file.terms.size()));
  for (std::size_t i = 0; i < file.terms.size(); ++i) {
    base.col(static_cast<Eigen::Index>(i)) =
        model::finite_regressor(*model::find_effect(file.terms[i].effect), signals, {});
  }
  model::Windows w;
  for (const auto& r : signals.runs()) w.run_begin.push_back(r.begin);
  w.run_begin.push_back(signals.rows());
  w.centre_s = signals.signal("time_s");
  w.duration_s = signals.signal("duration_s");
  w.white_floor = signals.signal("rate_std_error_deg_per_h");
  auto shapes = model::NoiseShapes::make(w);
  if (!shapes) { fmt::print("{}\n", shapes.error().message); std::exit(1); }
  const model::SearchInput input{signals, *shapes, file, base, signals.signal("rate_deg_per_h")};
  return model::search(input, {});
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
    for (const auto& f : r.found) {
      name += std::string(f.effect->info().id);
      if (!f.inner.empty()) name += fmt::format("({:.3g})", f.inner[0]);
      if (!f.rivals.empty()) {
        name += "{";
        for (const auto& x : f.rivals) name += fmt::format("{} {:.2f},", x.effect, x.probability);
        name += "}";
      }
      if (!f.or_shape.empty()) name += "|" + f.or_shape;
      name += " + ";
    }
    if (!r.outside_shape.empty()) name += " OUTSIDE " + r.outside_shape;
    std::string ps;
    for (double p : r.p_of_step) ps += fmt::format("{:.2g} ", p);
    if (argc > 7 || i < 3) fmt::print("{:3d} p {} {}\n", i, ps, name);
    alarms += !r.found.empty();
    if (!r.found.empty() && r.found[0].effect->info().id == what) ++right;
    ++answers[r.found.empty() ? "adequate" : std::string(r.found[0].effect->info().id) + (r.found[0].rivals.empty() ? "" : " (set)") + (r.found.size() > 1 ? " +more" : "")+(r.outside_shape.empty()?"":" OUT")];
  }
  const double secs = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
  fmt::print("{}: {} trials, found {}, first right {}, {:.2f} s each\n", what, trials, alarms, right, secs / trials);
  for (const auto& [k, v] : answers) fmt::print("   {:4d} {}\n", v, k);
}
