#include "daemon/control_methods.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "daemon/desk_json.hpp"
#include "record/run_log.hpp"
#include "record/run_log_reader.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using testing::HasSubstr;

/// Nobody is at the bench: what is queued stays.
class ControlMethodsTest : public testing::Test {
 protected:
  ControlMethodsTest() {
    const auto ready = tests::source_tree() / "config";
    auto setup = load_setup(
        {(ready / "benches/simulated.json").string(), (ready / "scenarios/clean.json").string()});
    EXPECT_TRUE(setup) << setup.error().message;
    setup_ = std::move(*setup);
    methods_ = std::make_unique<ControlMethods>(desk_, setup_, folder_ / "store.db");
  }

  json ask(const std::string& method, const json& params, Caller& caller) {
    const std::string line = methods_->answer(
        json{{"jsonrpc", "2.0"}, {"id", 1}, {"method", method}, {"params", params}}.dump(), caller);
    EXPECT_EQ(line.back(), '\n');
    return json::parse(line);
  }
  json result(const std::string& method, const json& params = json::object()) {
    const json answer = ask(method, params, operator_);
    EXPECT_TRUE(answer.contains("result")) << answer;
    return answer.value("result", json());
  }
  RpcCode refusal(const std::string& method, const json& params, Caller& caller) {
    const json answer = ask(method, params, caller);
    EXPECT_TRUE(answer.contains("error")) << answer;
    return static_cast<RpcCode>(answer.at("error").at("code").get<int>());
  }
  std::string procedure(const std::string& steps) {
    return folder_.file("p.json", R"({"name": "p", "steps": [)" + steps + "]}").string();
  }

  support::TemporaryFolder folder_;
  daemon::Setup setup_;
  RunDesk desk_;
  std::unique_ptr<ControlMethods> methods_;
  Caller operator_{geteuid(), Role::kOperator, {}};
  Caller observer_{4294967000U, Role::kObserver, {}};
  Caller nobody_{4294967001U, Role::kNobody, {}};
};

TEST_F(ControlMethodsTest, ObserversReadOperatorsActOthersDoNeither) {
  for (const char* method : {"hello", "status", "queue", "runs", "metrics", "watch", "unwatch"}) {
    EXPECT_TRUE(ask(method, json::object(), observer_).contains("result")) << method;
    EXPECT_EQ(refusal(method, json::object(), nobody_), RpcCode::kPermission) << method;
  }
  for (const char* method :
       {"run", "remove", "move", "pause", "hold", "resume", "discard", "abort", "answer"}) {
    EXPECT_EQ(refusal(method, json::object(), observer_), RpcCode::kPermission) << method;
    const json allowed = ask(method, json::object(), operator_);
    EXPECT_NE(allowed.value("/error/code"_json_pointer, 0), static_cast<int>(RpcCode::kPermission))
        << method;
  }
  EXPECT_FALSE(methods_->forced());
  const json answer = ask("abort", {{"force", true}}, observer_);
  EXPECT_THAT(answer.at("error").at("message").get<std::string>(),
              HasSubstr("uid 4294967000 may not abort"));
  EXPECT_FALSE(methods_->forced());
}

TEST_F(ControlMethodsTest, SaysWhoAsksAndWhatItIs) {
  const json hello = result("hello");
  EXPECT_EQ(hello.at("protocol"), kProtocolVersion);
  EXPECT_EQ(hello.at("bench"), "simulated");
  EXPECT_EQ(hello.at("role"), "operator");
  EXPECT_EQ(hello.at("store"), (folder_ / "store.db").string());
  const json idle = result("status");
  EXPECT_EQ(idle.at("state"), "idle");
  for (const char* none : {"run", "prompt", "values", "point", "last_run"}) {
    EXPECT_TRUE(idle.at(none).is_null()) << none;
  }
}

