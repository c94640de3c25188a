#include "tests/system/far_bench/client.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "tests/support/source_tree.hpp"

namespace fogbench::far_bench {
namespace {

using support::Process;

std::string built(const char* program) {
  return (tests::build_tree() / program).string();
}

/// The bench expects another supply than there is.
void expect_identity(const std::string& bench_file, const std::string& device_file,
                     const std::string& identity) {
  auto bench = nlohmann::ordered_json::parse(support::read_text(bench_file));
  auto device = nlohmann::ordered_json::parse(
      support::read_text(bench["coil_vertical"]["device"].get<std::string>()));
  device.erase("$schema");
  device["identity"] = identity;
  std::ofstream(device_file) << device.dump(2);
  bench["coil_vertical"]["device"] = device_file;
  std::ofstream(bench_file) << bench.dump(2);
}

}  // namespace

std::vector<std::string> hid_stand_in(const std::filesystem::path& folder, int usbip_port) {
  // To the loader a blank ends a path, and the clone may lie below a folder with one in its name.
  const std::filesystem::path library = folder / "hid_stand_in.so";
  std::error_code is_there_already;
  std::filesystem::create_symlink(built("hid_stand_in.so"), library, is_there_already);
  return {"LD_PRELOAD=" + library.string(), "FOGBENCH_TEST_USBIP=" + std::to_string(usbip_port)};
}

FarBench::FarBench(double boost, const std::string& identity)
    : process_({built("far_bench"), folder_.path().string(), std::to_string(boost)}) {
  if (!process_.wait_for_output("\n", std::chrono::seconds{60})) {
    ADD_FAILURE() << "no far ends: " << process_.wait(std::chrono::seconds{1}).err;
    return;
  }
  usbip_port_ = std::stoi(process_.output().substr(std::string("ready ").size()));
  if (!identity.empty()) {
    expect_identity(path("bench.json"), path("coil_vertical.json"), identity);
  }
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path("control").copy(address.sun_path, sizeof address.sun_path - 1);
  control_ = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  EXPECT_EQ(connect(control_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
}

FarBench::~FarBench() {
  close(control_);
}

std::string FarBench::ask(const std::string& request) {
  std::array<char, 4096> answer;
  EXPECT_GT(send(control_, request.data(), request.size(), MSG_NOSIGNAL), 0);
  const ssize_t count = recv(control_, answer.data(), answer.size(), 0);
  EXPECT_GT(count, 0) << request;
  return {answer.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
}

std::unique_ptr<Process> FarBench::daemon(const std::vector<std::string>& environment,
                                          const std::vector<std::string>& procedures) const {
  std::vector<std::string> command{built("fogbenchd"), "--bench", path("bench.json"), "--store",
                                   path("store.db")};
  if (procedures.empty()) {
    command.insert(command.end(), {"--socket", path("daemon.sock")});
  } else {
    command.insert(command.end(), procedures.begin(), procedures.end());
  }
  Process::Setup setup{environment, {}};
  const auto stand_in = hid_stand_in(folder_.path(), usbip_port_);
  setup.environment.insert(setup.environment.end(), stand_in.begin(), stand_in.end());
  // Other benches have instruments of the same names.
  setup.environment.push_back("FOGBENCH_LOCKS=" + folder_.path().string());
  return std::make_unique<Process>(command, setup);
}

support::Finished FarBench::fogbench(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), built("fogbench"));
  arguments.insert(arguments.end(), {"--socket", path("daemon.sock")});
  return support::run(arguments);
}

std::string FarBench::energising_procedure() const {
  return folder_
      .file("energise.json", R"({"name": "energise", "steps": [
  {"step": "set_temperature", "target_c": 50, "mode": "boost"},
  {"step": "compensate_field", "tolerance_ut": 60},
  {"step": "for_each", "variable": "turn", "in": [1, 2, 3, 4, 5, 6], "steps": [
    {"step": "sweep", "axis": "x", "levels_ut": [200, 220, 200, 220], "duration_s": 2,
     "settle_s": 1, "segment": "x", "other_pair_ut": -200}]}]})")
      .string();
}

}  // namespace fogbench::far_bench
