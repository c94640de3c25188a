#include "drivers/usbtmc_port.hpp"

#include <fmt/format.h>

#include <chrono>

#include "drivers/libusb_device.hpp"
#include "drivers/reconnect.hpp"
#include "drivers/usbtmc.hpp"

namespace fogbench::drivers {
namespace {

constexpr Clock::Duration kTransferTimeout = std::chrono::seconds{1};

struct Conversation {
  explicit Conversation(std::unique_ptr<UsbBulk> opened) : usb(std::move(opened)), talk(*usb) {}
  std::unique_ptr<UsbBulk> usb;
  Usbtmc talk;
};

class UsbtmcPort final : public MessageTransport {
 public:
  UsbtmcPort(const config::UsbConnection& connection, Clock& clock)
      : conversation_(clock, [connection]() -> Result<std::unique_ptr<Conversation>> {
          auto usb = open_libusb_device(connection);
          if (!usb) return usb.error();
          return std::make_unique<Conversation>(std::move(*usb));
        }) {}

  Status reach() {
    const auto reached = conversation_.get();
    return reached ? Status{} : reached.error();
  }
  Status write(std::string_view message) override {
    return with([&](Usbtmc& talk) { return talk.write(message, kTransferTimeout); });
  }
  Result<std::string> read(Clock::Duration timeout) override {
    return with([&](Usbtmc& talk) { return talk.read(timeout); });
  }
  Status clear() override {
    return with([](Usbtmc& talk) { return talk.clear(); });
  }

 private:
  template <class Action>
  auto with(Action action) -> decltype(action(std::declval<Usbtmc&>())) {
    const auto conversation = conversation_.get();
    if (!conversation) return conversation.error();
    auto outcome = action((*conversation)->talk);
    if (!outcome && outcome.error().code == ErrorCode::kUnplugged) conversation_.lost();
    return outcome;
  }

  Reconnecting<Conversation> conversation_;
};

}  // namespace

Result<std::unique_ptr<MessageTransport>> open_usbtmc(const config::UsbConnection& connection,
                                                      Clock& clock) {
  auto port = std::make_unique<UsbtmcPort>(connection, clock);
  if (const Status reached = port->reach(); !reached) return reached.error();
  return Result<std::unique_ptr<MessageTransport>>(std::move(port));
}

}  // namespace fogbench::drivers
