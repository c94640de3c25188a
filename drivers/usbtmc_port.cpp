#include "drivers/usbtmc_port.hpp"

#include <fmt/format.h>

#include <chrono>

#include "drivers/libusb_device.hpp"
#include "drivers/process_lock.hpp"
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
  UsbtmcPort(const config::UsbConnection& connection, InstrumentLock lock, Clock& clock)
      : lock_(std::move(lock)),
        conversation_(clock, [connection]() -> Result<std::unique_ptr<Conversation>> {
          auto usb = open_libusb_device(connection);
          if (!usb) return usb.error();
          auto conversation = std::make_unique<Conversation>(std::move(*usb));
          // Whoever spoke last may have been killed in the middle of a message.
          if (Status cleared = conversation->talk.clear();
              !cleared && cleared.error().code == ErrorCode::kUnplugged) {
            return cleared.error();
          }
          return conversation;
        }) {}

  Status write(std::string_view message) override {
    return with([&](Usbtmc& talk) { return talk.write(message, kTransferTimeout); });
  }
  Result<std::string> read(Clock::Duration timeout) override {
    return with([&](Usbtmc& talk) { return talk.read(timeout); });
  }
  Status clear() override {
    return with([](Usbtmc& talk) { return talk.clear(); });
  }
  void write_last(std::string_view message) noexcept override {
    conversation_.last_words([&](Conversation& last) { last.talk.write_last(message); });
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

  InstrumentLock lock_;
  Reconnecting<Conversation> conversation_;
};

}  // namespace

Result<std::unique_ptr<MessageTransport>> open_usbtmc(const config::UsbConnection& connection,
                                                      Clock& clock) {
  auto lock = lock_instrument({name_of(connection)});
  if (!lock) return lock.error();
  return Result<std::unique_ptr<MessageTransport>>(
      std::make_unique<UsbtmcPort>(connection, std::move(*lock), clock));
}

}  // namespace fogbench::drivers
