#include "simulator/wire/usbip_server.hpp"

#include <algorithm>

namespace fogbench::simulator {
namespace {

constexpr std::uint32_t kBus = 1;

UsbipDevice describe(const ExportedDevice& exported, std::size_t index) {
  const UsbDescription& description = exported.device->description();
  return {.bus_id = exported.bus_id,
          .bus_number = kBus,
          .device_number = static_cast<std::uint32_t>(index + 2),  // 1 is the hub.
          .vendor_id = description.identity.vendor_id,
          .product_id = description.identity.product_id,
          .device_release = kUsbDeviceRelease,
          .interface_class = description.interface_class};
}

}  // namespace

void UsbipServer::enlist(drivers::PollSet& set) const {
  listener_.enlist(set);
  for (const Host& host : hosts_) {
    host.connection.enlist(set);
    if (host.session && !host.connection.congested()) set.wake_at(host.session->next());
  }
}

void UsbipServer::serve(const drivers::PollSet& happened) {
  for (auto host = hosts_.begin(); host != hosts_.end();) {
    host = serve(*host, happened) ? std::next(host) : hosts_.erase(host);
  }
  accept();
}

void UsbipServer::accept() {
  while (drivers::FileDescriptor descriptor = listener_.accept()) {
    // One too many is closed at once.
    if (hosts_.size() < kMostConnections) hosts_.emplace_back(std::move(descriptor));
  }
}

bool UsbipServer::serve(Host& host, const drivers::PollSet& happened) {
  if (host.device != nullptr && !host.device->plugged()) return false;
  if (!host.connection.receive(happened) || !host.connection.flush()) return false;
  if (host.closing) return host.connection.unsent() > 0;
  if (!answer_requests(host)) return false;
  return !host.session || (advance(host) && take_commands(host));
}

bool UsbipServer::answer_requests(Host& host) {
  while (!host.session && !host.closing) {
    const auto parsed = parse_usbip_request(host.connection.input());
    if (!parsed) return false;
    if (!*parsed) return true;
    const UsbipRequest& request = **parsed;
    host.connection.drop_input(request.size);
    if (request.operation == UsbipOperation::kImport) return import(host, request.bus_id);
    std::vector<UsbipDevice> listed;
    for (std::size_t i = 0; i < devices_.size(); ++i) {
      if (available(*devices_[i].device)) listed.push_back(describe(devices_[i], i));
    }
    host.closing = true;
    if (!host.connection.send(encode_device_list(listed))) return false;
  }
  return !host.closing || host.connection.unsent() > 0;
}

bool UsbipServer::import(Host& host, const std::string& bus_id) {
  const auto found =
      std::find_if(devices_.begin(), devices_.end(),
                   [&](const ExportedDevice& device) { return device.bus_id == bus_id; });
  const bool here = found != devices_.end() && found->device->plugged();
  if (!here || !available(*found->device)) {
    host.closing = true;
    const auto status = here ? UsbipImportStatus::kBusy : UsbipImportStatus::kNoDevice;
    return host.connection.send(encode_import(status, {})) && host.connection.unsent() > 0;
  }
  host.device = found->device.get();
  host.session.emplace(*host.device);
  const auto index = static_cast<std::size_t>(found - devices_.begin());
  return host.connection.send(encode_import(UsbipImportStatus::kOk, describe(*found, index)));
}

bool UsbipServer::advance(Host& host) {
  if (host.connection.congested()) return true;
  Bytes out;
  return host.session->advance(out) && host.connection.send(out);
}

bool UsbipServer::take_commands(Host& host) {
  while (!host.connection.congested()) {
    const ByteView input = host.connection.input();
    const auto parsed = parse_usbip_command(input);
    if (!parsed) return false;
    if (!*parsed) return true;
    const UsbipCommand& command = **parsed;
    const ByteView all = input.first(command.size);
    if (!host.session->take(command, all.subspan(kUsbipHeaderBytes))) return false;
    host.connection.drop_input(command.size);
    if (!advance(host)) return false;
  }
  return true;
}

bool UsbipServer::available(const UsbDevice& device) const {
  return device.plugged() && std::none_of(hosts_.begin(), hosts_.end(),
                                          [&](const Host& host) { return host.device == &device; });
}

}  // namespace fogbench::simulator
