#pragma once
// Every step against what the bench allows, before anything is touched.

#include <string>
#include <vector>

#include "config/bench.hpp"
#include "config/result.hpp"
#include "procedures/plan.hpp"

namespace fogbench::procedures {

/// The current that `level` along `axis` may need on this bench: with the ambient field that
/// compensation may have to null on top.
config::Ampere worst_current(Axis axis, Microtesla level, const config::BenchConfig& bench);

/// What a coil and its supply both allow.
config::Ampere current_limit(const config::CoilConfig& coil);

/// One sentence for each kind of limit met. Appends to `problems` what is not: kLimit (temperature
/// and its rate, field, current, run time) and kBadInput (a sweep along an axis that the gyro's
/// azimuth keeps out of the coils' field, or without a compensated zero), one line each with the
/// step's file and JSON pointer.
/// Preconditions: estimates are filled; a bench starts at azimuth 0.
std::vector<std::string> check_limits(const std::string& procedure,
                                      const std::vector<PlannedStep>& steps,
                                      const config::BenchConfig& bench,
                                      std::vector<Error>& problems);

}  // namespace fogbench::procedures