TEST_F(ControlMethodsTest, QueuesWhatTheBenchCanDoAndNothingElse) {
  const std::string file =
      folder_.file("q.json", R"({"name": "q", "parameters": {"long_s": 5}, "steps": [
        {"step": "average", "duration_s": "$long_s", "segment": "a"}]})");
  const json queued = result("run", {{"procedure", file}, {"set", {{"long_s", 600}}}});
  EXPECT_EQ(queued.at("job"), 1);
  EXPECT_EQ(queued.at("steps"), 1);
  EXPECT_GT(queued.at("estimate_s"), 599.0);
  const json queue = result("queue");
  EXPECT_EQ(queue.at("jobs").size(), 1U);
  EXPECT_EQ(queue.at("jobs").at(0).at("procedure"), "q");

  EXPECT_EQ(refusal("run", {{"procedure", "/no/such.json"}}, operator_), RpcCode::kBadInput);
  EXPECT_EQ(refusal("run", {{"procedure", file}, {"set", {{"wings", 2}}}}, operator_),
            RpcCode::kBadInput);
  const std::string hot =
      procedure(R"({"step": "set_temperature", "target_c": 900, "mode": "boost"})");
  EXPECT_EQ(refusal("run", {{"procedure", hot}}, operator_), RpcCode::kLimit);
  EXPECT_EQ(result("queue").at("jobs").size(), 1U);
  result("remove", {{"job", 1}});
  EXPECT_EQ(refusal("remove", {{"job", 1}}, operator_), RpcCode::kNotFound);
}

TEST_F(ControlMethodsTest, AProcedureIsAReadyOnesNameOrAFullPath) {
  const std::string file = procedure(R"({"step": "average", "duration_s": 5, "segment": "a"})");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  for (const char* name : {"p.json", "./p.json", "../x/p.json", "p", ""}) {
    EXPECT_EQ(refusal("run", {{"procedure", name}}, operator_), RpcCode::kBadInput) << name;
  }
  std::filesystem::current_path(before);
  EXPECT_EQ(result("run", {{"procedure", "static-record"}}).at("job"), 1);
  EXPECT_EQ(result("run", {{"procedure", file}}).at("job"), 2);
}

TEST_F(ControlMethodsTest, AQueueIsReorderedAndHeld) {
  for (int i = 0; i < 3; ++i) {
    result("run", {{"procedure", "static-record"}, {"keep_going", i == 2}});
  }
  result("move", {{"job", 3}, {"to", 1}});
  const json jobs = result("queue").at("jobs");
  EXPECT_EQ(jobs.at(0).at("job"), 3);
  EXPECT_EQ(jobs.at(0).at("keep_going"), true);
  EXPECT_EQ(jobs.at(1).at("keep_going"), false);
  EXPECT_EQ(refusal("move", {{"job", 3}, {"to", 4}}, operator_), RpcCode::kNotFound);
  EXPECT_EQ(refusal("move", {{"job", 9}, {"to", 1}}, operator_), RpcCode::kNotFound);
  for (const json& wrong : {json{{"job", 3}}, json{{"job", 3}, {"to", 0}}, json{{"to", 1}}}) {
    EXPECT_EQ(refusal("move", wrong, operator_), RpcCode::kInvalidParams) << wrong;
  }
  EXPECT_EQ(refusal("run", {{"procedure", "static-record"}, {"keep_going", 1}}, operator_),
            RpcCode::kInvalidParams);
  result("hold");
  EXPECT_EQ(result("queue").at("held"), true);
  EXPECT_THAT(result("queue").at("because").get<std::string>(), HasSubstr("asked for by"));
  result("resume");
  EXPECT_EQ(result("queue").at("held"), false);
}

TEST_F(ControlMethodsTest, RunsAreNumberedFromOne) {
  for (const char* method : {"resume", "discard"}) {
    for (const json& run : {json(0), json(-1), json(18446744073709551615U), json("1")}) {
      EXPECT_EQ(refusal(method, {{"run", run}}, operator_), RpcCode::kInvalidParams) << run;
    }
  }
}

