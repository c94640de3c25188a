#include "tests/support/foreign_effects.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

namespace fogbench::tests {
namespace {

/// One effect's equation, and what may be drawn of it.
struct Recipe {
  template <class Equation>
  Recipe(Equation its) : equation(std::move(its)) {}  // NOLINT: so that an equation is a recipe
  Recipe() = default;

  std::function<Series(const World&, const ForeignEffect&)> equation;
  double least = 0.0, most = 0.0;  ///< of the inner parameter; none where `most` is 0
  bool in_time = false;            ///< the two are shares of the record's length
  bool has_other_shape = false;
};

Recipe inner(double least, double most, Recipe recipe) {
  recipe.least = least;
  recipe.most = most;
  return recipe;
}

Recipe at_an_instant(double least, double most, Recipe recipe) {
  recipe = inner(least, most, std::move(recipe));
  recipe.in_time = true;
  return recipe;
}

Recipe also_in_another_shape(Recipe recipe) {
  recipe.has_other_shape = true;
  return recipe;
}

Series mapped(std::size_t n, const std::function<double(std::size_t)>& f) {
  Series out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = f(i);
  return out;
}

/// A recipe that needs only the state of the moment.
Recipe instant(std::function<double(const World&, const ForeignEffect&, std::size_t)> f) {
  return [f = std::move(f)](const World& w, const ForeignEffect& e) {
    return mapped(w.size(), [&](std::size_t i) { return f(w, e, i); });
  };
}

double excess(const World& w, std::size_t i) {
  return w.temperature_c[i] - kLaboratory;
}

double field(const World& w, std::size_t axis, std::size_t i) {
  return w.field_ut[axis][i] / kFieldUnit;
}

Series field(const World& w, std::size_t axis) {
  return mapped(w.size(), [&](std::size_t i) { return field(w, axis, i); });
}

Series lagged(const Series& u, double tau_s) {
  Series out(u.size());
  double state = u.front();
  for (std::size_t i = 0; i < u.size(); ++i) {
    state += (u[i] - state) * (1.0 - std::exp(-kGridStep / tau_s));
    out[i] = state;
  }
  return out;
}

Series difference(const Series& a, const Series& b) {
  return mapped(a.size(), [&](std::size_t i) { return a[i] - b[i]; });
}

Series sum(const Series& a, double share, const Series& b) {
  return mapped(a.size(), [&](std::size_t i) { return a[i] + share * b[i]; });
}

/// Friction: the state is pulled along only at a distance of `width`.
Series play(const Series& u, double width) {
  Series out(u.size());
  double state = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (u[i] - state > width) state = u[i] - width;
    if (state - u[i] > width) state = u[i] + width;
    out[i] = state;
  }
  return out;
}

/// In the manner of Duhem: per unit of travel the magnetisation relaxes towards the curve that lies
/// `width` behind the field, with a reach of `width`.
Series relaxing_loop(const Series& u, double width) {
  Series out(u.size());
  double m = 0.0, before = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double travel = u[i] - before;
    const double towards = u[i] - std::copysign(width, travel);
    m += (towards - m) * (1.0 - std::exp(-std::abs(travel) / width));
    before = u[i];
    out[i] = m;
  }
  return out;
}

Series settling(const Series& u, double tau_s) {
  return difference(u, lagged(u, tau_s));
}

Series coil_power(const World& w) {
  return mapped(w.size(), [&](std::size_t i) {
    return field(w, 0, i) * field(w, 0, i) + field(w, 1, i) * field(w, 1, i) +
           field(w, 2, i) * field(w, 2, i);
  });
}

bool other(const ForeignEffect& e) {
  return e.shape == Shape::kOther;
}

void add_thermal(std::map<std::string, Recipe>& all) {
  for (const auto& [name, power] :
       {std::pair{"linear", 1}, std::pair{"quadratic", 2}, std::pair{"cubic", 3}}) {
    all[std::string("temperature_") + name] =
        instant([power = power](const World& w, const ForeignEffect&, std::size_t i) {
          return std::pow(excess(w, i), power);
        });
  }
  all["temperature_rate"] = [](const World& w, const ForeignEffect&) { return w.rate_c_per_h; };
  all["temperature_rate_lagged"] =
      also_in_another_shape(inner(60.0, 900.0, [](const World& w, const ForeignEffect& e) {
        if (other(e)) return lagged(lagged(w.rate_c_per_h, e.inner / 2.0), e.inner / 2.0);
        return lagged(w.rate_c_per_h, e.inner);
      }));
  all["temperature_acceleration"] =
      instant([](const World& w, const ForeignEffect&, std::size_t i) {
        const double before = i > 0 ? w.rate_c_per_h[i - 1] : 0.0;
        return (w.rate_c_per_h[i] - before) * 3600.0 / kGridStep;
      });
  all["temperature_rate_cross"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return excess(w, i) * w.rate_c_per_h[i];
  });
  all["temperature_gradient"] = [](const World& w, const ForeignEffect&) { return w.gradient_c; };
  all["temperature_gradient_rate"] =
      instant([](const World& w, const ForeignEffect&, std::size_t i) {
        const double before = i > 0 ? w.gradient_c[i - 1] : 0.0;
        return (w.gradient_c[i] - before) * 3600.0 / kGridStep;
      });
  all["temperature_hysteresis"] =
      also_in_another_shape(inner(1.0, 6.0, [](const World& w, const ForeignEffect& e) {
        const Series t = mapped(w.size(), [&](std::size_t i) { return excess(w, i); });
        if (!other(e)) return play(t, e.inner);
        return sum(sum(play(t, 0.3 * e.inner), 1.0, play(t, e.inner)), 1.0, play(t, 2.5 * e.inner));
      }));
  all["temperature_ripple"] =
      inner(2.5, 9.0, instant([](const World& w, const ForeignEffect& e, std::size_t i) {
              return std::sin(2.0 * std::numbers::pi * excess(w, i) / e.inner + e.phase);
            }));
  all["heater_power"] = [](const World& w, const ForeignEffect&) { return w.heater_w; };
  all["ambient_temperature"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return w.ambient_c[i] - kLaboratory;
  });
}

