// fogbench device: instruments as data. `check` reads a description, `probe` (device_probe.cpp)
// meets the instrument.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/describe_device.hpp"
#include "cli/output.hpp"
#include "config/codec.hpp"
#include "config/describe_device.hpp"
#include "config/describe_device_file.hpp"

namespace fogbench::cli {
namespace {

struct CheckOptions {
  std::string device;
  bool json = false;
};

Result<ExitStatus> run_check(const CheckOptions& options) {
  const auto device = read_device(options.device);
  if (!device) return device.error();
  if (options.json) {
    print_json(config::Codec<config::DeviceFile>::write(*device));
  } else {
    fmt::print("{}", description_text(*device));
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_device(CLI::App& app, Action& action) {
  CLI::App* device = app.add_subcommand(
      "device", "Check an instrument's description, or look at the instrument through it");
  device->require_subcommand(1);
  add_command<CheckOptions>(
      *device, action, "check", "Say what a description says, or everything that is wrong in it",
      "  fogbench device check my-controller.json\n"
      "  fogbench device check thermostat-eurotherm",
      [](CLI::App& command, CheckOptions& options) {
        command.add_option("DEVICE", options.device, "Device file, or the name of a ready one")
            ->required();
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_check);
  add_device_probe(*device, action);
}

}  // namespace fogbench::cli