TEST_F(ControlMethodsTest, AJobIsForTheGyroThatItNamesElseForTheBenchs) {
  const std::string file = procedure(R"({"step": "average", "duration_s": 5, "segment": "a"})");
  EXPECT_EQ(result("run", {{"procedure", file}, {"gyro", "ФОГ 42"}})["gyro"], "ФОГ 42");
  EXPECT_EQ(result("run", {{"procedure", file}})["gyro"], "SIM-FOG-1");
  const json jobs = result("queue")["jobs"];
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0]["gyro"], "ФОГ 42");
  EXPECT_EQ(jobs[1]["gyro"], "SIM-FOG-1");
  EXPECT_EQ(desk_.waiting().orders[1].first.gyro, "") << "another daemon's may be another";
  ASSERT_TRUE(desk_.next_job());
  EXPECT_EQ(result("status")["run"]["gyro"], "ФОГ 42");

  const json wrong[] = {"",        " ",     " FOG-42",   "FOG-42 ",
                        "FOG\n42", "FOG\t", "\x1b[31m7", std::string(65, '7'),
                        42,        nullptr};
  for (const json& gyro : wrong) {
    const json refused = ask("run", {{"procedure", file}, {"gyro", gyro}}, operator_);
    EXPECT_EQ(refused["error"]["code"], static_cast<int>(RpcCode::kInvalidParams)) << gyro;
    EXPECT_EQ(refused["error"]["message"],
              "/params/gyro: expected a serial number of 1 to 64 bytes on one line, without spaces "
              "around it");
  }
  result("run", {{"procedure", file}, {"gyro", std::string(64, '7')}});
}

TEST_F(ControlMethodsTest, ParametersThatAreWrongOrUnknownAreRefused) {
  const std::pair<const char*, json> wrong[] = {
      {"status", {{"verbose", true}}},
      {"run", json::object()},
      {"run", {{"procedure", 7}}},
      {"run", {{"procedure", "x"}, {"set", 7}}},
      {"run", {{"procedure", "x"}, {"set", {{"a", "b"}}}}},
      {"run", {{"procedure", "x"}, {"set", {{"a", {1, "b"}}}}}},
      {"remove", {{"job", -1}}},
      {"abort", {{"force", "yes"}}},
      {"answer", {{"confirm", true}}},
      {"answer", {{"prompt", 1}}},
      {"answer", {{"prompt", 1}, {"confirm", 1}}},
      {"watch", {{"every_s", 0}}},
      {"watch", {{"every_s", "often"}}},
      {"watch", {{"template", std::string(3000, 'x')}}}};
  for (const auto& [method, params] : wrong) {
    EXPECT_EQ(refusal(method, params, operator_), RpcCode::kInvalidParams) << method << params;
  }
  EXPECT_EQ(refusal("fly", json::object(), operator_), RpcCode::kMethodNotFound);
}

TEST_F(ControlMethodsTest, ANotificationIsDoneAndNotAnswered) {
  EXPECT_EQ(methods_->answer(R"({"jsonrpc":"2.0","method":"watch"})", observer_), "");
  EXPECT_TRUE(observer_.subscription);
  EXPECT_EQ(methods_->answer(R"({"jsonrpc":"2.0","method":"unwatch"})", observer_), "");
  EXPECT_FALSE(observer_.subscription);
}

TEST_F(ControlMethodsTest, NewsHaveTheTemplatesShapeAndComeOncePerChange) {
  result("watch", {{"every_s", 2},
                   {"template",
                    {{"now", "/state"},
                     {"n", "/queue/jobs"},
                     {"x", "/no/such"},
                     {"list", {"/queue", 7, "plain"}}}}});
  ASSERT_TRUE(operator_.subscription);
  EXPECT_EQ(operator_.subscription->every, std::chrono::seconds{2});
  const json news = json::parse(methods_->news(operator_));
  EXPECT_EQ(news.at("method"), "status");
  EXPECT_EQ(news.at("params"), json::parse(R"({"now": "idle", "n": 0, "x": null,
            "list": [{"jobs": 0, "held": false, "because": ""}, 7, "plain"]})"));
  EXPECT_EQ(methods_->news(operator_), "") << "nothing has changed";
  desk_.close({"test", 0});
  EXPECT_NE(methods_->news(operator_), "");
}

TEST_F(ControlMethodsTest, ATemplateThatRepeatsTooMuchEndsTheSubscription) {
  for (int i = 0; i < 20; ++i) desk_.saw(SeenEvent{1.0, "info", std::string(480, 'e')});
  json events = json::array();
  for (int i = 0; i < 100; ++i) events.push_back("/events");
  result("watch", {{"template", events}});
  EXPECT_THAT(methods_->news(operator_), HasSubstr("-32007"));
  EXPECT_FALSE(operator_.subscription);
}

TEST_F(ControlMethodsTest, AForcedAbortIsSeenEvenWhenNothingRuns) {
  EXPECT_EQ(refusal("abort", json::object(), operator_), RpcCode::kWrongState);
  EXPECT_FALSE(methods_->forced());
  result("abort", {{"force", true}});
  EXPECT_TRUE(methods_->forced());
}

