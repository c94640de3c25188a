#pragma once
// The methods of protocol.md: who may call each, what its parameters must be, what it does at the
// desk. On the control socket's thread.

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/control_server.hpp"
#include "daemon/json_rpc.hpp"
#include "daemon/run_desk.hpp"
#include "daemon/totals.hpp"

namespace fogbench::daemon {

class ControlMethods final : public ControlService {
 public:
  /// The desk must outlive it. `setup` is what procedures are planned for; `store` is the run log
  /// that holds what was interrupted.
  ControlMethods(RunDesk& desk, Setup setup, std::filesystem::path store)
      : desk_(desk), setup_(std::move(setup)), store_(std::move(store)) {}

  std::string answer(std::string_view line, Caller& caller) override;
  std::string news(Caller& caller) override;

  /// An operator has asked for the end of the process, whatever the bench does.
  bool forced() const { return forced_; }

  /// It counts requests and refusals; the rest is the server's to fill in.
  ControlTotals& totals() { return totals_; }
  /// In the text format of Prometheus.
  std::string metrics() const;

 private:
  /// On the bench's record, but not for every one of a client that insists.
  void tell_refused(const std::string& user, const std::string& method);
  static constexpr std::chrono::minutes kRefusalsTogether{1};

  struct Method;
  static const Method* find(const std::string& name);

  RunDesk& desk_;
  Setup setup_;
  std::filesystem::path store_;
  bool forced_ = false;
  drivers::SteadyClock clock_;
  struct Refusals {
    std::optional<drivers::Clock::Instant> told;
    std::uint64_t untold = 0;
  };
  std::map<std::pair<std::string, std::string>, Refusals> refused_;  ///< by user and method
  ControlTotals totals_;
};

}  // namespace fogbench::daemon
