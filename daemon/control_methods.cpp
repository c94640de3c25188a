#include "daemon/control_methods.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>
#include <variant>

#include "daemon/desk_json.hpp"
#include "daemon/metrics.hpp"
#include "daemon/parameters_json.hpp"
#include "daemon/session.hpp"
#include "record/run_log.hpp"

namespace fogbench::daemon {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using Outcome = std::variant<ordered_json, RpcError>;

constexpr auto kRunExpected = "/params/run: expected a run's number, from 1 on";

RpcError invalid(const std::string& says) {
  return {RpcCode::kInvalidParams, says};
}

/// A person's action is in the log before anything comes of it.
Person person_of(const Caller& caller, const std::string& does) {
  Person person{user_name(caller.uid), caller.uid};
  spdlog::info("{} (uid {}): {}", person.name, person.uid, does);
  return person;
}

Outcome done(const RunDesk::Refused& refused) {
  if (refused) return *refused;
  return ordered_json::object();
}

/// Null when there is no such whole number from 1 on.
std::optional<std::uint64_t> number_of(const json& params, const char* key) {
  const auto value = params.find(key);
  if (value == params.end() || !value->is_number_unsigned()) return std::nullopt;
  const auto number = value->get<std::uint64_t>();
  return number > 0 ? std::optional(number) : std::nullopt;
}

/// The run that the parameters name; null when there can be none of that number.
std::optional<std::int64_t> run_of(const json& params) {
  const auto run = number_of(params, "run");
  constexpr auto kLargest = std::numeric_limits<std::int64_t>::max();
  if (!run || *run > static_cast<std::uint64_t>(kLargest)) return std::nullopt;
  return static_cast<std::int64_t>(*run);
}

Outcome status(RunDesk& desk, const json&) {
  return to_json(desk.view());
}

Outcome queue(RunDesk& desk, const json&) {
  const DeskView view = desk.view();
  return ordered_json{
      {"held", view.held()}, {"because", view.held_because}, {"jobs", to_json(desk.queue())}};
}

Outcome runs(RunDesk& desk, const json&) {
  return ordered_json{{"runs", to_json(desk.ended_runs())}};
}

Outcome watch(const json& params, Caller& caller) {
  constexpr double kShortest = 0.1, kLongest = 3600.0;
  constexpr std::size_t kLongestTemplate = 2048;
  Subscription subscription;
  double every_s = 1.0;
  if (const auto every = params.find("every_s"); every != params.end()) {
    every_s = every->is_number() ? every->get<double>() : 0.0;
  }
  if (!(every_s >= kShortest && every_s <= kLongest)) {
    return invalid("/params/every_s: expected a number from 0.1 to 3600");
  }
  subscription.every = drivers::from_seconds(every_s);
  if (const auto pattern = params.find("template"); pattern != params.end()) {
    subscription.pattern_json = pattern->dump();
    if (subscription.pattern_json.size() > kLongestTemplate) {
      return invalid(fmt::format("/params/template: expected at most {} bytes", kLongestTemplate));
    }
  }
  caller.subscription = std::move(subscription);
  return ordered_json::object();
}

RpcError refusal(const Error& error) {
  const RpcCode code = error.code == ErrorCode::kLimit   ? RpcCode::kLimit
                       : error.code == ErrorCode::kStore ? RpcCode::kStore
                                                         : RpcCode::kBadInput;
  return {code, error.message};
}

Outcome enqueue(RunDesk& desk, const Setup& setup, const std::filesystem::path& store, Order order,
                const Caller& caller) {
  auto planned = plan_order(order, setup, store, {caller.uid, caller.groups});
  if (!planned) return refusal(planned.error());
  const Person by = person_of(
      caller, order.takes_up != 0 ? fmt::format("resume run {}", order.takes_up)
                                  : fmt::format("run {}{}", planned->plan.procedure,
                                                order.gyro.empty() ? "" : ", gyro " + order.gyro));
  ordered_json answer{{"steps", planned->plan.steps.size()},
                      {"estimate_s", planned->plan.estimate.count()},
                      {"gyro", planned->gyro}};
  const auto queued = desk.enqueue(std::move(order), std::move(*planned), by);
  if (const auto* refused = std::get_if<RpcError>(&queued)) return *refused;
  answer["job"] = std::get<std::uint64_t>(queued);
  const DeskView view = desk.view();
  answer["held"] = view.held();
  answer["because"] = view.held_because;
  return answer;
}

/// `name`, which may be left out; null when it is no truth value.
std::optional<bool> flag_of(const json& params, const char* name) {
  const auto value = params.find(name);
  if (value == params.end()) return false;
  return value->is_boolean() ? std::optional(value->get<bool>()) : std::nullopt;
}

/// Since when a person says that the gyro is on; nothing where he does not.
std::variant<std::optional<SwitchedOn>, RpcError> switched_on_of(const json& params,
                                                                 const Caller& caller) {
  const auto since = params.find("gyro_on_since");
  if (since == params.end()) return std::optional<SwitchedOn>();
  const double unix_s =
      since->is_string() ? drivers::seconds_of_utc(since->get<std::string>()) : std::nan("");
  if (!std::isfinite(unix_s)) {
    return invalid("/params/gyro_on_since: expected a time such as 2026-11-29T18:00:00Z");
  }
  return std::optional<SwitchedOn>({unix_s, user_name(caller.uid)});
}

/// What the parameters of `run` ask for.
std::variant<Order, RpcError> order_of(const json& params, const Caller& caller) {
  const auto name = params.find("procedure");
  if (name == params.end() || !name->is_string()) {
    return invalid("/params/procedure: expected a procedure's name, or its file's full path");
  }
  const auto set = params.find("set");
  const auto parameters = set == params.end() ? Parameters{} : parameters_of(*set);
  if (!parameters) {
    return invalid("/params/set: expected {\"name\": number or [number, number...]}");
  }
  Order order{name->get<std::string>(), *parameters};
  if (const auto gyro = params.find("gyro"); gyro != params.end()) {
    if (!gyro->is_string() || !is_serial_number(gyro->get_ref<const std::string&>())) {
      return invalid(fmt::format("/params/gyro: expected {}", kSerialNumberRule));
    }
    order.gyro = gyro->get<std::string>();
  }
  const auto keep_going = flag_of(params, "keep_going");
  if (!keep_going) return invalid("/params/keep_going: expected true or false");
  order.keep_going = *keep_going;
  const auto since = switched_on_of(params, caller);
  if (const auto* refused = std::get_if<RpcError>(&since)) return *refused;
  order.switched_on = std::get<std::optional<SwitchedOn>>(since);
  return order;
}

/// Nobody else fills the queue meanwhile: that is this thread's.
Outcome discard_run(RunDesk& desk, const std::filesystem::path& store, std::int64_t run,
                    const Caller& caller) {
  if (const auto refused = desk.may_discard(run)) return *refused;
  const Person by = person_of(caller, fmt::format("discard run {}", run));
  const auto log = record::RunLog::open(store);
  if (!log) return refusal(log.error());
  const Status given_up = (*log)->give_up(run, "given up by " + by.name);
  if (!given_up) return refusal(given_up.error());
  desk.withdraw_offer(run);
  desk.happened("info", fmt::format("run {} given up, by {}", run, by.name));
  return ordered_json::object();
}

}  // namespace

