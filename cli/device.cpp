// fogbench device: instruments as data. `check` reads a description, `probe` meets the instrument.

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/describe_device.hpp"
#include "cli/output.hpp"
#include "config/codec.hpp"
#include "config/describe_device.hpp"
#include "config/paths.hpp"
#include "drivers/frame_parser.hpp"

namespace fogbench::cli {
namespace {

struct CheckOptions {
  std::string device;
  bool json = false;
};

/// All problems but the last one are printed here, the last one by main.
Result<config::DeviceFile> read_device(const std::string& name) {
  const auto file = config::find_config("devices", name);
  if (!file) return file.error();
  config::DeviceFile device;
  std::vector<Error> problems = config::check_device(*file, device);
  if (problems.empty()) {
    if (const auto* frame = std::get_if<config::FrameDevice>(&device)) {
      const Status layout = drivers::check_layout(*frame);
      if (!layout)
        problems.push_back({ErrorCode::kBadInput, file->string() + ": " + layout.error().message});
    }
  }
  if (problems.empty()) return device;
  for (std::size_t i = 0; i + 1 < problems.size(); ++i) print_error(problems[i].message);
  return problems.back();
}

Result<ExitStatus> run_check(const CheckOptions& options) {
  const auto device = read_device(options.device);
  if (!device) return device.error();
  if (options.json) {
    print_json(config::Codec<config::DeviceFile>::write(*device));
  } else {
    fmt::print("{}", describe(*device));
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_device(CLI::App& app, Action& action) {
  CLI::App* device = app.add_subcommand("device", "Check the description of an instrument");
  device->require_subcommand(1);
  add_command<CheckOptions>(
      *device, action, "check", "Say what a description says, or everything that is wrong in it",
      "  fogbench device check my-controller.json\n"
      "  fogbench device check thermostat-eurotherm",
      [](CLI::App& command, CheckOptions& options) {
        command.add_option("FILE", options.device, "Device file, or the name of a ready one")
            ->required();
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_check);
}

}  // namespace fogbench::cli
