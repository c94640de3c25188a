// A stand-in for libhidapi, which LD_PRELOAD puts before it: the HID devices that a simulated bench
// exports, taken from its USB/IP server at 127.0.0.1:$FOGBENCH_TEST_USBIP as a kernel would take
// them. What the devices send is what they send to any host; only the kernel and hidapi are left
// out. Shares no line with the server.

#include <arpa/inet.h>
#include <hidapi.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <string>
#include <vector>

namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::uint8_t kHidClass = 3;
constexpr std::size_t kOperation = 8, kBusId = 32;
/// Path, bus id, numbers: struct usbip_usb_device of the kernel's documentation.
constexpr std::size_t kDevice = 312, kBusIdAt = 256, kVendorAt = 300, kProductAt = 302;
constexpr std::size_t kHeader = 48;
constexpr std::uint32_t kReportBytes = 1024;
constexpr std::uint8_t kSerialIndex = 3;  // of strings, as the device descriptor says

void put16(Bytes& out, unsigned value) {
  out.push_back(static_cast<unsigned char>(value >> 8U));
  out.push_back(static_cast<unsigned char>(value));
}
void put32(Bytes& out, std::uint32_t value) {
  put16(out, value >> 16U);
  put16(out, value & 0xFFFFU);
}
unsigned get16(const Bytes& from, std::size_t at) {
  return static_cast<unsigned>(from[at] << 8U | from[at + 1]);
}
std::uint32_t get32(const Bytes& from, std::size_t at) {
  return get16(from, at) << 16U | get16(from, at + 2);
}

/// A connection to the server; every wait is bounded.
class Server {
 public:
  Server() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const char* const port = std::getenv("FOGBENCH_TEST_USBIP");
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(static_cast<std::uint16_t>(port == nullptr ? 0 : std::atoi(port)));
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{2, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&where), sizeof where) != 0) hang_up();
  }
  Server(Server&& other) noexcept : socket_(other.socket_) { other.socket_ = -1; }
  Server& operator=(Server&&) = delete;
  ~Server() { hang_up(); }

  bool send(const Bytes& bytes) {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }
  /// Empty when it does not come.
  Bytes receive(std::size_t count) {
    Bytes bytes(count);
    const ssize_t got = recv(socket_, bytes.data(), count, MSG_WAITALL);
    if (got != static_cast<ssize_t>(count)) bytes.clear();
    return bytes;
  }
  bool readable(int milliseconds) const {
    pollfd ready{socket_, POLLIN, 0};
    return poll(&ready, 1, milliseconds) > 0;
  }

  /// OP_REQ_IMPORT: from now on this connection is the device's.
  bool import(const std::string& bus_id) {
    Bytes request;
    put16(request, 0x0111);
    put16(request, 0x8003);
    put32(request, 0);
    request.insert(request.end(), bus_id.begin(), bus_id.end());
    request.resize(kOperation + kBusId);
    if (!send(request)) return false;
    const Bytes answer = receive(kOperation);
    return !answer.empty() && get32(answer, 4) == 0 && !receive(kDevice).empty();
  }
  /// CMD_SUBMIT of a transfer to the host.
  bool submit(std::uint32_t sequence, std::uint32_t endpoint, std::uint32_t length,
              const Bytes& setup = Bytes(8)) {
    Bytes command;
    for (const std::uint32_t word : {1U, sequence, 0U, 1U, endpoint, 0U, length, 0U, 0U, 0U}) {
      put32(command, word);
    }
    command.insert(command.end(), setup.begin(), setup.end());
    return send(command);
  }
  /// What it brought; false when the device is gone.
  bool submitted(Bytes& data) {
    const Bytes answer = receive(kHeader);
    if (answer.empty() || get32(answer, 20) != 0) return false;
    const std::uint32_t actual = get32(answer, 24);
    data = receive(actual);
    return data.size() == actual;
  }

 private:
  void hang_up() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }
  int socket_;
};

struct Exported {
  std::string bus_id;
  unsigned vendor = 0, product = 0;
  bool is_hid = false;
};

std::vector<Exported> exported() {
  std::vector<Exported> all;
  Server server;
  Bytes request;
  put16(request, 0x0111);
  put16(request, 0x8005);
  put32(request, 0);
  if (!server.send(request)) return all;
  const Bytes answer = server.receive(kOperation + 4);
  if (answer.empty()) return all;
  for (std::uint32_t i = get32(answer, kOperation); i > 0; --i) {
    const Bytes device = server.receive(kDevice + 4);
    if (device.empty()) break;
    all.push_back({reinterpret_cast<const char*>(device.data()) + kBusIdAt,
                   get16(device, kVendorAt), get16(device, kProductAt),
                   device[kDevice] == kHidClass});
  }
  return all;
}

/// GET_DESCRIPTOR of the serial number, ASCII in UTF-16.
std::wstring serial_of(const std::string& bus_id) {
  Server server;
  Bytes text;
  if (!server.import(bus_id) ||
      !server.submit(1, 0, 255, {0x80, 6, kSerialIndex, 3, 0x09, 0x04, 255, 0}) ||
      !server.submitted(text)) {
    return {};
  }
  std::wstring serial;
  for (std::size_t i = 2; i + 1 < text.size(); i += 2) serial += static_cast<wchar_t>(text[i]);
  return serial;
}

}  // namespace

struct hid_device_ {
  Server server;
  std::uint32_t sequence = 0;
  bool asked = false;  ///< a transfer is under way
};

extern "C" {

hid_device_info* hid_enumerate(unsigned short vendor, unsigned short product) {
  hid_device_info* all = nullptr;
  for (const Exported& device : exported()) {
    if (!device.is_hid || device.vendor != vendor || device.product != product) continue;
    auto* info = static_cast<hid_device_info*>(std::calloc(1, sizeof(hid_device_info)));
    info->path = strdup(device.bus_id.c_str());
    info->serial_number = wcsdup(serial_of(device.bus_id).c_str());
    info->vendor_id = vendor;
    info->product_id = product;
    info->next = all;
    all = info;
  }
  return all;
}

void hid_free_enumeration(hid_device_info* all) {
  while (all != nullptr) {
    hid_device_info* const next = all->next;
    std::free(all->path);
    std::free(all->serial_number);
    std::free(all);
    all = next;
  }
}

hid_device* hid_open_path(const char* path) {
  auto* const device = new hid_device_{{}, 0, false};
  if (device->server.import(path)) return device;
  delete device;
  return nullptr;
}

void hid_close(hid_device* device) {
  delete device;
}

int hid_read_timeout(hid_device* device, unsigned char* data, size_t length, int milliseconds) {
  if (!device->asked && !device->server.submit(++device->sequence, 1, kReportBytes)) return -1;
  device->asked = true;
  if (!device->server.readable(milliseconds)) return 0;
  device->asked = false;
  Bytes report;
  if (!device->server.submitted(report)) return -1;
  const std::size_t count = std::min(length, report.size());
  std::copy_n(report.begin(), count, data);
  return static_cast<int>(count);
}

int hid_write(hid_device*, const unsigned char*, size_t length) {
  return static_cast<int>(length);
}

const wchar_t* hid_error(hid_device*) {
  return L"its connection was closed";
}
}
