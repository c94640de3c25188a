#include "tests/support/foreign_bench.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace fogbench::tests {
namespace {

constexpr double kStep = 10.0;  // s
constexpr double kPi = std::numbers::pi;
using Series = std::vector<double>;

/// True states on the grid, and where the windows lie.
struct World {
  Series temperature, rate, gradient, heater, ambient, hx, hy, hz, azimuth;
  struct Window { std::size_t begin, end; std::string segment; };
  std::vector<Window> windows;
  std::size_t size() const { return temperature.size(); }
};

/// Grows a world step by step.
class Maker {
 public:
  explicit Maker(std::mt19937_64& engine)
      : ambient_phase_(std::uniform_real_distribution<>(0.0, 2.0 * kPi)(engine)) {}

  void step(double target, double hx, double hy, double hz, double azimuth) {
    // Boost heating 45 degC/h until 2 degC below the target, then an exponential approach of 8 min.
    const double missing = target - t_;
    double wanted = missing > 2.0 ? 45.0 : missing * 3600.0 / 480.0;
    wanted = std::max(wanted, -25.0);
    rate_ += (wanted - rate_) * (1.0 - std::exp(-kStep / 60.0));
    t_ += rate_ * kStep / 3600.0;
    const double seconds = static_cast<double>(w.size()) * kStep;
    const double ambient = 21.0 + 0.5 * std::sin(2.0 * kPi * seconds / 9000.0 + ambient_phase_);
    const double heater = std::clamp(0.22 * (t_ - ambient) + 0.22 * rate_, 0.0, 12.0);
    w.temperature.push_back(t_);
    w.rate.push_back(rate_);
    w.ambient.push_back(ambient);
    w.heater.push_back(heater);
    gradient_ += (0.06 * heater + 0.01 * rate_ - gradient_) * (1.0 - std::exp(-kStep / 240.0));
    w.gradient.push_back(gradient_);
    w.hx.push_back(hx);
    w.hy.push_back(hy);
    w.hz.push_back(hz);
    w.azimuth.push_back(azimuth);
  }

  void window(double seconds, const std::string& segment, double target, double hx = 0.0,
              double hy = 0.0, double hz = 0.0, double azimuth = 0.0) {
    const std::size_t begin = w.size();
    for (double s = 0.0; s < seconds; s += kStep) step(target, hx, hy, hz, azimuth);
    w.windows.push_back({begin, w.size(), segment});
  }

  void sweep(char axis, double azimuth, double target) {
    const auto at = [&](double h, double seconds, const std::string& branch) {
      const double x = axis == 'x' ? h : 0.0, y = axis == 'y' ? h : 0.0, z = axis == 'z' ? h : 0.0;
      for (int i = 0; i < 2; ++i) step(target, x, y, z, azimuth);
      window(seconds, std::string("coil_") + axis + "/" + branch, target, x, y, z, azimuth);
    };
    for (int level = 0; level <= 6; ++level) at(50.0 * level, 180.0, "up");
    for (int level = 5; level >= -6; --level) at(50.0 * level, 180.0, "down");
    for (int level = -5; level <= 0; ++level) at(50.0 * level, 180.0, "return");
  }

  World w;

