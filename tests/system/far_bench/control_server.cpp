#include "tests/system/far_bench/control_server.hpp"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

namespace fogbench::far_bench {

using config::FaultKind;
using simulator::MagneticPhysics;

ControlServer::ControlServer(PacketListener listener, const config::BenchConfig& config,
                             simulator::FarEnds& ends, const drivers::Clock& clock)
    : listener_(std::move(listener)), config_(config), ends_(ends), clock_(clock) {
  for (const auto& [name, end, device] :
       {std::tuple{"coil_horizontal", ends_.coil_horizontal.get(), &config.coil_horizontal.device},
        std::tuple{"coil_vertical", ends_.coil_vertical.get(), &config.coil_vertical.device}}) {
    end->on_message([this, &heard = heard_[name], device = device](std::string_view message) {
      const double now_s = ends_.plant->now_s();
      if (message == "CURR 0.000000") {
        heard.zero_at_s = now_s;
        ++heard.zeros;
      }
      if (message == device->measure_query) heard.asked_at_s = now_s;
    });
  }
}

void ControlServer::enlist(drivers::PollSet& set) const {
  listener_.enlist(set);
  for (const drivers::FileDescriptor& client : clients_) set.add(client.get(), POLLIN);
}

void ControlServer::serve(const drivers::PollSet&) {
  while (drivers::FileDescriptor client = listener_.accept()) {
    clients_.push_back(std::move(client));
  }
  std::erase_if(clients_, [&](const drivers::FileDescriptor& client) {
    std::array<char, 256> request;
    const ssize_t count = recv(client.get(), request.data(), request.size(), MSG_DONTWAIT);
    if (count < 0) return errno != EAGAIN;
    if (count == 0) return true;
    const std::string text = answer({request.data(), static_cast<std::size_t>(count)});
    return send(client.get(), text.data(), text.size(), MSG_NOSIGNAL) < 0;
  });
}

std::string ControlServer::answer(const std::string& request) {
  static const std::map<std::string, FaultKind> kKinds = {{"absent", FaultKind::kUnplug},
                                                          {"silent", FaultKind::kTimeout},
                                                          {"garbling", FaultKind::kGarbage},
                                                          {"nan", FaultKind::kNan}};
  std::istringstream words(request);
  std::string verb, device, kind;
  words >> verb >> device >> kind;
  if (verb == "state") return state();
  if (verb == "energise") {
    energise();
    return "done";
  }
  if ((verb == "break" || verb == "mend") && kKinds.contains(kind)) {
    ends_.set_fault(device, kKinds.at(kind), verb == "break");
    return "done";
  }
  return "what";
}

std::string ControlServer::state() {
  ends_.plant->advance();
  const simulator::ThermostatController& controller = ends_.plant->thermostat();
  nlohmann::json all{{"time_s", ends_.plant->now_s()},
                     {"heater_w", controller.power().total_w()},
                     {"heats", controller.mode() != config::HeatingMode::kOff}};
  for (const auto& [name, pair] : {std::pair{"coil_horizontal", MagneticPhysics::kHorizontal},
                                   std::pair{"coil_vertical", MagneticPhysics::kVertical}}) {
    const Heard& heard = heard_[name];
    all[name] = {{"current_a", ends_.plant->magnetic().current_a(pair)},
                 {"zeros", heard.zeros},
                 {"zero_at_s", heard.zero_at_s},
                 {"asked_at_s", heard.asked_at_s}};
  }
  return all.dump();
}

void ControlServer::energise() {
  for (const auto& [end, current] : {std::pair{ends_.coil_horizontal.get(), "CURR 3.000000"},
                                     std::pair{ends_.coil_vertical.get(), "CURR -2.000000"}}) {
    std::ignore = end->write(config_.coil_horizontal.device.output_on);
    std::ignore = end->write(current);
  }
  ends_.plant->thermostat().set_target(config::Celsius{50.0});
  ends_.plant->thermostat().set_mode(config::HeatingMode::kBoost);
}

}  // namespace fogbench::far_bench
