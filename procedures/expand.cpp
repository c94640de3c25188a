#include "procedures/expand.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "config/nearest_name.hpp"
#include "procedures/branches.hpp"

namespace fogbench::procedures {
namespace {

using config::Number;
using config::NumberList;
using config::ParameterValue;
using config::ProcedureConfig;

std::string location(const ProcedureConfig& procedure, const std::string& pointer) {
  const std::string file =
      procedure.file.empty() ? procedure.name : procedure.file.filename().string();
  return file + ": " + pointer;
}

std::string names_of(const Parameters& parameters) {
  std::vector<std::string> names;
  for (const auto& [name, value] : parameters) names.push_back(name);
  return names.empty() ? "it has none" : fmt::format("known: {}", fmt::join(names, ", "));
}

/// The procedure's defaults with `given` in their place. A single number stands for a list of one.
/// What it passes on to others it knows only when it is given.
Result<Parameters> bind_parameters(const ProcedureConfig& procedure, const Parameters& given,
                                   const std::string& where) {
  Parameters bound = procedure.parameters;
  const std::vector<std::string> passed = config::passed_parameters(procedure);
  for (const auto& [name, value] : given) {
    const auto found = bound.find(name);
    if (found == bound.end() && std::binary_search(passed.begin(), passed.end(), name)) {
      bound.emplace(name, value);
      continue;
    }
    if (found == bound.end()) {
      Parameters known = procedure.parameters;
      for (const std::string& one : passed) known.emplace(one, 0.0);
      std::vector<std::string_view> names;
      for (const auto& parameter : known) names.push_back(parameter.first);
      return config::bad_input(fmt::format("{}: procedure {} has no parameter \"{}\" ({}){}", where,
                                           procedure.name, name, names_of(known),
                                           config::did_you_mean(name, names)));
    }
    const bool wants_list = std::holds_alternative<std::vector<double>>(found->second);
    const bool is_list = std::holds_alternative<std::vector<double>>(value);
    if (is_list && !wants_list) {
      return config::bad_input(
          fmt::format("{}: parameter \"{}\" of {} is a list, expected one number", where, name,
                      procedure.name));
    }
    if (wants_list && !is_list) {
      found->second = std::vector<double>{std::get<double>(value)};
    } else {
      found->second = value;
    }
  }
  return bound;
}

struct Place {
  const ProcedureConfig* procedure;
  Parameters parameters;
  std::vector<std::string> chain;  ///< procedures being called, outermost first
  int test = 1;
  int block = 0;
  bool outermost = true;  ///< each step, or turn of a loop, is a phase of its own
};

class Expander {
 public:
  Expander(const ProcedureLoader& loader, std::vector<Error>& problems)
      : loader_(loader), problems_(problems) {}

  void expand_all(const std::vector<config::Step>& steps, const Place& place,
                  const std::string& prefix) {
    for (std::size_t i = 0; i < steps.size() && !stopped_; ++i) {
      if (place.outermost) begin_phase("");
      expand_one(steps[i], place, prefix + std::to_string(i + 1));
    }
  }

  std::vector<PlannedStep> take() { return std::move(steps_); }

 private:
  void expand_one(const config::Step& step, const Place& place, const std::string& path) {
    where_ = location(*place.procedure, step.pointer);
    place_ = &place;
    failure_.reset();
    const std::size_t before = steps_.size();
    // Steps that leave nothing in the plan are counted too, or loops of them would never end.
    const auto status =
        ++expanded_ > kMaximumSteps
            ? too_many()
            : std::visit([&](const auto& action) { return add(action, path); }, step.action);
    // Steps within this one have said for themselves what is wrong with them.
    if (failure_) steps_.resize(before);
    if (failure_) note(*failure_);
    if (!status) note(status.error());
    failure_.reset();
  }

  /// In a loop the same is wrong at every turn.
  void note(const Error& problem) {
    const bool known = std::any_of(problems_.begin(), problems_.end(), [&](const Error& other) {
      return other.message == problem.message;
    });
    if (!known) problems_.push_back(problem);
  }

  void begin_phase(std::string says) {
    ++phase_;
    phase_says_ = std::move(says);
  }

