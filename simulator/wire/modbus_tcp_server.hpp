#pragma once
// The thermostat controller on Modbus TCP. While it is unplugged nobody can connect, and whoever
// was connected is not any more.

#include <list>
#include <optional>

#include "simulator/wire/connection.hpp"
#include "simulator/wire/modbus_unit.hpp"
#include "simulator/wire/tcp_listener.hpp"

namespace fogbench::simulator {

class ModbusTcpServer final : public Server {
 public:
  static constexpr std::size_t kMostConnections = 16;

  /// `unit` and `clock` must outlive the server. `address` is where `listener` listens.
  ModbusTcpServer(TcpListener listener, std::string address, ModbusUnit& unit,
                  const drivers::Clock& clock)
      : listener_(std::move(listener)),
        address_(std::move(address)),
        port_(listener_->port()),
        unit_(unit),
        clock_(clock) {}

  void enlist(drivers::PollSet& set) const override;
  void serve(const drivers::PollSet& happened) override;

 private:
  struct Client {
    explicit Client(drivers::FileDescriptor descriptor)
        : connection(std::move(descriptor), kMostInput) {}
    static constexpr std::size_t kMostInput = 1024;
    Connection connection;
    Bytes answer;  ///< on its way until `due`
    drivers::Clock::Instant due{};
  };

  /// False when the connection is to be closed.
  bool serve(Client& client, const drivers::PollSet& happened);
  /// False when it pulled the plug.
  bool execute(Client& client, const ModbusFrame& frame);

  std::optional<TcpListener> listener_;  ///< none while unplugged
  const std::string address_;
  const std::uint16_t port_;
  ModbusUnit& unit_;
  const drivers::Clock& clock_;
  std::list<Client> clients_;
};

}  // namespace fogbench::simulator