 private:
  double t_ = 21.0, rate_ = 0.0, gradient_ = 0.0, ambient_phase_;
};

World make_world(Design design, std::mt19937_64& engine) {
  Maker maker(engine);
  const auto sweeps = [&](double target) {
    maker.sweep('x', 0.0, target);
    maker.sweep('y', 0.0, target);
    for (int i = 0; i < 12; ++i) maker.step(target, 0.0, 0.0, 0.0, 90.0);
    maker.sweep('z', 90.0, target);
  };
  const auto hold = [&](double target, int windows, const std::string& segment) {
    for (int i = 0; i < windows; ++i) maker.window(60.0, segment, target);
  };
  if (design == Design::kMagnetic) {
    sweeps(21.0);
    return maker.w;
  }
  hold(21.0, 10, "thermostat/baseline");
  for (const double target : {31.0, 35.0, 40.0, 45.0, 50.0, 55.0}) {
    hold(target, design == Design::kMixed ? 40 : 60, "thermostat/up");
  }
  if (design == Design::kThermalCooling) {
    for (const double target : {45.0, 35.0, 25.0}) hold(target, 60, "thermostat/down");
  }
  if (design == Design::kMixed) {
    sweeps(55.0);
    hold(35.0, 60, "thermostat/down");
    sweeps(35.0);
  }
  return maker.w;
}

Series lagged(const Series& u, double tau) {
  Series out(u.size());
  double state = u.front();
  for (std::size_t i = 0; i < u.size(); ++i) {
    state += (u[i] - state) * (1.0 - std::exp(-kStep / tau));
    out[i] = state;
  }
  return out;
}

Series play(const Series& u, double width) {
  Series out(u.size());
  double state = u.front();
  for (std::size_t i = 0; i < u.size(); ++i) {
    state = std::min(std::max(state, u[i] - width), u[i] + width);
    out[i] = state;
  }
  return out;
}

/// A relaxing loop in the manner of Duhem: d(m)/d|h| = (tanh(h/s) - m)/width.
Series relaxing_loop(const Series& u, double width) {
  Series out(u.size());
  double m = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double dh = i > 0 ? u[i] - u[i - 1] : 0.0;
    m += (u[i] + (dh < 0.0 ? 1.0 : -1.0) * width - m) * (1.0 - std::exp(-std::abs(dh) / width));
    out[i] = m;
  }
  return out;
}

Series mapped(std::size_t n, const std::function<double(std::size_t)>& f) {
  Series out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = f(i);
  return out;
}

Series field(const World& w, char axis) {
  const Series& h = axis == 'x' ? w.hx : axis == 'y' ? w.hy : w.hz;
  return mapped(w.size(), [&](std::size_t i) { return h[i] / 100.0; });
}