struct ControlMethods::Method {
  std::string_view name;
  Role role;
  /// Every other parameter is refused: a typing error must not pass for consent.
  std::vector<std::string_view> params;
  std::function<Outcome(ControlMethods& self, const json& params, Caller& caller)> call;
};

const ControlMethods::Method* ControlMethods::find(const std::string& name) {
  using Self = ControlMethods;
  static const std::vector<Method> kMethods{
      {"hello",
       Role::kObserver,
       {},
       [](Self& self, const json&, Caller& caller) -> Outcome {
         std::error_code ignored;
         return ordered_json{{"protocol", kProtocolVersion},
                             {"version", FOGBENCH_VERSION},
                             {"bench", self.setup_.bench.name},
                             {"store", std::filesystem::absolute(self.store_, ignored).string()},
                             {"user", user_name(caller.uid)},
                             {"role", name_of(caller.role)}};
       }},
      {"status",
       Role::kObserver,
       {},
       [](Self& self, const json& params, Caller&) { return status(self.desk_, params); }},
      {"queue",
       Role::kObserver,
       {},
       [](Self& self, const json& params, Caller&) { return queue(self.desk_, params); }},
      {"runs",
       Role::kObserver,
       {},
       [](Self& self, const json& params, Caller&) { return runs(self.desk_, params); }},
      {"metrics",
       Role::kObserver,
       {},
       [](Self& self, const json&, Caller&) -> Outcome {
         return ordered_json{{"text", self.metrics()}};
       }},
      {"watch",
       Role::kObserver,
       {"every_s", "template"},
       [](Self&, const json& params, Caller& caller) { return watch(params, caller); }},
      {"unwatch",
       Role::kObserver,
       {},
       [](Self&, const json&, Caller& caller) -> Outcome {
         caller.subscription.reset();
         return ordered_json::object();
       }},
      {"run",
       Role::kOperator,
       {"procedure", "set", "gyro", "keep_going", "gyro_on_since"},
       [](Self& self, const json& params, Caller& caller) -> Outcome {
         auto order = order_of(params, caller);
         if (const auto* refused = std::get_if<RpcError>(&order)) return *refused;
         return enqueue(self.desk_, self.setup_, self.store_, std::get<Order>(std::move(order)),
                        caller);
       }},
      {"remove",
       Role::kOperator,
       {"job"},
       [](Self& self, const json& params, Caller& caller) -> Outcome {
         const auto job = number_of(params, "job");
         if (!job) return invalid("/params/job: expected a job's number");
         const Person by = person_of(caller, fmt::format("remove job {}", *job));
         return done(self.desk_.remove(*job, by));
       }},
      {"move",
       Role::kOperator,
       {"job", "to"},
       [](Self& self, const json& params, Caller& caller) -> Outcome {
         const auto job = number_of(params, "job"), to = number_of(params, "to");
         if (!job) return invalid("/params/job: expected a job's number");
         if (!to) return invalid("/params/to: expected a place in the queue, from 1 on");
         const Person by = person_of(caller, fmt::format("move job {} to place {}", *job, *to));
         return done(self.desk_.move(*job, *to, by));
       }},
      {"pause",
       Role::kOperator,
       {},
       [](Self& self, const json&, Caller& caller) -> Outcome {
         if (const auto refused = self.desk_.pause(person_of(caller, "pause"))) return *refused;
         const auto run = self.desk_.view().run;
         return ordered_json{{"after_run", run && run->pauses_after}};
       }},
      {"hold",
       Role::kOperator,
       {},
       [](Self& self, const json&, Caller& caller) {
         return done(self.desk_.hold(person_of(caller, "hold the queue")));
       }},
      {"resume",
       Role::kOperator,
       {"run", "gyro_on_since"},
       [](Self& self, const json& params, Caller& caller) -> Outcome {
         const auto since = switched_on_of(params, caller);
         if (const auto* refused = std::get_if<RpcError>(&since)) return *refused;
         const auto& switched_on = std::get<std::optional<SwitchedOn>>(since);
         if (!params.contains("run")) {
           return done(self.desk_.resume(person_of(caller, "resume"), switched_on));
         }
         const auto run = run_of(params);
         if (!run) return invalid(kRunExpected);
         Order order{{}, {}, *run};
         order.switched_on = switched_on;
         return enqueue(self.desk_, self.setup_, self.store_, std::move(order), caller);
       }},
      {"discard",
       Role::kOperator,
       {"run"},
       [](Self& self, const json& params, Caller& caller) -> Outcome {
         const auto run = run_of(params);
         if (!run) return invalid(kRunExpected);
         return discard_run(self.desk_, self.store_, *run, caller);
       }},
      {"abort",
       Role::kOperator,
       {"force"},
       [](Self& self, const json& params, Caller& caller) -> Outcome {
         const auto force = flag_of(params, "force");
         if (!force) return invalid("/params/force: expected true or false");
         self.forced_ = self.forced_ || *force;
         const auto refused =
             self.desk_.abort(person_of(caller, *force ? "forced abort" : "abort"));
         // A forced end is for a bench that does not answer: no state of the run refuses it.
         return done(self.forced_ ? RunDesk::Refused{} : refused);
       }},
      {"answer",
       Role::kOperator,
       {"prompt", "confirm"},
       [](Self& self, const json& params, Caller& caller) -> Outcome {
         const auto prompt = number_of(params, "prompt");
         const auto confirm = params.find("confirm");
         if (!prompt) return invalid("/params/prompt: expected the number of the prompt");
         if (confirm == params.end() || !confirm->is_boolean()) {
           return invalid("/params/confirm: expected true or false");
         }
         const bool yes = confirm->get<bool>();
         const Person by =
             person_of(caller, fmt::format("answer {} to prompt {}", yes ? "yes" : "no", *prompt));
         return done(self.desk_.answer(*prompt, yes, by));
       }},
  };
  for (const Method& method : kMethods) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

std::string ControlMethods::answer(std::string_view line, Caller& caller) {
  const auto parsed = parse_request(line);
  if (const auto* refused = std::get_if<RpcRefusal>(&parsed)) {
    ++totals_.refusals[fmt::to_string(static_cast<int>(refused->error.code))];
    return format_error(refused->id, refused->error);
  }
  const auto& request = std::get<RpcRequest>(parsed);
  const auto outcome = [&]() -> Outcome {
    const Method* method = find(request.method);
    ++totals_.requests[method == nullptr ? "unknown" : request.method];
    if (method == nullptr) {
      return RpcError{RpcCode::kMethodNotFound, "there is no method of that name"};
    }
    if (caller.role < method->role) {
      tell_refused(user_name(caller.uid), std::string(method->name));
      return RpcError{RpcCode::kPermission,
                      fmt::format("permission denied: {} may not {}: {}'s role is {}, {} is "
                                  "expected",
                                  user_name(caller.uid), method->name, user_name(caller.uid),
                                  name_of(caller.role), name_of(method->role))};
    }
    for (const auto& [key, value] : request.params.items()) {
      if (std::find(method->params.begin(), method->params.end(), key) == method->params.end()) {
        return invalid(fmt::format("/params: {} takes no such parameter", method->name));
      }
    }
    // Nothing of ours throws; memory may run out.
    try {
      return method->call(*this, request.params, caller);
    } catch (const std::exception& error) {
      return RpcError{RpcCode::kInternal, error.what()};
    }
  }();
  const auto* error = std::get_if<RpcError>(&outcome);
  if (error != nullptr) ++totals_.refusals[fmt::to_string(static_cast<int>(error->code))];
  if (request.id.empty()) return {};
  if (error != nullptr) return format_error(request.id, *error);
  return format_result(request.id, std::get<ordered_json>(outcome));
}

void ControlMethods::tell_refused(const std::string& user, const std::string& method) {
  Refusals& refusals = refused_[{user, method}];
  const auto now = clock_.now();
  if (refusals.told && now - *refusals.told < kRefusalsTogether) {
    ++refusals.untold;
    return;
  }
  desk_.happened("warning",
                 fmt::format("refused: {} may not {}{}", user, method,
                             refusals.untold == 0
                                 ? ""
                                 : fmt::format(", and was refused {} times more since it was said "
                                               "last",
                                               refusals.untold)));
  refusals = {now, 0};
}

std::string ControlMethods::metrics() const {
  return metrics_text(setup_.bench.name, desk_.view(), totals_);
}

std::string ControlMethods::news(Caller& caller) {
  const DeskView view = desk_.view();
  Subscription& subscription = *caller.subscription;
  if (view.version == subscription.seen) return {};
  subscription.seen = view.version;
  ordered_json status = to_json(view);
  if (!subscription.pattern_json.empty()) {
    status = filled(ordered_json::parse(subscription.pattern_json), status);
  }
  std::string line = format_notification("status", status);
  if (line.size() <= ControlServer::kMostUnread) return line;
  caller.subscription.reset();
  return format_error("null", {RpcCode::kTooLong, "watch: the template repeats too much"});
}

}  // namespace fogbench::daemon
