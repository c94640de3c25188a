#include "daemon/queue_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "config/output_file.hpp"
#include "record/run_log.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

class QueueFileTest : public testing::Test {
 protected:
  QueueFileTest() {
    const auto ready = tests::source_tree() / "config";
    auto setup = load_setup(
        {(ready / "benches/simulated.json").string(), (ready / "scenarios/clean.json").string()});
    EXPECT_TRUE(setup) << setup.error().message;
    setup_ = std::move(*setup);
    EXPECT_TRUE(record::RunLog::open(store_));
  }

  void enqueue(RunDesk& desk, const std::string& procedure, const Parameters& set) {
    enqueue(desk, Order{procedure, set});
  }
  void enqueue(RunDesk& desk, const Order& order) {
    auto planned = plan_order(order, setup_, store_, {});
    ASSERT_TRUE(planned) << planned.error().message;
    desk.enqueue(order, std::move(*planned), {"alice", geteuid()});
  }
  std::string ready(const std::string& name) const {
    return (tests::source_tree() / "config/procedures" / (name + ".json")).string();
  }
  Result<QueueFile> open() const {
    auto file = QueueFile::open(store_);
    EXPECT_TRUE(file) << file.error().message;
    return file;
  }
  nlohmann::json kept() const { return nlohmann::json::parse(support::read_text(file_)); }
  Status load(RunDesk& desk) { return open()->load(desk, setup_, store_); }

  support::TemporaryFolder folder_;
  std::filesystem::path store_{folder_ / "store.db"}, file_{folder_ / "store.db.queue"};
  daemon::Setup setup_;
};

TEST_F(QueueFileTest, WhatWaitsOutlivesTheDaemonAndIsHeld) {
  RunDesk desk;
  enqueue(desk, ready("coil-sweep"), {{"average_s", 5.0}, {"levels_ut", std::vector{0.0, 300.0}}});
  enqueue(desk, ready("static-record"), {});
  open()->update(desk);

  RunDesk next;
  ASSERT_TRUE(load(next));
  const auto waiting = next.waiting().orders;
  ASSERT_EQ(waiting.size(), 2U);
  EXPECT_EQ(waiting[0].first.procedure, ready("coil-sweep"));
  EXPECT_EQ(waiting[0].first.set, desk.waiting().orders[0].first.set);
  EXPECT_EQ(waiting[1].second.name, "alice");
  EXPECT_EQ(waiting[1].second.uid, geteuid());
  EXPECT_THAT(next.view().held_because, testing::StartsWith("the daemon was started anew"));
}

TEST_F(QueueFileTest, EachJobKeepsItsNumber) {
  RunDesk desk;
  for (int i = 0; i < 3; ++i) enqueue(desk, ready("static-record"), {});
  EXPECT_FALSE(desk.remove(1, {"alice", geteuid()}));
  EXPECT_FALSE(desk.move(3, 1, {"alice", geteuid()}));
  open()->update(desk);
  RunDesk next;
  ASSERT_TRUE(load(next));
  ASSERT_EQ(next.queue().size(), 2U);
  EXPECT_EQ(next.queue()[0].job, 3U);
  EXPECT_EQ(next.queue()[1].job, 2U);
  enqueue(next, ready("static-record"), {});
  EXPECT_EQ(next.queue()[2].job, 4U) << "no number is given twice";
}

TEST_F(QueueFileTest, NumbersGoOnThoughNothingWaited) {
  RunDesk desk;
  enqueue(desk, ready("static-record"), {});
  EXPECT_FALSE(desk.remove(1, {"alice", geteuid()}));
  open()->update(desk);
  RunDesk next;
  ASSERT_TRUE(load(next));
  EXPECT_TRUE(next.queue().empty());
  EXPECT_TRUE(next.view().held_because.empty());
  Order warm{ready("static-record"), {}};
  warm.switched_on = SwitchedOn{1234.5, "bob"};
  enqueue(next, warm);
  EXPECT_EQ(next.queue()[0].job, 2U);
  open()->update(next);
  RunDesk third;
  ASSERT_TRUE(load(third));
  const auto kept = third.waiting().orders.at(0).first.switched_on;
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->unix_s, 1234.5);
  EXPECT_EQ(kept->by, "bob");
  ASSERT_TRUE(config::write_file(file_, R"({"jobs": [], "last_job": "seven"})"));
  RunDesk fourth;
  EXPECT_THAT(load(fourth).error().message, testing::HasSubstr("/last_job: expected the number"));
}

TEST_F(QueueFileTest, EachJobKeepsItsGyroAndOneWithoutTakesTheNewDaemons) {
  RunDesk desk;
  enqueue(desk, Order{ready("static-record"), {}, 0, "FOG-42"});
  enqueue(desk, ready("static-record"), {});
  open()->update(desk);
  const auto kept = nlohmann::json::parse(support::read_text(file_));
  EXPECT_EQ(kept["jobs"][0]["gyro"], "FOG-42");
  EXPECT_FALSE(kept["jobs"][1].contains("gyro"));
  setup_.bench.gyro.serial_number = "FOG-7";
  RunDesk next;
  ASSERT_TRUE(load(next));
  const auto jobs = next.queue();
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].gyro, "FOG-42");
  EXPECT_EQ(jobs[1].gyro, "FOG-7");
  EXPECT_EQ(next.waiting().orders[0].first.gyro, "FOG-42") << "and the next file has it";
}

