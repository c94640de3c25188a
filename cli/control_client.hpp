#pragma once
// A client of fogbenchd's control socket (daemon/protocol.md). Blocks; one thread.

#include <chrono>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "config/result.hpp"
#include "drivers/file_descriptor.hpp"

namespace CLI {
class App;
}

namespace fogbench::cli {

/// --socket PATH.
void add_socket_option(CLI::App& command, std::string& socket);
/// " --socket PATH" for a command that is proposed next; empty when the default one serves.
std::string socket_argument(const std::string& socket);

/// The run log that the daemon at the default socket writes; empty when none serves there, or none
/// that answers soon.
std::string served_store();

class ControlClient {
 public:
  /// The daemon answers within milliseconds; planning a long procedure takes the longest.
  static constexpr std::chrono::milliseconds kPatience{30'000};

  /// `socket`: as given with --socket; empty: where the daemon is by default. kDevice, one line,
  /// when nobody serves there or this user may not connect.
  static Result<std::unique_ptr<ControlClient>> connect(
      const std::string& socket, std::chrono::milliseconds patience = kPatience);

  /// The method's result. Errors: kBadInput and kLimit for what the daemon says of a procedure;
  /// kTimeout when it does not answer, kDevice for every other refusal and when it is gone.
  Result<nlohmann::json> call(const std::string& method, const nlohmann::ordered_json& params);
  Result<nlohmann::json> call(const std::string& method);

  /// Waits for the next status after a call of `watch`. kDevice when the daemon is gone.
  Result<nlohmann::json> next_status();

 private:
  ControlClient(int socket, std::string path, std::chrono::milliseconds patience)
      : socket_(socket), path_(std::move(path)), patience_(patience) {}
  /// Without its newline. `timeout_ms` < 0: waits for ever.
  Result<std::string> next_line(int timeout_ms);
  Error gone() const;

  drivers::FileDescriptor socket_;
  std::string path_;
  std::chrono::milliseconds patience_;
  std::string in_;
  int calls_ = 0;
};

}  // namespace fogbench::cli
