#pragma once
// The bench file under which a simulated bench that is served at the wire is met.

#include <filesystem>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "simulator/wire/served_bench.hpp"

namespace fogbench::cli {

/// The bench of `file` with these connections in the place of its own, device files by their whole
/// paths, and without the section `simulation`: whoever reads it meets instruments, not a plant.
/// At a speed other than 1 the gyro's frame rate is the one that the host sees.
/// Errors: kBadInput, as of reading the file.
Result<std::string> served_bench_json(const std::filesystem::path& file,
                                      const std::vector<simulator::ServedInstrument>& instruments,
                                      double frame_rate_hz);

}  // namespace fogbench::cli