  // A wrong number is remembered and reported once the step is built, so that each step below reads
  // as what it is.
  double number(const Number& number, const char* what) {
    const auto value = resolve(number);
    if (!value) return fail(value.error());
    if (!std::isfinite(*value))
      return fail(config::bad_input(fmt::format("{}: {} is not finite", where_, what)));
    return *value;
  }
  double positive(const Number& n, const char* what) {
    const double value = number(n, what);
    if (!failure_ && value <= 0) {
      return fail(config::bad_input(
          fmt::format("{}: {} is {}, expected more than 0", where_, what, value)));
    }
    return value;
  }
  double not_negative(const Number& n, const char* what) {
    const double value = number(n, what);
    if (!failure_ && value < 0) {
      return fail(
          config::bad_input(fmt::format("{}: {} is {}, expected 0 or more", where_, what, value)));
    }
    return value;
  }
  double fail(Error error) {
    if (!failure_) failure_ = std::move(error);
    return 1.0;
  }

  Result<ParameterValue> look_up(const std::string& reference) const {
    const std::string name = reference.starts_with('$') ? reference.substr(1) : reference;
    const auto found = place_->parameters.find(name);
    if (found == place_->parameters.end()) {
      return config::bad_input(
          fmt::format("{}: no parameter \"{}\" ({})", where_, name, names_of(place_->parameters)));
    }
    return found->second;
  }
  Result<double> resolve(const Number& number) const {
    if (const double* value = std::get_if<double>(&number)) return *value;
    const auto& reference = std::get<std::string>(number);
    const auto value = look_up(reference);
    if (!value) return value.error();
    if (const double* one = std::get_if<double>(&*value)) return *one;
    return config::bad_input(
        fmt::format("{}: {} is a list, expected one number", where_, reference));
  }
  Result<std::vector<double>> resolve(const config::NumberRange& range) const {
    const auto from = resolve(range.from);
    if (!from) return from.error();
    const auto to = resolve(range.to);
    if (!to) return to.error();
    const auto step = resolve(range.step);
    if (!step) return step.error();
    auto values = config::range_values(*from, *to, *step);
    if (!values) return config::bad_input(fmt::format("{}: {}", where_, values.error().message));
    return values;
  }
  Result<std::vector<double>> resolve(const NumberList& list) const {
    if (const auto* values = std::get_if<std::vector<double>>(&list)) return *values;
    if (const auto* range = std::get_if<config::NumberRange>(&list)) return resolve(*range);
    const auto& reference = std::get<std::string>(list);
    const auto value = look_up(reference);
    if (!value) return value.error();
    if (const auto* values = std::get_if<std::vector<double>>(&*value)) return *values;
    return config::bad_input(
        fmt::format("{}: {} is one number, expected a list", where_, reference));
  }

  Status too_many() {
    stopped_ = true;
    return config::bad_input(
        fmt::format("{}: the procedure expands to more than {} steps", where_, kMaximumSteps));
  }

  template <class Action>
  Status append(Action action, const std::string& path, int block) {
    if (steps_.size() >= kMaximumSteps) return too_many();
    PlannedStep step;
    step.action = std::move(action);
    step.path = path;
    step.where = where_;
    step.test = place_->test;
    step.block = block;
    step.phase = phase_;
    step.phase_says = phase_says_;
    steps_.push_back(std::move(step));
    return {};
  }
  template <class Action>
  Status append(Action action, const std::string& path) {
    return append(std::move(action), path, place_->block);
  }