void add_timed(std::map<std::string, Recipe>& all) {
  all["bias"] = instant([](const World&, const ForeignEffect&, std::size_t) { return 1.0; });
  all["bias_step"] = also_in_another_shape(
      at_an_instant(0.15, 0.85, instant([](const World&, const ForeignEffect& e, std::size_t i) {
                      const double since = World::time_s(i) - e.inner;
                      if (other(e)) return std::clamp(since / 120.0, 0.0, 1.0);
                      return since >= 0.0 ? 1.0 : 0.0;
                    })));
  all["drift_linear"] = instant(
      [](const World&, const ForeignEffect&, std::size_t i) { return World::time_s(i) / 3600.0; });
  all["warm_up"] = also_in_another_shape(inner(
      600.0, 3600.0, instant([](const World&, const ForeignEffect& e, std::size_t i) {
        const double t = World::time_s(i);
        return std::exp(-t / e.inner) + (other(e) ? 0.5 * std::exp(-t / (4.0 * e.inner)) : 0.0);
      })));
  all["earth_rate_projection"] = instant([](const World& w, const ForeignEffect& e, std::size_t i) {
    return std::cos(w.azimuth_deg[i] * std::numbers::pi / 180.0 - e.phase);
  });
  all["coil_heating"] =
      also_in_another_shape(inner(600.0, 5400.0, [](const World& w, const ForeignEffect& e) {
        if (other(e)) return lagged(lagged(coil_power(w), e.inner / 2.0), e.inner / 2.0);
        return lagged(coil_power(w), e.inner);
      }));
}

void add_magnetic(std::map<std::string, Recipe>& all) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t next = (axis + 1) % 3;
    const std::string end{'_', "xyz"[axis]};
    all["magnetic_linear" + end] = [=](const World& w, const ForeignEffect&) {
      return field(w, axis);
    };
    all["magnetic_quadratic" + end] =
        instant([=](const World& w, const ForeignEffect&, std::size_t i) {
          return field(w, axis, i) * field(w, axis, i);
        });
    all["magnetic_cross" + end + "xyz"[next]] =
        instant([=](const World& w, const ForeignEffect&, std::size_t i) {
          return field(w, axis, i) * field(w, next, i);
        });
    all["magnetic_saturation" + end] = also_in_another_shape(
        inner(0.7, 2.5, instant([=](const World& w, const ForeignEffect& e, std::size_t i) {
                const double x = field(w, axis, i) / e.inner;
                return other(e) ? x / std::sqrt(1.0 + x * x) : std::tanh(x);
              })));
    all["magnetic_hysteresis" + end] =
        also_in_another_shape(inner(0.25, 1.2, [=](const World& w, const ForeignEffect& e) {
          return other(e) ? relaxing_loop(field(w, axis), e.inner) : play(field(w, axis), e.inner);
        }));
    all["magnetic_settling" + end] =
        also_in_another_shape(inner(40.0, 240.0, [=](const World& w, const ForeignEffect& e) {
          const Series h = field(w, axis);
          if (!other(e)) return settling(h, e.inner);
          return sum(settling(h, e.inner / 2.0), 0.5, settling(h, 2.0 * e.inner));
        }));
    all["magnetic_temperature" + end] =
        instant([=](const World& w, const ForeignEffect&, std::size_t i) {
          return field(w, axis, i) * excess(w, i);
        });
    all["magnetic_temperature_rate" + end] =
        instant([=](const World& w, const ForeignEffect&, std::size_t i) {
          return field(w, axis, i) * w.rate_c_per_h[i];
        });
  }
}

