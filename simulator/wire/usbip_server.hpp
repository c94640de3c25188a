#pragma once
// The bench's USB instruments at TCP, as `usbip list` and `usbip attach` want them. A device that
// is attached, or whose plug is out, is not listed and cannot be imported. When it is unplugged its
// connection is closed, which detaches it at the host; after it has been plugged in again the host
// attaches it anew.

#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "simulator/wire/connection.hpp"
#include "simulator/wire/tcp_listener.hpp"
#include "simulator/wire/usbip_session.hpp"

namespace fogbench::simulator {

struct ExportedDevice {
  std::string bus_id;
  std::unique_ptr<UsbDevice> device;
};

class UsbipServer final : public Server {
 public:
  static constexpr std::size_t kMostConnections = 32;

  UsbipServer(TcpListener listener, std::vector<ExportedDevice> devices)
      : listener_(std::move(listener)), devices_(std::move(devices)) {}

  void enlist(drivers::PollSet& set) const override;
  void serve(const drivers::PollSet& happened) override;

 private:
  struct Host {
    explicit Host(drivers::FileDescriptor descriptor)
        : connection(std::move(descriptor), kUsbipHeaderBytes + kMostTransferBytes) {}
    Connection connection;
    UsbDevice* device = nullptr;  ///< imported
    std::optional<UsbipSession> session;
    bool closing = false;  ///< as soon as all has been sent
  };

  void accept();
  /// False when the connection is to be closed.
  bool serve(Host& host, const drivers::PollSet& happened);
  bool answer_requests(Host& host);
  bool import(Host& host, const std::string& bus_id);
  bool take_commands(Host& host);
  bool advance(Host& host);
  bool available(const UsbDevice& device) const;

  TcpListener listener_;
  std::vector<ExportedDevice> devices_;
  std::list<Host> hosts_;
};

}  // namespace fogbench::simulator