  Status add(const config::SetTemperature& s, const std::string& path) {
    const bool heated = s.mode != HeatingMode::kOff;
    return append(SetTemperature{Celsius{heated ? number(s.target_c, "target_c") : 0.0}, s.mode},
                  path);
  }
  Status add(const config::Ramp& s, const std::string& path) {
    Ramp ramp{Celsius{number(s.to_c, "to_c")},
              CelsiusPerHour{positive(s.rate_c_per_h, "rate_c_per_h")}, s.mode, s.segment,
              Seconds{positive(s.window_s, "window_s")}};
    if (!s.settle || failure_) return append(std::move(ramp), path);
    const auto appended = append(std::move(ramp), path + ".1");
    if (!appended) return appended;
    return add(config::SettleTemperature{.segment = s.segment, .window_s = s.window_s},
               path + ".2");
  }
  Status add(const config::SettleTemperature& s, const std::string& path) {
    SettleTemperature settle{Celsius{positive(s.band_c, "band_c")},
                             Seconds{not_negative(s.dwell_s, "dwell_s")},
                             positive(s.slope_c_per_h, "slope_c_per_h"),
                             Seconds{positive(s.timeout_s, "timeout_s")},
                             s.segment,
                             Seconds{positive(s.window_s, "window_s")}};
    if (!failure_ && settle.timeout <= settle.dwell) {
      return config::bad_input(fmt::format("{}: timeout_s is {}, expected more than dwell_s ({})",
                                           where_, settle.timeout.count(), settle.dwell.count()));
    }
    return append(std::move(settle), path);
  }
  Status add(const config::Wait& s, const std::string& path) {
    Wait wait{Seconds{not_negative(s.duration_s, "duration_s")},
              Seconds{not_negative(s.operating_time_s, "operating_time_s")}, s.segment,
              Seconds{positive(s.window_s, "window_s")}};
    // A parameter of 0 leaves the wait out.
    if (wait.duration.count() == 0.0 && wait.operating_time.count() == 0.0) return {};
    return append(std::move(wait), path);
  }
  Status add(const config::Average& s, const std::string& path) {
    return append(Average{Seconds{positive(s.duration_s, "duration_s")}, s.segment, false}, path);
  }
  Status add(const config::Baseline& s, const std::string& path) {
    return append(Average{Seconds{positive(s.duration_s, "duration_s")}, s.segment, true}, path);
  }
  Status add(const config::CompensateField& s, const std::string& path) {
    return append(CompensateField{Microtesla{positive(s.tolerance_ut, "tolerance_ut")}}, path);
  }
  Status add(const config::Sweep& s, const std::string& path) {
    const auto levels = resolve(s.levels_ut);
    if (!levels) return levels.error();
    if (levels->empty()) {
      return config::bad_input(
          fmt::format("{}: levels_ut is empty, expected one level or more", where_));
    }
    if (s.segment.find('/') != std::string::npos) {
      return config::bad_input(fmt::format(
          "{}: segment is \"{}\", expected no '/': the branch is appended", where_, s.segment));
    }
    const Seconds duration{positive(s.duration_s, "duration_s")};
    const Seconds settle{not_negative(s.settle_s, "settle_s")};
    const Microtesla other_pair{number(s.other_pair_ut, "other_pair_ut")};
    const auto branches = branch_names(*levels);
    const int block = place_->block != 0 ? place_->block : ++blocks_;
    for (std::size_t i = 0; i < levels->size(); ++i) {
      const double level = number((*levels)[i], "a level of levels_ut");
      const auto appended = append(
          SweepLevel{s.axis, Microtesla{level}, duration, settle,
                     s.segment.empty() ? branches[i] : s.segment + "/" + branches[i], other_pair},
          path + "." + std::to_string(i + 1), block);
      if (!appended) return appended;
    }
    return {};
  }
  Status add(const config::Rotate& s, const std::string& path) {
    return append(Rotate{Degree{number(s.azimuth_deg, "azimuth_deg")}}, path);
  }
  Status add(const config::Prompt& s, const std::string& path) {
    return append(Prompt{s.text}, path);
  }

