#include "daemon/access.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <future>

#include "drivers/file_descriptor.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

TEST(AccessRules, GroupsDecideWhoActsAndWhoLooks) {
  const Credentials owner{1000, {1000}}, root{0, {0}}, stranger{2000, {2000, 5}};
  const Credentials worker{2001, {2001, 70}}, guest{2002, {80}};

  const AccessRules alone{1000, {}, {}};
  EXPECT_EQ(alone.role_of(owner), Role::kOperator);
  EXPECT_EQ(alone.role_of(root), Role::kOperator);
  EXPECT_EQ(alone.role_of(stranger), Role::kNobody);
  EXPECT_EQ(alone.socket_mode(), 0600U);

  const AccessRules operators{1000, 70, {}};
  EXPECT_EQ(operators.role_of(worker), Role::kOperator);
  EXPECT_EQ(operators.role_of(stranger), Role::kObserver);
  EXPECT_EQ(operators.socket_mode(), 0666U);

  const AccessRules both{1000, 70, 80};
  EXPECT_EQ(both.role_of(worker), Role::kOperator);
  EXPECT_EQ(both.role_of(guest), Role::kObserver);
  EXPECT_EQ(both.role_of(stranger), Role::kNobody);

  const AccessRules observers{1000, {}, 80};
  EXPECT_EQ(observers.role_of(guest), Role::kObserver);
  EXPECT_EQ(observers.role_of(stranger), Role::kNobody);
}

TEST(CredentialsOf, AreThoseOfTheProcessAtTheOtherEnd) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
  const drivers::FileDescriptor one(ends[0]), other(ends[1]);
  const auto credentials = credentials_of(one.get());
  ASSERT_TRUE(credentials) << credentials.error().message;
  EXPECT_EQ(credentials->uid, geteuid());
  std::vector<gid_t> mine(static_cast<std::size_t>(getgroups(0, nullptr)));
  mine.resize(static_cast<std::size_t>(getgroups(static_cast<int>(mine.size()), mine.data())));
  mine.push_back(getegid());
  for (const gid_t group : mine) {
    EXPECT_EQ(std::count(credentials->groups.begin(), credentials->groups.end(), group) > 0, true);
  }
  EXPECT_FALSE(credentials_of(-1));
}

TEST(Names, OfUsersAndGroups) {
  EXPECT_EQ(user_name(0), "root");
  EXPECT_EQ(user_name(4294967000U), "uid 4294967000");
  const auto group = group_by_name("root");
  ASSERT_TRUE(group);
  EXPECT_EQ(*group, 0U);
  const auto none = group_by_name("no such group");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kBadInput);
}

// Other users need root to be played; without it there are no rights to borrow.
TEST(BorrowedRights, AreThoseOfTheUserForThisThreadAndNoLonger) {
  if (geteuid() != 0) return;
  const support::TemporaryFolder folder;
  const auto file = folder.file("secret.json", "{}");
  const auto reads = [&file] { return std::ifstream(file).good(); };
  ASSERT_EQ(chmod(folder.path().c_str(), 0755), 0);
  ASSERT_EQ(chmod(file.c_str(), 0640), 0);
  constexpr uid_t kNobody = 65534;
  constexpr gid_t kShared = 1;
  ASSERT_EQ(chown(file.c_str(), 0, kShared), 0);
  ASSERT_TRUE(reads());
  {
    std::promise<void> borrowed;
    auto elsewhere = std::async(std::launch::async, [&] {
      borrowed.get_future().wait();
      return reads();
    });
    const BorrowedRights stranger({kNobody, {kNobody}});
    borrowed.set_value();
    EXPECT_TRUE(stranger.taken());
    EXPECT_FALSE(reads());
    EXPECT_TRUE(elsewhere.get()) << "the bench's thread keeps its own";
  }
  {
    const BorrowedRights member({kNobody, {kNobody, kShared}});
    EXPECT_TRUE(reads()) << "his groups count";
  }
  {
    const BorrowedRights root({0, {0}});
    EXPECT_TRUE(reads());
  }
  EXPECT_TRUE(reads());
}

}  // namespace
}  // namespace fogbench::daemon
