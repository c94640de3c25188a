#pragma once
// What the desk shows, as protocol.md lists it. Missing numbers are null; units are in the names.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/run_desk.hpp"

namespace fogbench::daemon {

/// idle, starting, running, paused, stopping.
std::string_view state_of(const DeskView& view);

nlohmann::ordered_json to_json(const DeskView& view);
nlohmann::ordered_json to_json(const std::vector<QueuedJob>& queue);
nlohmann::ordered_json to_json(const std::vector<EndedRun>& runs);

/// `pattern` with every string in it that is a JSON pointer replaced by what it points to in
/// `document`, null where there is nothing: a client chooses the shape that its news take.
nlohmann::ordered_json filled(const nlohmann::ordered_json& pattern,
                              const nlohmann::ordered_json& document);

}  // namespace fogbench::daemon
