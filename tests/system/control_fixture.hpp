#pragma once
// A fogbenchd that serves the simulated bench, 20 times faster than real, and its clients.

#include <sys/stat.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {

class ControlTest : public FogbenchTest {
 protected:
  ControlTest() {
    // Other users must reach the socket, and the program: a developer's home may be closed to them.
    chmod(folder_.path().c_str(), 0755);
    setenv("FOGBENCH_SOCKET", socket().c_str(), 1);
  }
  ~ControlTest() override { unsetenv("FOGBENCH_SOCKET"); }

  std::string socket() const { return (folder_ / "control.sock").string(); }

  std::vector<std::string> daemon_command(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"--bench", "simulated", "--store", store(), "--speed", "20"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return command(arguments, "fogbenchd");
  }
  /// Serving when it returns.
  static std::unique_ptr<Process> started(const std::vector<std::string>& daemon_command,
                                          const Process::Setup& setup = {}) {
    auto daemon = std::make_unique<Process>(daemon_command, setup);
    for (int i = 0; i < 300; ++i) {
      if (fogbench({"status"}).status == 0) return daemon;
      std::this_thread::sleep_for(std::chrono::milliseconds{100});
    }
    ADD_FAILURE() << "the daemon does not serve: " << daemon->wait(std::chrono::seconds{1}).err;
    return daemon;
  }
  std::unique_ptr<Process> serve(const std::vector<std::string>& more = {},
                                 const Process::Setup& setup = {}) const {
    return started(daemon_command(more), setup);
  }
  static nlohmann::json status() { return json({"status", "--json"}); }
  /// The first status of which `holds` is true.
  static nlohmann::json wait_until(const std::function<bool(const nlohmann::json&)>& holds) {
    nlohmann::json now;
    for (int i = 0; i < 600; ++i) {
      now = status();
      if (holds(now)) return now;
      std::this_thread::sleep_for(std::chrono::milliseconds{50});
    }
    ADD_FAILURE() << "it never came to that: " << now;
    return now;
  }
  static nlohmann::json wait_for_prompt() {
    return wait_until([](const nlohmann::json& now) { return now["prompt"].is_object(); });
  }

  /// A procedure of `averages` points, 2 s of the bench each, after a prompt where one is given.
  std::string procedure(const std::string& name, int averages,
                        const std::string& prompt = "") const {
    std::string steps = R"({"step": "set_temperature", "mode": "off"})";
    if (!prompt.empty()) steps += R"(, {"step": "prompt", "text": ")" + prompt + "\"}";
    for (int i = 0; i < averages; ++i) {
      steps += R"(, {"step": "average", "duration_s": 2, "segment": "a"})";
    }
    return folder_.file(name + ".json", R"({"name": ")" + name + R"(", "steps": [)" + steps + "]}")
        .string();
  }
  nlohmann::json stored(const std::string& run) const {
    return json({"show", run, "--store", store(), "--json"});
  }
  static bool has_event(const nlohmann::json& run, const std::string& text) {
    for (const auto& event : run["events"]) {
      if (event["message"].get<std::string>().find(text) != std::string::npos) return true;
    }
    return false;
  }
};

}  // namespace fogbench::system_tests