  Status add(const config::ForEach& s, const std::string& path) {
    const auto values = resolve(s.in);
    if (!values) return values.error();
    Place inner = *place_;
    inner.outermost = false;
    const bool outermost = place_->outermost;
    for (std::size_t turn = 0; turn < values->size() && !stopped_; ++turn) {
      inner.parameters[s.variable] = (*values)[turn];
      if (outermost) begin_phase(fmt::format("{} {}", s.variable, (*values)[turn]));
      expand_all(s.steps, inner, turn_of(path, turn));
    }
    return {};
  }
  Status add(const config::Repeat& s, const std::string& path) {
    const double times = not_negative(s.times, "times");
    if (failure_) return {};
    if (times != std::floor(times) || times > static_cast<double>(kMaximumSteps)) {
      return config::bad_input(fmt::format("{}: times is {}, expected a whole number, {} at most",
                                           where_, times, kMaximumSteps));
    }
    Place inner = *place_;
    inner.outermost = false;
    const bool outermost = place_->outermost;
    for (std::size_t turn = 0; static_cast<double>(turn) < times && !stopped_; ++turn) {
      if (outermost) begin_phase(fmt::format("turn {} of {}", turn + 1, times));
      expand_all(s.steps, inner, turn_of(path, turn));
    }
    return {};
  }
  Status add(const config::Indivisible& s, const std::string& path) {
    Place inner = *place_;
    inner.outermost = false;
    if (inner.block == 0) inner.block = ++blocks_;
    if (place_->outermost) begin_phase("indivisible");
    expand_all(s.steps, inner, path + ".");
    return {};
  }
  Status add(const config::Call& s, const std::string& path) {
    const std::string where = where_;
    const auto called = loader_(s.procedure, *place_->procedure);
    if (!called) return config::bad_input(fmt::format("{}: {}", where, called.error().message));
    Place inner = *place_;
    inner.chain.push_back(called->name);
    for (const std::string& outer : place_->chain) {
      if (outer == called->name) {
        return config::bad_input(fmt::format("{}: {} calls itself: {}", where, called->name,
                                             fmt::join(inner.chain, " -> ")));
      }
    }
    Parameters given;
    for (const std::string& name : s.pass) {
      if (s.parameters.contains(name)) {
        return config::bad_input(
            fmt::format("{}: \"{}\" stands in parameters and in pass", where, name));
      }
      if (!called->parameters.contains(name) && !passes(*called, name)) {
        return config::bad_input(
            fmt::format("{}: procedure {} has no parameter \"{}\" to pass ({})", where,
                        called->name, name, names_of(called->parameters)));
      }
      const auto own = place_->parameters.find(name);
      if (own != place_->parameters.end()) given[name] = own->second;
    }
    for (const auto& [name, argument] : s.parameters) {
      auto value = std::visit([this](const auto& a) { return value_of(a); }, argument);
      if (!value) return value.error();
      given[name] = std::move(*value);
    }
    auto bound = bind_parameters(*called, given, where);
    if (!bound) return bound.error();
    inner.procedure = &*called;
    inner.parameters = std::move(*bound);
    inner.outermost = false;
    if (s.test != 0) inner.test = s.test;
    if (place_->outermost) {
      begin_phase(called->name + (s.test != 0 ? fmt::format(", test {}", s.test) : ""));
    }
    expand_all(called->steps, inner, path + ".");
    return {};
  }

  static std::string turn_of(const std::string& path, std::size_t turn) {
    return path + "." + std::to_string(turn + 1) + ".";
  }
  static bool passes(const ProcedureConfig& procedure, const std::string& name) {
    const auto passed = config::passed_parameters(procedure);
    return std::binary_search(passed.begin(), passed.end(), name);
  }
  Result<ParameterValue> value_of(double number) const { return ParameterValue{number}; }
  Result<ParameterValue> value_of(const std::vector<double>& list) const {
    return ParameterValue{list};
  }
  Result<ParameterValue> value_of(const std::string& reference) const { return look_up(reference); }
  Result<ParameterValue> value_of(const config::NumberRange& range) const {
    auto values = resolve(range);
    if (!values) return values.error();
    return ParameterValue{std::move(*values)};
  }

  const ProcedureLoader& loader_;
  std::vector<Error>& problems_;
  std::vector<PlannedStep> steps_;
  std::size_t expanded_ = 0;
  int blocks_ = 0;
  int phase_ = 0;
  std::string phase_says_;
  bool stopped_ = false;
  // Of the step being expanded.
  std::string where_;
  const Place* place_ = nullptr;
  std::optional<Error> failure_;
};

}  // namespace

Result<std::vector<PlannedStep>> expand(const ProcedureConfig& procedure,
                                        const Parameters& overrides,
                                        const ProcedureLoader& loader) {
  std::vector<Error> problems;
  auto steps = expand(procedure, overrides, loader, problems);
  if (!problems.empty()) return std::move(problems.front());
  return steps;
}

std::vector<PlannedStep> expand(const ProcedureConfig& procedure, const Parameters& overrides,
                                const ProcedureLoader& loader, std::vector<Error>& problems) {
  auto parameters = bind_parameters(procedure, overrides, location(procedure, "/parameters"));
  if (!parameters) {
    problems.push_back(parameters.error());
    parameters = procedure.parameters;
  }
  Expander expander(loader, problems);
  expander.expand_all(procedure.steps, {&procedure, std::move(*parameters), {procedure.name}}, "");
  return expander.take();
}

}  // namespace fogbench::procedures
