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
