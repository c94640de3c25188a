#pragma once
// Command-line options that `fogbench dry-run` and fogbenchd share.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "daemon/session.hpp"

namespace fogbench::daemon {

inline void add_seed_option(CLI::App& app, std::optional<std::uint64_t>& seed) {
  // strtoull, which reads the number, would take "-1" for the largest one.
  const auto digits = [](const std::string& text) -> std::string {
    const bool whole =
        std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
    return whole ? "" : "a whole number was expected, not " + text;
  };
  app.add_option("--seed", seed, "Of all noise (default: drawn, printed and recorded)")
      ->check(digits);
}

inline void add_speed_option(CLI::App& app, Speed& speed, const std::string& standard) {
  app.add_option("--speed", speed,
                 "realtime, or max: as fast as the machine can (default: " + standard + ")")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, Speed>{{"realtime", Speed::kRealtime}, {"max", Speed::kMaximum}}));
}

}  // namespace fogbench::daemon
