// A stand-in for libhidapi, which LD_PRELOAD puts before it: one magnetometer, whose reports come
// over the local socket $FOGBENCH_TEST_HID. It is there while somebody listens on the socket.

#include <hidapi.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <cwchar>

struct hid_device_ {
  int socket;
};

namespace {

constexpr unsigned short kVendor = 0x1209;
constexpr unsigned short kProduct = 0x0001;
constexpr const wchar_t* kSerial = L"SIM-MAG-1";

int connected_socket() {
  const char* path = std::getenv("FOGBENCH_TEST_HID");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path == nullptr || std::strlen(path) >= sizeof address.sun_path) return -1;
  std::memcpy(address.sun_path, path, std::strlen(path));
  const int made = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  if (made >= 0 && connect(made, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    close(made);
    return -1;
  }
  return made;
}

}  // namespace

extern "C" {

hid_device_info* hid_enumerate(unsigned short vendor, unsigned short product) {
  if (vendor != kVendor || product != kProduct) return nullptr;
  const int there = connected_socket();
  if (there < 0) return nullptr;
  close(there);
  auto* info = static_cast<hid_device_info*>(std::calloc(1, sizeof(hid_device_info)));
  info->path = strdup("socket");
  info->serial_number = wcsdup(kSerial);
  info->vendor_id = vendor;
  info->product_id = product;
  return info;
}

void hid_free_enumeration(hid_device_info* all) {
  if (all == nullptr) return;
  std::free(all->path);
  std::free(all->serial_number);
  std::free(all);
}

hid_device* hid_open_path(const char*) {
  const int socket = connected_socket();
  return socket < 0 ? nullptr : new hid_device_{socket};
}

void hid_close(hid_device* device) {
  if (device == nullptr) return;
  close(device->socket);
  delete device;
}

int hid_read_timeout(hid_device* device, unsigned char* data, size_t length, int milliseconds) {
  pollfd ready{device->socket, POLLIN, 0};
  if (poll(&ready, 1, milliseconds) <= 0) return 0;
  const ssize_t count = recv(device->socket, data, length, 0);
  return count > 0 ? static_cast<int>(count) : -1;
}

int hid_write(hid_device*, const unsigned char*, size_t length) {
  return static_cast<int>(length);
}

const wchar_t* hid_error(hid_device*) {
  return L"the socket has hung up";
}
}