Series regressor(const World& w, const ForeignEffect& e) {
  const std::size_t n = w.size();
  const auto t = [&](std::size_t i) { return w.temperature[i] - 21.0; };
  const auto seconds = [](std::size_t i) { return (static_cast<double>(i) + 0.5) * kStep; };
  const std::string& id = e.id;
  const double a = e.inner;
  const auto h = [&] { return field(w, id.back()); };
  const auto current = [&] {
    return mapped(n, [&](std::size_t i) {
      return (w.hx[i] * w.hx[i] + w.hy[i] * w.hy[i] + w.hz[i] * w.hz[i]) * 1e-4;
    });
  };
  if (id == "bias_step") return mapped(n, [&](std::size_t i) { return seconds(i) >= a ? 1.0 : 0.0; });
  if (id == "drift_linear") return mapped(n, [&](std::size_t i) { return seconds(i) / 3600.0; });
  if (id == "warm_up") return mapped(n, [&](std::size_t i) { return std::exp(-seconds(i) / a); });
  if (id == "temperature_linear") return mapped(n, t);
  if (id == "temperature_quadratic") return mapped(n, [&](std::size_t i) { return t(i) * t(i); });
  if (id == "temperature_cubic") return mapped(n, [&](std::size_t i) { return std::pow(t(i), 3); });
  if (id == "temperature_rate") return w.rate;
  if (id == "temperature_rate_lagged") return lagged(w.rate, a);
  if (id == "temperature_acceleration") {
    return mapped(n, [&](std::size_t i) {
      return i > 0 ? (w.rate[i] - w.rate[i - 1]) * 3600.0 / kStep : 0.0;
    });
  }
  if (id == "temperature_rate_cross") return mapped(n, [&](std::size_t i) { return t(i) * w.rate[i]; });
  if (id == "temperature_gradient") return w.gradient;
  if (id == "temperature_hysteresis") return play(w.temperature, a);
  if (id == "temperature_ripple") {
    return mapped(n, [&](std::size_t i) { return std::sin(2.0 * kPi * t(i) / a + e.phase); });
  }
  if (id == "heater_power") return w.heater;
  if (id == "ambient_temperature") return mapped(n, [&](std::size_t i) { return w.ambient[i] - 21.0; });
  if (id == "coil_heating") return lagged(current(), a);
  if (id == "earth_rate_projection") {
    return mapped(n, [&](std::size_t i) { return std::cos(w.azimuth[i] * kPi / 180.0 - e.phase); });
  }
  if (id.starts_with("magnetic_linear_")) return h();
  if (id.starts_with("magnetic_quadratic_")) {
    const Series u = h();
    return mapped(n, [&](std::size_t i) { return u[i] * u[i]; });
  }
  if (id.starts_with("magnetic_saturation_")) {
    const Series u = h();
    return mapped(n, [&](std::size_t i) { return std::tanh(u[i] / a); });
  }
  if (id.starts_with("magnetic_hysteresis_")) return play(h(), a);
  if (id.starts_with("magnetic_settling_")) {
    const Series u = h();
    Series out(n);
    double state = 0.0;
    for (std::size_t i = 1; i < n; ++i) {
      state = (state + u[i] - u[i - 1]) * std::exp(-kStep / a);
      out[i] = state;
    }
    return out;
  }
  if (id.starts_with("magnetic_temperature_")) {
    const Series u = h();
    return mapped(n, [&](std::size_t i) { return u[i] * t(i); });
  }
  if (id == "outside_relaxing_loop_z") return relaxing_loop(field(w, 'z'), a > 0.0 ? a : 1.0);
  if (id == "outside_sqrt_field_z") {
    const Series u = field(w, 'z');
    return mapped(n, [&](std::size_t i) { return std::sqrt(std::abs(u[i])); });
  }
  if (id == "outside_one_sided_x") {
    const Series u = field(w, 'x');
    return mapped(n, [&](std::size_t i) { return std::max(0.0, u[i]); });
  }
  if (id == "outside_direction_field_y") {
    const Series u = field(w, 'y');
    double sign = 1.0;
    return mapped(n, [&](std::size_t i) {
      if (i > 0 && u[i] != u[i - 1]) sign = u[i] > u[i - 1] ? 1.0 : -1.0;
      return sign * u[i] * u[i] * u[i];
    });
  }
  if (id == "outside_sine_field_z") {
    const Series u = field(w, 'z');
    return mapped(n, [&](std::size_t i) { return std::sin(2.0 * kPi * u[i] / 1.9); });
  }
  if (id == "outside_pulse") {
    const double from = 0.35 * static_cast<double>(n), to = 0.55 * static_cast<double>(n);
    return mapped(n, [&](std::size_t i) {
      const auto k = static_cast<double>(i);
      return k > from && k < to ? 1.0 : 0.0;
    });
  }
  if (id == "outside_temperature_sine") {
    return mapped(n, [&](std::size_t i) { return std::abs(t(i) - 17.0); });
  }
  if (id == "outside_rate_squared") return mapped(n, [&](std::size_t i) { return w.rate[i] * w.rate[i]; });
  return Series(n, 0.0);
}

/// Means over 10 s of white, flicker and random-walk noise.
Series gyro_noise(std::size_t n, const ForeignNoise& noise, std::mt19937_64& engine) {
  std::normal_distribution<> normal;
  Series out(n);
  const double hours = kStep / 3600.0;
  for (double& v : out) v = noise.white / std::sqrt(hours) * normal(engine);
  constexpr double kRatio = 3.0;
  const double variance = noise.flicker * noise.flicker * std::log(kRatio) / kPi;
  for (double tau = 3.0; tau < 3e6; tau *= kRatio) {
    // Sub-steps resolve the shortest processes; the mean over 10 s is taken of ten of them.
    double x = std::sqrt(variance) * normal(engine);
    const double f = std::exp(-1.0 / tau);
    const double kick = std::sqrt(variance * (1.0 - f * f));
    for (double& v : out) {
      double sum = 0.0;
      for (int s = 0; s < 10; ++s) {
        x = f * x + kick * normal(engine);
        sum += x;
      }
      v += sum / 10.0;
    }
  }
  double walk = 0.0;
  for (double& v : out) {
    const double a = normal(engine), b = normal(engine);
    v += walk + noise.walk * std::sqrt(hours) * (a / 2.0 + b / (2.0 * std::sqrt(3.0)));
    walk += noise.walk * std::sqrt(hours) * a;
  }
  return out;
}

