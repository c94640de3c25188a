#pragma once
// Command-line options that fogbench and fogbenchd share.

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "daemon/order.hpp"
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

inline void add_gyro_option(CLI::App& app, std::string& serial_number,
                            const std::string& standard = "the bench file's") {
  app.add_option("--gyro", serial_number,
                 "Serial number of the gyro under test (default: " + standard + ")")
      ->check([](const std::string& text) {
        return is_serial_number(text) ? "" : std::string("expected ") + kSerialNumberRule;
      });
}

inline void add_speed_option(CLI::App& app, Speed& speed, const std::string& standard) {
  constexpr double kSlowest = 1.0, kFastest = 1000.0;
  const auto read = [](const std::string& text) -> std::optional<Speed> {
    if (text == "realtime") return Speed::kRealtime;
    if (text == "max") return Speed::kMaximum;
    Speed speed_up;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, speed_up.factor);
    const bool good = error == std::errc{} && end == last && speed_up.factor >= kSlowest &&
                      speed_up.factor <= kFastest;
    return good ? std::optional(speed_up) : std::nullopt;
  };
  app.add_option_function<std::string>(
         "--speed", [&speed, read](const std::string& text) { speed = *read(text); },
         "In real time (realtime), up to 1000 times faster (a number), or as fast as the machine "
         "can (max); default: " +
             standard)
      ->check([read](const std::string& text) -> std::string {
        return read(text) ? ""
                          : "realtime, max or a number from 1 to 1000 was expected, not " + text;
      });
}

}  // namespace fogbench::daemon
