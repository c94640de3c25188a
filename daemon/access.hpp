#pragma once
// Who is at the other end of the control socket, as the kernel says, and what they may do.

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"

namespace fogbench::daemon {

enum class Role {
  kNobody,    ///< may ask nothing
  kObserver,  ///< may read
  kOperator   ///< may act
};
std::string_view name_of(Role role);

struct Credentials {
  uid_t uid = 0;
  std::vector<gid_t> groups;  ///< the primary one too
};

/// Of the process that connected, at the moment when it did (SO_PEERCRED, SO_PEERGROUPS): no look
/// into the user database, which may be far away. Errors: kDevice.
Result<Credentials> credentials_of(int socket);

/// Of a user who is not connected, by the user database: his groups as they are now.
Credentials credentials_of_user(uid_t uid);

/// While it lives, this thread reads files with no more rights than that user has: a daemon that
/// runs as root reads nothing for an operator that he may not read himself. The other threads keep
/// theirs. Without effect for root and for the process's own user, and where the process is not
/// root: it has no others to take.
class BorrowedRights {
 public:
  explicit BorrowedRights(const Credentials& user);
  BorrowedRights(const BorrowedRights&) = delete;
  BorrowedRights& operator=(const BorrowedRights&) = delete;
  ~BorrowedRights();
  /// False when the kernel refuses: then nothing may be read for him.
  bool taken() const { return taken_; }

 private:
  bool changed_ = false, taken_ = true;
  gid_t group_ = 0;
  std::vector<gid_t> groups_;  ///< the thread's own
};

/// root and the daemon's own user may always act.
struct AccessRules {
  uid_t owner = 0;
  std::optional<gid_t> operators;
  /// Without it: everybody observes when there is a group of operators, nobody else otherwise.
  std::optional<gid_t> observers;

  Role role_of(const Credentials& peer) const;
  /// 0666 when a group is named, since the rules then decide; 0600 otherwise.
  mode_t socket_mode() const;
};

/// kBadInput when there is no such group.
Result<gid_t> group_by_name(const std::string& name);

/// "alice", or "uid 1000" for one without a name.
std::string user_name(uid_t uid);

}  // namespace fogbench::daemon