double mean(const Series& s, const World::Window& w) {
  double sum = 0.0;
  for (std::size_t i = w.begin; i < w.end; ++i) sum += s[i];
  return sum / static_cast<double>(w.end - w.begin);
}

}  // namespace

std::vector<std::string> outside_effects() {
  return {"outside_sqrt_field_z", "outside_one_sided_x", "outside_direction_field_y",
          "outside_sine_field_z", "outside_pulse", "outside_temperature_sine",
          "outside_rate_squared"};
}

std::vector<std::string> base_terms(Design design) {
  if (design == Design::kMagnetic) {
    return {"bias", "magnetic_linear_x", "magnetic_linear_y", "magnetic_linear_z"};
  }
  if (design == Design::kMixed) {
    return {"bias", "temperature_linear", "magnetic_linear_x", "magnetic_linear_y",
            "magnetic_linear_z"};
  }
  return {"bias", "temperature_linear"};
}

ForeignTable make_foreign_table(Design design, const ForeignNoise& noise,
                                const std::vector<ForeignEffect>& hidden, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const World w = make_world(design, engine);
  const std::size_t n = w.size();
  const Series random = gyro_noise(n, noise, engine);
  Series effect(n, 0.0), base(n, 0.7);
  for (const ForeignEffect& e : hidden) {
    const Series g = regressor(w, e);
    for (std::size_t i = 0; i < n; ++i) effect[i] += e.amplitude * g[i];
  }
  for (std::size_t i = 0; i < n; ++i) {
    base[i] += (-0.05 * w.hx[i] + 0.12 * w.hy[i] - 0.25 * w.hz[i]) / 100.0;
    if (design != Design::kMagnetic) base[i] -= 0.01 * (w.temperature[i] - 21.0);
  }

  ForeignTable out;
  std::normal_distribution<> normal;
  std::map<std::string, Series> columns;
  model::TextColumn segment;
  std::map<std::string, std::uint32_t> known;
  for (const World::Window& window : w.windows) {
    const double seconds = static_cast<double>(window.end - window.begin) * kStep;
    const auto put = [&](const char* name, double v) { columns[name].push_back(v); };
    out.hidden.push_back(mean(effect, window));
    out.noise.push_back(mean(random, window));
    put("rate_deg_per_h", mean(base, window) + out.hidden.back() + out.noise.back());
    put("time_s", 0.5 * static_cast<double>(window.begin + window.end) * kStep);
    put("duration_s", seconds);
    put("rate_std_error_deg_per_h",
        noise.white / std::sqrt(seconds / 3600.0) * (1.0 + 0.05 * normal(engine)));
    put("temperature_c", mean(w.temperature, window) + 0.001 * normal(engine));
    put("temperature_rate_c_per_h",
        (w.temperature[window.end - 1] - w.temperature[window.begin]) * 3600.0 / (seconds - kStep) +
            0.03 * normal(engine));
    put("temperature_gradient_c", mean(w.gradient, window) + 0.002 * normal(engine));
    put("ambient_c", mean(w.ambient, window) + 0.01 * normal(engine));
    put("heater_w", mean(w.heater, window));
    put("field_x_ut", mean(w.hx, window) + 0.01 * normal(engine));
    put("field_y_ut", mean(w.hy, window) + 0.01 * normal(engine));
    put("field_z_ut", mean(w.hz, window) + 0.01 * normal(engine));
    put("azimuth_deg", mean(w.azimuth, window));
    const auto [it, fresh] =
        known.emplace(window.segment, static_cast<std::uint32_t>(segment.values.size()));
    if (fresh) segment.values.push_back(window.segment);
    segment.index.push_back(it->second);
  }
  for (auto& [name, values] : columns) out.table.set_column(name, std::move(values));
  out.table.set_segment(std::move(segment));
  return out;
}

}  // namespace fogbench::tests