TEST_F(ControlMethodsTest, AnInterruptedRunIsTakenUpOrGivenUp) {
  const std::filesystem::path store = folder_ / "store.db";
  const auto planned = plan_procedure(
      procedure(R"({"step": "average", "duration_s": 5, "segment": "a"})"), setup_.bench, {});
  ASSERT_TRUE(planned) << planned.error().message;
  {
    const auto log = record::RunLog::open(store);
    ASSERT_TRUE(log) << log.error().message;
    procedures::RunHeader header;
    header.procedure = "p";
    header.procedure_json = planned->procedure_json;
    header.bench = setup_.bench.name;
    header.bench_json = setup_.bench_json;
    header.scenario_json = setup_.scenario_json;
    header.started_at = "2026-01-01T00:00:00Z";
    header.gyro_serial_number = "FOG-42";
    ASSERT_TRUE((*log)->begin_run(header, {}));
  }
  EXPECT_EQ(refusal("discard", {{"run", 1}}, operator_), RpcCode::kNotFound);
  desk_.offer({1, "p", "alice", "2026-01-01T00:00:00Z", 0, "FOG-42"});
  EXPECT_EQ(result("status")["interrupted"]["run"], 1);
  EXPECT_EQ(result("status")["interrupted"]["gyro"], "FOG-42");
  EXPECT_EQ(refusal("resume", {{"run", 2}}, operator_), RpcCode::kBadInput);
  EXPECT_EQ(refusal("resume", {{"run", "1"}}, operator_), RpcCode::kInvalidParams);
  EXPECT_EQ(refusal("resume", {{"run", 1}}, observer_), RpcCode::kPermission);

  EXPECT_FALSE(desk_.hold({"bob", 1001}));
  const json job = result("resume", {{"run", 1}});
  EXPECT_EQ(job["steps"], 1);
  EXPECT_EQ(job["gyro"], "FOG-42") << "the record's, not the bench's";
  EXPECT_EQ(job["held"], false);
  EXPECT_EQ(desk_.waiting().orders.front().first.takes_up, 1);

  EXPECT_EQ(refusal("resume", {{"run", 1}}, operator_), RpcCode::kWrongState) << "once is enough";
  EXPECT_EQ(refusal("discard", {{"run", 1}}, operator_), RpcCode::kWrongState);
  result("remove", {{"job", job["job"]}});
  result("discard", {{"run", 1}});
  EXPECT_TRUE(result("status")["interrupted"].is_null());
  const auto log = record::RunLogReader::open(store);
  EXPECT_EQ((*log)->run(1)->outcome(), "interrupted");
  EXPECT_TRUE((*log)->run(1)->end) << "nobody offers it again";
}

TEST_F(ControlMethodsTest, ARefusedOrderIsOnRecordAndOneWhoInsistsIsCounted) {
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(refusal("abort", json::object(), observer_), RpcCode::kPermission);
  }
  EXPECT_EQ(refusal("pause", json::object(), observer_), RpcCode::kPermission);
  const auto events = desk_.take_bench_events();
  ASSERT_EQ(events.size(), 2U) << "once a minute for each method";
  EXPECT_EQ(events[0].message, "refused: uid 4294967000 may not abort");
  EXPECT_EQ(events[0].severity, "warning");
  EXPECT_EQ(events[1].message, "refused: uid 4294967000 may not pause");
}

TEST_F(ControlMethodsTest, SinceWhenAGyroIsOnIsATimeOfTheCalendar) {
  const json order{{"procedure", procedure(R"({"step": "wait", "duration_s": 1})")},
                   {"gyro_on_since", "2026-11-29T18:00:00Z"}};
  result("run", order);
  const auto kept = desk_.waiting().orders.at(0).first.switched_on;
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->unix_s, 1795975200.0);
  for (const json& wrong : {json(5), json("yesterday"), json("2026-13-01T00:00:00Z")}) {
    json bad = order;
    bad["gyro_on_since"] = wrong;
    EXPECT_EQ(refusal("run", bad, operator_), RpcCode::kInvalidParams) << wrong;
    EXPECT_EQ(refusal("resume", {{"gyro_on_since", wrong}}, operator_), RpcCode::kInvalidParams);
  }
}

}  // namespace
}  // namespace fogbench::daemon
