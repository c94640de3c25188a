#pragma once
// The daemon's status for a person.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "config/result.hpp"

namespace fogbench::cli {

/// Several lines, each ended. Members that are missing or odd are left out: the daemon may be of
/// another version.
std::string status_text(const nlohmann::json& status);

/// "2 in the queue", with the reason why they are held, as a line; nothing when it is empty.
std::string queue_text(const nlohmann::json& status);

/// ", gyro FOG-42", of a run or a job; empty when nobody named one.
std::string gyro_text(const nlohmann::json& job);

/// "run 7, coil-sweep, gyro FOG-42: completed, all steps done, 82 points; the bench is in its safe
/// state", of the status's last_run.
std::string ended_text(const nlohmann::json& ended);

/// Nothing runs, and nothing will until somebody asks for it.
bool is_at_rest(const nlohmann::json& status);

/// Of the last run: kAborted or kDevice when it did not complete.
Status outcome_of(const nlohmann::json& ended);

}  // namespace fogbench::cli