void add_outside(std::map<std::string, Recipe>& all) {
  all["outside_sqrt_field_z"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return std::sqrt(std::abs(field(w, 2, i)));
  });
  all["outside_one_sided_x"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return std::max(0.0, field(w, 0, i));
  });
  all["outside_direction_cube_y"] = [](const World& w, const ForeignEffect&) {
    const Series h = field(w, 1);
    double going = 1.0;
    return mapped(w.size(), [&](std::size_t i) {
      if (i > 0 && h[i] != h[i - 1]) going = h[i] > h[i - 1] ? 1.0 : -1.0;
      return going * h[i] * h[i] * h[i];
    });
  };
  all["outside_sine_field_z"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return std::sin(2.0 * std::numbers::pi * field(w, 2, i) / 1.9);
  });
  all["outside_pulse"] =
      at_an_instant(0.15, 0.65, instant([](const World& w, const ForeignEffect& e, std::size_t i) {
                      const double lasts = 0.2 * World::time_s(w.size());
                      const double since = World::time_s(i) - e.inner;
                      return since >= 0.0 && since < lasts ? 1.0 : 0.0;
                    }));
  all["outside_temperature_kink"] =
      instant([](const World& w, const ForeignEffect&, std::size_t i) {
        return std::abs(excess(w, i) - 17.0);
      });
  all["outside_rate_squared"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return w.rate_c_per_h[i] * w.rate_c_per_h[i];
  });
  all["outside_heating_only"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return std::max(0.0, w.rate_c_per_h[i]);
  });
  all["outside_field_times_gradient_z"] =
      instant([](const World& w, const ForeignEffect&, std::size_t i) {
        return field(w, 2, i) * field(w, 2, i) * w.gradient_c[i];
      });
  all["outside_bias_per_orientation"] =
      instant([](const World& w, const ForeignEffect&, std::size_t i) {
        return std::cos(3.0 * w.azimuth_deg[i] * std::numbers::pi / 180.0);
      });
}

/// Effects that are also far from the usual suspects (powers, roots, signs, sines of one signal).
void add_unusual(std::map<std::string, Recipe>& all) {
  all["outside_dead_zone_y"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    const double h = field(w, 1, i);
    return std::copysign(std::max(0.0, std::abs(h) - 1.6), h);
  });
  all["outside_ageing_scale_x"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return field(w, 0, i) * World::time_s(i) / 3600.0;
  });
  all["outside_exponential_field_z"] =
      instant([](const World& w, const ForeignEffect&, std::size_t i) {
        return std::exp(field(w, 2, i) / 1.2);
      });
  all["outside_sine_in_time"] =
      inner(2400.0, 7200.0, instant([](const World&, const ForeignEffect& e, std::size_t i) {
              return std::sin(2.0 * std::numbers::pi * World::time_s(i) / e.inner + e.phase);
            }));
  all["outside_creep"] = instant([](const World&, const ForeignEffect&, std::size_t i) {
    return std::log1p(World::time_s(i) / 120.0);
  });
  all["outside_two_pulses"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    const double share = static_cast<double>(i) / static_cast<double>(w.size());
    const bool first = share > 0.2 && share<0.3, second = share> 0.6 && share < 0.7;
    return first || second ? 1.0 : 0.0;
  });
  all["outside_thermal_switch"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return w.temperature_c[i] > 42.0 ? 1.0 : 0.0;
  });
  all["outside_root_of_excess"] = instant([](const World& w, const ForeignEffect&, std::size_t i) {
    return std::sqrt(std::max(0.0, excess(w, i)));
  });
}

const std::map<std::string, Recipe>& recipes() {
  static const std::map<std::string, Recipe> all = [] {
    std::map<std::string, Recipe> made;
    add_thermal(made);
    add_timed(made);
    add_magnetic(made);
    add_outside(made);
    add_unusual(made);
    return made;
  }();
  return all;
}

}  // namespace

std::vector<std::string> other_shapes() {
  std::vector<std::string> out;
  for (const auto& [id, recipe] : recipes()) {
    if (recipe.has_other_shape) out.push_back(id);
  }
  return out;
}

std::vector<std::string> outside_effects() {
  std::vector<std::string> out;
  for (const auto& [id, recipe] : recipes()) {
    if (id.starts_with("outside_")) out.push_back(id);
  }
  return out;
}

Series regressor(const World& world, const ForeignEffect& effect) {
  const auto recipe = recipes().find(effect.id);
  assert(recipe != recipes().end());
  return recipe->second.equation(world, effect);
}

ForeignEffect drawn_effect(const std::string& id, Shape shape, const World& world,
                           std::mt19937_64& engine) {
  ForeignEffect effect{.id = id, .shape = shape};
  std::uniform_real_distribution<> uniform;
  const double share = uniform(engine);
  const auto found = recipes().find(id);
  assert(found != recipes().end());
  const Recipe& recipe = found->second;
  if (recipe.in_time) {
    const double at = recipe.least + share * (recipe.most - recipe.least);
    effect.inner = at * World::time_s(world.size());
  } else if (recipe.most > 0.0) {
    effect.inner = recipe.least * std::pow(recipe.most / recipe.least, share);
  }
  effect.phase = 2.0 * std::numbers::pi * uniform(engine);
  effect.amplitude = uniform(engine) < 0.5 ? -1.0 : 1.0;
  return effect;
}

}  // namespace fogbench::tests
