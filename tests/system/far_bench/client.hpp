#pragma once
// A test's hold on far ends that are a process of their own (main.cpp), and on the daemons that
// meet them.

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::far_bench {

/// The environment in which a program meets, in place of libhidapi's devices, those that a served
/// bench exports over USB/IP (hid_stand_in.cpp). `folder` has no blank in its name.
std::vector<std::string> hid_stand_in(const std::filesystem::path& folder, int usbip_port);

class FarBench {
 public:
  /// `boost`: what the thermostat's mode shows while it boosts; 1 is as described. `identity`: what
  /// the bench file expects coil_vertical to say that it is; empty: what it says.
  explicit FarBench(double boost = 1.0, const std::string& identity = {});
  FarBench(const FarBench&) = delete;
  FarBench& operator=(const FarBench&) = delete;
  ~FarBench();

  /// One request of control_server.hpp, and its answer.
  std::string ask(const std::string& request);
  nlohmann::json state() { return nlohmann::json::parse(ask("state"), nullptr, false); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// The far ends' bench, its run log and its socket are where all daemons of this bench have them.
  std::unique_ptr<support::Process> daemon(const std::vector<std::string>& environment = {},
                                           const std::vector<std::string>& procedures = {}) const;
  support::Finished fogbench(std::vector<std::string> arguments) const;
  /// A procedure file: the heaters and both coils are busy for a minute, a point every 3 s.
  std::string energising_procedure() const;

 private:
  support::TemporaryFolder folder_;
  support::Process process_;
  int control_ = -1;
  int usbip_port_ = 0;
};

}  // namespace fogbench::far_bench
