#include "drivers/process_lock.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>

#include "tests/support/own_locks.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::drivers {
namespace {

namespace fs = std::filesystem;

/// A process that has done something, and has what it got until it is killed.
class Other {
 public:
  explicit Other(const std::function<bool()>& act) {
    int ready[2];
    if (pipe2(ready, O_CLOEXEC) != 0) std::abort();
    pid_ = fork();
    if (pid_ == 0) {
      const char done = act() ? 'y' : 'n';
      if (write(ready[1], &done, 1) != 1) _exit(1);
      for (;;) pause();
    }
    char done = 0;
    EXPECT_EQ(read(ready[0], &done, 1), 1);
    EXPECT_EQ(done, 'y');
    close(ready[0]);
    close(ready[1]);
  }
  Other(const Other&) = delete;
  Other& operator=(const Other&) = delete;
  ~Other() { crash(); }
  void crash() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    pid_ = -1;
  }
  std::string name() const { return "process " + std::to_string(pid_) + " (drivers_test)"; }

 private:
  pid_t pid_ = -1;
};

class ProcessLockTest : public testing::Test {
 protected:
  Result<std::unique_ptr<ProcessLock>> take() const {
    return ProcessLock::take(file_, 0600, "run log x.db");
  }
  support::TemporaryFolder folder_;
  fs::path file_ = folder_ / "x.lock";
};

TEST_F(ProcessLockTest, TheSecondIsToldWhoHasItAndACrashedOneHasNothing) {
  std::unique_ptr<ProcessLock> kept;
  Other other([&] {
    auto lock = take();
    if (lock) kept = std::move(*lock);
    return static_cast<bool>(lock);
  });
  const auto second = take();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kHeld);
  EXPECT_EQ(second.error().message, "run log x.db is held by " + other.name());
  other.crash();
  EXPECT_TRUE(fs::exists(file_));
  const auto third = take();
  ASSERT_TRUE(third) << third.error().message;
}

TEST_F(ProcessLockTest, LeavesNoFileAndCanBeTakenAgain) {
  for (int i = 0; i < 3; ++i) {
    const auto lock = take();
    ASSERT_TRUE(lock) << lock.error().message;
    EXPECT_TRUE(fs::exists(file_));
    EXPECT_EQ(take().error().message, "run log x.db is held by this program already");
  }
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(ProcessLockTest, AFileThatCannotBeMadeIsNoHolder) {
  const auto lock = ProcessLock::take(folder_ / "none" / "x.lock", 0600, "run log x.db");
  ASSERT_FALSE(lock);
  EXPECT_EQ(lock.error().code, ErrorCode::kDevice);
  EXPECT_EQ(lock.error().message,
            "run log x.db cannot be locked: " + (folder_ / "none" / "x.lock").string() +
                ": No such file or directory");
}

TEST_F(ProcessLockTest, ALinkInItsPlaceIsNotFollowed) {
  const fs::path precious = folder_.file("precious", "text");
  fs::create_symlink(precious, file_);
  EXPECT_FALSE(take());
  EXPECT_EQ(support::read_text(precious), "text");
}

class InstrumentLockTest : public testing::Test {
 protected:
  support::OwnLocks locks_;
};

TEST_F(InstrumentLockTest, IsForAllUsersWhateverTheUmask) {
  const mode_t before = umask(0077);
  const auto lock = lock_instrument({"serial line /dev/ttyUSB0"});
  umask(before);
  ASSERT_TRUE(lock) << lock.error().message;
  struct stat made {};
  ASSERT_EQ(stat((locks_ / "fogbench.serial_line_%2Fdev%2FttyUSB0").c_str(), &made), 0);
  EXPECT_EQ(made.st_mode & 0777U, 0666U);
}

TEST_F(InstrumentLockTest, EachNameOfAnInstrumentIsTaken) {
  const auto first = lock_instrument({"line a", "line b", "line a"});
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_FALSE(lock_instrument({"line b"}));
  EXPECT_FALSE(lock_instrument({"line c", "line a"}));
  EXPECT_TRUE(lock_instrument({"line c"})) << "which the refused one gave back";
}

TEST(HolderOf, FindsTheProcessThatHasAFileOpen) {
  const support::TemporaryFolder folder;
  const fs::path file = folder.file("device", "");
  EXPECT_EQ(holder_of(file), "another process");
  const Other other([&] { return ::open(file.c_str(), O_RDONLY | O_CLOEXEC) >= 0; });
  EXPECT_EQ(holder_of(file), other.name());
}

}  // namespace
}  // namespace fogbench::drivers
