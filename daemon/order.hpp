#pragma once
// What an operator asks for, as a request brings it and the kept queue holds it.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "config/result.hpp"
#include "daemon/access.hpp"
#include "daemon/session.hpp"

namespace fogbench::daemon {

/// It can be planned again by another process.
struct Order {
  std::string procedure;  ///< a ready one's name, or a file's full path
  Parameters set;
  std::int64_t takes_up = 0;  ///< a run that was interrupted, in place of the others; 0: none
  std::string gyro;         ///< serial number; empty: that of the daemon, else of the bench's file
  bool keep_going = false;  ///< also when the run before it has failed, the bench being safe
  std::optional<SwitchedOn> switched_on;  ///< as somebody says of the gyro
  std::uint64_t job = 0;  ///< its number in the queue of the daemon before; 0: it has none yet
};

/// `store` is the run log that holds what is taken up; `reader` is who may read the procedure's
/// file, where it is no ready one. Errors: as plan_procedure, plan_resumption; kBadInput for a path
/// that is not a full one, which the daemon would look for in a folder of its own.
Result<PlannedProcedure> plan_order(const Order& order, const Setup& setup,
                                    const std::filesystem::path& store, const Credentials& reader);

/// What kSerialNumberRule says.
bool is_serial_number(std::string_view text);
inline constexpr auto kSerialNumberRule =
    "a serial number of 1 to 64 bytes on one line, without spaces around it";

}  // namespace fogbench::daemon