TEST_F(QueueFileTest, AHoldTheOrderAndWhatRunsAfterAFailureOutliveTheDaemon) {
  RunDesk desk;
  enqueue(desk, ready("coil-sweep"), {});
  Order stubborn{ready("static-record"), {}};
  stubborn.keep_going = true;
  enqueue(desk, stubborn);
  EXPECT_FALSE(desk.move(2, 1, {"alice", geteuid()}));
  EXPECT_FALSE(desk.hold({"alice", geteuid()}));
  open()->update(desk);
  RunDesk next;
  ASSERT_TRUE(load(next));
  ASSERT_EQ(next.queue().size(), 2U);
  EXPECT_EQ(next.queue()[0].procedure, "static-record");
  EXPECT_TRUE(next.queue()[0].keep_going);
  EXPECT_FALSE(next.queue()[1].keep_going);
  EXPECT_THAT(next.view().held_because, testing::StartsWith("asked for by alice"));
}

TEST_F(QueueFileTest, AHoldOfAnEmptyQueueOutlivesTheDaemonUntilSomebodyGoesOn) {
  RunDesk desk;
  EXPECT_FALSE(desk.hold({"alice", geteuid()}));
  open()->update(desk);
  RunDesk next;
  ASSERT_TRUE(load(next));
  EXPECT_EQ(next.view().held_because, "asked for by alice");
  EXPECT_FALSE(next.resume({"bob", 1001}));
  open()->update(next);
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(QueueFileTest, AFileOfAnEarlierVersionIsAList) {
  folder_.file("store.db.queue", nlohmann::json::array({{{"procedure", ready("static-record")},
                                                         {"set", nlohmann::json::object()},
                                                         {"by", "alice"},
                                                         {"uid", geteuid()}}})
                                     .dump());
  RunDesk desk;
  ASSERT_TRUE(load(desk));
  EXPECT_EQ(desk.queue().size(), 1U);
}

TEST_F(QueueFileTest, AnEmptyQueueLeavesNoFile) {
  RunDesk desk;
  QueueFile file = *open();
  enqueue(desk, ready("static-record"), {});
  file.update(desk);
  EXPECT_TRUE(std::filesystem::exists(file_));
  EXPECT_FALSE(desk.remove(1, {"alice", geteuid()}));
  file.update(desk);
  EXPECT_TRUE(kept()["jobs"].empty());
  RunDesk next;
  EXPECT_TRUE(file.load(next, setup_, store_));
  EXPECT_TRUE(next.waiting().orders.empty());
}

TEST_F(QueueFileTest, AJobThatWasTakenStaysUntilItsRunIsOnRecord) {
  RunDesk desk;
  QueueFile file = *open();
  enqueue(desk, ready("static-record"), {});
  ASSERT_TRUE(desk.next_job());
  file.update(desk);
  RunDesk next;
  ASSERT_TRUE(file.load(next, setup_, store_));
  EXPECT_EQ(next.waiting().orders.size(), 1U);
  desk.run_begun(1);
  file.update(desk);
  EXPECT_TRUE(kept()["jobs"].empty());
}

TEST_F(QueueFileTest, BelongsToOneProcessByWhateverNameTheStoreIsCalled) {
  const std::filesystem::path link = folder_ / "link.db";
  std::filesystem::create_symlink("store.db", link);
  {
    const auto first = open();
    for (const auto& name : {store_, link}) {
      const auto second = QueueFile::open(name);
      ASSERT_FALSE(second);
      EXPECT_EQ(second.error().code, ErrorCode::kHeld);
      EXPECT_EQ(second.error().message,
                "run log " + name.string() + " is held by this program already");
    }
  }
  RunDesk desk;
  enqueue(desk, ready("static-record"), {});
  QueueFile::open(link)->update(desk);
  EXPECT_TRUE(std::filesystem::exists(file_)) << "the queue of the store, not of a link";
}

TEST_F(QueueFileTest, WhatCanNoLongerBePlannedIsLeftOut) {
  RunDesk desk;
  const auto gone = folder_.file("gone.json", R"({"name": "gone", "steps": [
      {"step": "average", "duration_s": 1, "segment": "a"}]})");
  enqueue(desk, gone.string(), {});
  enqueue(desk, ready("static-record"), {});
  open()->update(desk);
  std::filesystem::remove(gone);
  RunDesk next;
  ASSERT_TRUE(load(next));
  ASSERT_EQ(next.waiting().orders.size(), 1U);
  EXPECT_EQ(next.waiting().orders[0].first.procedure, ready("static-record"));
}

TEST_F(QueueFileTest, AFileThatIsNoneOfOursIsRefusedInOneLine) {
  for (const auto& [text, says] :
       {std::pair{"{", "store.db.queue"}, std::pair{"{}", "expected a list"},
        std::pair{R"([{"by": "a", "uid": 1}])", "job 1: expected procedure"},
        std::pair{R"([{"by": 1, "uid": 1}])", "job 1: expected procedure"},
        std::pair{R"({"jobs": [], "hold": true})", "/hold: expected why"},
        std::pair{R"([{"procedure": "p", "set": {}, "keep_going": 1, "by": "a", "uid": 1}])",
                  "keep_going"},
        std::pair{R"([{"procedure": "p", "set": {}, "gyro": "a\nb", "by": "a", "uid": 1}])",
                  "perhaps job, gyro"},
        std::pair{R"([{"procedure": "p", "set": {}, "gyro": 7, "by": "a", "uid": 1}])", "job 1"},
        std::pair{R"([{"takes_up": -1, "by": "a", "uid": 1}])", "job 1"}}) {
    folder_.file("store.db.queue", text);
    RunDesk desk;
    const Status loaded = load(desk);
    ASSERT_FALSE(loaded) << text;
    EXPECT_EQ(loaded.error().code, ErrorCode::kBadInput);
    EXPECT_NE(loaded.error().message.find(says), std::string::npos) << loaded.error().message;
  }
}

}  // namespace
}  // namespace fogbench::daemon
