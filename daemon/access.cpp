#include "daemon/access.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <pwd.h>
#include <sys/fsuid.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace fogbench::daemon {
namespace {

Error unknown_peer(const char* what) {
  return Error{ErrorCode::kDevice,
               fmt::format("{}: {}", what, std::generic_category().message(errno))};
}

bool holds(const std::vector<gid_t>& groups, gid_t group) {
  return std::find(groups.begin(), groups.end(), group) != groups.end();
}

/// Looks a name up with a buffer that grows as the database asks for.
template <class Entry, class LookUp>
bool look_up(std::vector<char>& buffer, Entry& entry, LookUp look_up_into) {
  constexpr std::size_t kLargest = std::size_t{1} << 20;
  Entry* found = nullptr;
  for (buffer.resize(1024); buffer.size() <= kLargest; buffer.resize(2 * buffer.size())) {
    if (look_up_into(&entry, buffer.data(), buffer.size(), &found) != ERANGE) break;
  }
  return found != nullptr;
}

/// Of this thread only: the library's function would change all of them.
bool set_thread_groups(const std::vector<gid_t>& groups) {
  return syscall(SYS_setgroups, groups.size(), groups.data()) == 0;
}

}  // namespace

std::string_view name_of(Role role) {
  constexpr std::array<std::string_view, 3> kNames{"nobody", "observer", "operator"};
  return kNames[static_cast<std::size_t>(role)];
}

Result<Credentials> credentials_of(int socket) {
  ucred peer{};
  socklen_t length = sizeof peer;
  if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &length) != 0) {
    return unknown_peer("SO_PEERCRED");
  }
  Credentials credentials{peer.uid, {}};
  length = 0;
  // Says how many bytes it needs.
  if (getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, nullptr, &length) != 0 && errno != ERANGE) {
    return unknown_peer("SO_PEERGROUPS");
  }
  credentials.groups.resize(length / sizeof(gid_t));
  if (length > 0 &&
      getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, credentials.groups.data(), &length) != 0) {
    return unknown_peer("SO_PEERGROUPS");
  }
  credentials.groups.push_back(peer.gid);
  return credentials;
}

Credentials credentials_of_user(uid_t uid) {
  passwd entry{};
  std::vector<char> buffer;
  const bool found =
      look_up(buffer, entry, [&](passwd* into, char* text, size_t size, passwd** out) {
        return getpwuid_r(uid, into, text, size, out);
      });
  if (!found) return {uid, {}};
  int count = 64;
  std::vector<gid_t> groups(static_cast<std::size_t>(count));
  if (getgrouplist(entry.pw_name, entry.pw_gid, groups.data(), &count) < 0) {
    groups.resize(static_cast<std::size_t>(count));  // it has said how many there are
    if (getgrouplist(entry.pw_name, entry.pw_gid, groups.data(), &count) < 0) count = 0;
  }
  groups.resize(static_cast<std::size_t>(count));
  return {uid, std::move(groups)};
}

BorrowedRights::BorrowedRights(const Credentials& user) {
  if (geteuid() != 0 || user.uid == 0) return;
  const int count = getgroups(0, nullptr);
  groups_.resize(static_cast<std::size_t>(std::max(count, 0)));
  if (count < 0 || getgroups(count, groups_.data()) != count) {
    taken_ = false;
    return;
  }
  changed_ = true;
  // The kernel takes root's powers over files away with the file system's user id.
  const gid_t nobodys = static_cast<gid_t>(-2);
  group_ = static_cast<gid_t>(setfsgid(user.groups.empty() ? nobodys : user.groups.back()));
  taken_ = set_thread_groups(user.groups);
  setfsuid(user.uid);
  taken_ = taken_ && static_cast<uid_t>(setfsuid(static_cast<uid_t>(-1))) == user.uid;
}

BorrowedRights::~BorrowedRights() {
  if (!changed_) return;
  setfsuid(geteuid());
  setfsgid(group_);
  set_thread_groups(groups_);
}

Role AccessRules::role_of(const Credentials& peer) const {
  if (peer.uid == 0 || peer.uid == owner) return Role::kOperator;
  if (operators && holds(peer.groups, *operators)) return Role::kOperator;
  if (observers) return holds(peer.groups, *observers) ? Role::kObserver : Role::kNobody;
  return operators ? Role::kObserver : Role::kNobody;
}

mode_t AccessRules::socket_mode() const {
  return operators || observers ? 0666 : 0600;
}

Result<gid_t> group_by_name(const std::string& name) {
  group entry{};
  std::vector<char> buffer;
  const bool found = look_up(buffer, entry, [&](group* into, char* text, size_t size, group** out) {
    return getgrnam_r(name.c_str(), into, text, size, out);
  });
  if (!found) return Error{ErrorCode::kBadInput, fmt::format("{}: there is no such group", name)};
  return entry.gr_gid;
}

std::string user_name(uid_t uid) {
  passwd entry{};
  std::vector<char> buffer;
  const bool found =
      look_up(buffer, entry, [&](passwd* into, char* text, size_t size, passwd** out) {
        return getpwuid_r(uid, into, text, size, out);
      });
  return found ? entry.pw_name : fmt::format("uid {}", uid);
}

}  // namespace fogbench::daemon
