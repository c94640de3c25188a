#include "simulator/wire/modbus_tcp_server.hpp"

namespace fogbench::simulator {

void ModbusTcpServer::enlist(drivers::PollSet& set) const {
  if (listener_) listener_->enlist(set);
  for (const Client& client : clients_) {
    client.connection.enlist(set);
    if (!client.answer.empty()) set.wake_at(client.due);
    // A request that waits for another client's to end, or for its own rest.
    if (client.answer.empty() && !client.connection.input().empty() &&
        unit_.busy_until() > clock_.now()) {
      set.wake_at(unit_.busy_until());
    }
  }
}

void ModbusTcpServer::serve(const drivers::PollSet& happened) {
  if (!unit_.plugged()) {
    clients_.clear();
    listener_.reset();
    return;
  }
  if (!listener_) {
    Result<TcpListener> again = TcpListener::open(address_, port_);
    if (!again) return;  // At the next turn, perhaps.
    listener_.emplace(*std::move(again));
  }
  for (auto client = clients_.begin(); client != clients_.end();) {
    client = serve(*client, happened) ? std::next(client) : clients_.erase(client);
  }
  while (drivers::FileDescriptor descriptor = listener_->accept()) {
    // One too many is closed at once.
    if (clients_.size() < kMostConnections) clients_.emplace_back(std::move(descriptor));
  }
}

bool ModbusTcpServer::serve(Client& client, const drivers::PollSet& happened) {
  Connection& connection = client.connection;
  if (!connection.receive(happened) || !connection.flush()) return false;
  while (!connection.congested()) {
    if (!client.answer.empty()) {
      if (clock_.now() < client.due) return true;
      if (!connection.send(std::exchange(client.answer, {}))) return false;
    }
    if (clock_.now() < unit_.busy_until()) return true;
    const auto parsed = parse_modbus_tcp(connection.input());
    if (!parsed) return false;
    if (!*parsed) return true;
    connection.drop_input((*parsed)->size);
    if (!execute(client, **parsed)) return false;
  }
  return true;
}

bool ModbusTcpServer::execute(Client& client, const ModbusFrame& frame) {
  // The messaging guide's ways to say "whoever listens here", beside the unit's own number.
  constexpr std::uint8_t kNobodyElse = 0xFF;
  if (frame.unit != unit_.id() && frame.unit != kNobodyElse && frame.unit != 0) return true;
  const ModbusAnswer answer = unit_.execute(frame.content);
  if (answer.content.empty()) return !answer.gone;
  // TCP checks the bytes itself: what is broken is to whom the answer belongs.
  const auto transaction = static_cast<std::uint16_t>(frame.transaction ^ (answer.spoilt ? 1 : 0));
  client.answer = encode_modbus_tcp(transaction, frame.unit, answer.content);
  client.due = answer.due;
  return true;
}

}  // namespace fogbench::simulator
