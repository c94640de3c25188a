#pragma once
// Command-line options that `fogbench dry-run` and fogbenchd share.

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "daemon/session.hpp"

namespace fogbench::daemon {

/// One of `names`, which stand in the help text and in the error, and nothing else.
template <class T>
void add_choice_option(CLI::App& app, const std::string& option, T& value,
                       const std::map<std::string, T>& names, const std::string& description) {
  app.add_option_function<std::string>(
         option, [&value, names](const std::string& name) { value = names.at(name); }, description)
      ->check(CLI::IsMember(names));
}

inline void add_seed_option(CLI::App& app, std::optional<std::uint64_t>& seed) {
  // strtoull, which reads the number, would take "-1", and any number too large, for the largest.
  const auto digits = [](const std::string& text) -> std::string {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc{} && end == text.data() + text.size();
    return whole ? "" : "a whole number from 0 to 18446744073709551615 was expected, not " + text;
  };
  app.add_option("--seed", seed, "Of all noise (default: drawn, printed and recorded)")
      ->check(digits);
}

inline void add_speed_option(CLI::App& app, Speed& speed, const std::string& standard) {
  add_choice_option<Speed>(
      app, "--speed", speed, {{"realtime", Speed::kRealtime}, {"max", Speed::kMaximum}},
      "In real time, or as fast as the machine can (default: " + standard + ")");
}

}  // namespace fogbench::daemon
