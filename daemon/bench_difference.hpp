#pragma once

#include <string>

namespace fogbench::daemon {

/// In what two records of a bench's files differ: "bench.json: /limits/field_maximum_ut was 320.0,
/// is 300.0", the first few; empty when they describe the same bench, however they are written.
std::string bench_difference(const std::string& then_json, const std::string& now_json);

}  // namespace fogbench::daemon
