#include "simulator/wire/usbip_protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulator/random.hpp"

namespace fogbench::simulator {
namespace {

using ::testing::HasSubstr;

Bytes words(std::initializer_list<std::uint32_t> values) {
  Bytes out;
  for (const std::uint32_t value : values) append_be32(out, value);
  return out;
}

Bytes submit(std::uint32_t sequence, std::uint32_t direction, std::uint32_t endpoint,
             std::uint32_t length) {
  Bytes out = words({1, sequence, 0x10002, direction, endpoint, 0, length, 0, 0, 0});
  out.resize(kUsbipHeaderBytes);
  return out;
}

TEST(UsbipRequest, TakesAListAndAnImport) {
  const Bytes list{0x01, 0x11, 0x80, 0x05, 0, 0, 0, 0};
  auto request = parse_usbip_request(list);
  ASSERT_TRUE(request && *request);
  EXPECT_EQ((*request)->operation, UsbipOperation::kList);
  EXPECT_EQ((*request)->size, 8U);

  Bytes import{0x01, 0x11, 0x80, 0x03, 0, 0, 0, 0, '1', '-', '2'};
  import.resize(40);
  request = parse_usbip_request(import);
  ASSERT_TRUE(request && *request);
  EXPECT_EQ((*request)->operation, UsbipOperation::kImport);
  EXPECT_EQ((*request)->bus_id, "1-2");
  EXPECT_EQ((*request)->size, 40U);
}

TEST(UsbipRequest, WaitsForTheRestOfAHalfOne) {
  Bytes whole{0x01, 0x11, 0x80, 0x03};
  whole.resize(40);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto request = parse_usbip_request(ByteView(whole).first(size));
    ASSERT_TRUE(request) << size;
    EXPECT_FALSE(*request) << size;
  }
}

TEST(UsbipRequest, RefusesAnotherVersionOrOperation) {
  auto request = parse_usbip_request(Bytes{0x01, 0x06, 0x80, 0x05, 0, 0, 0, 0});
  ASSERT_FALSE(request);
  EXPECT_THAT(request.error().message, HasSubstr("version 0x0106, expected 0x0111"));
  request = parse_usbip_request(Bytes{0x01, 0x11, 0x80, 0x07, 0, 0, 0, 0});
  ASSERT_FALSE(request);
  EXPECT_THAT(request.error().message, HasSubstr("operation 0x8007"));
}

TEST(UsbipCommand, TakesAControlTransferApart) {
  Bytes bytes = submit(7, 1, 0, 18);
  const Bytes setup{0x80, 6, 0x00, 0x01, 0, 0, 18, 0};
  std::copy(setup.begin(), setup.end(), bytes.begin() + 40);
  const auto command = parse_usbip_command(bytes);
  ASSERT_TRUE(command && *command);
  EXPECT_FALSE((*command)->unlink);
  EXPECT_EQ((*command)->sequence, 7U);
  EXPECT_TRUE((*command)->in);
  EXPECT_EQ((*command)->endpoint, 0);
  EXPECT_EQ((*command)->length, 18U);
  EXPECT_EQ((*command)->size, 48U);
  EXPECT_EQ((*command)->setup.request_type, 0x80);
  EXPECT_EQ((*command)->setup.request, 6);
  EXPECT_EQ((*command)->setup.value, 0x0100);
  EXPECT_EQ((*command)->setup.length, 18);
}

TEST(UsbipCommand, WaitsForTheDataOfATransferOut) {
  Bytes bytes = submit(8, 0, 1, 5);
  for (int missing = 5; missing > 0; --missing, bytes.push_back(0xAA)) {
    const auto command = parse_usbip_command(bytes);
    ASSERT_TRUE(command);
    EXPECT_FALSE(*command) << missing;
  }
  const auto command = parse_usbip_command(bytes);
  ASSERT_TRUE(command && *command);
  EXPECT_EQ((*command)->size, 53U);
}

TEST(UsbipCommand, TakesAnUnlink) {
  Bytes bytes = words({2, 9, 0x10002, 0, 0, 8});
  bytes.resize(kUsbipHeaderBytes);
  const auto command = parse_usbip_command(bytes);
  ASSERT_TRUE(command && *command);
  EXPECT_TRUE((*command)->unlink);
  EXPECT_EQ((*command)->sequence, 9U);
  EXPECT_EQ((*command)->unlinked, 8U);
}

TEST(UsbipCommand, RefusesWhatNoHostSends) {
  const auto refusal = [](const Bytes& bytes) {
    const auto command = parse_usbip_command(bytes);
    return command ? std::string() : command.error().message;
  };
  Bytes unknown = submit(1, 0, 0, 0);
  unknown[3] = 5;
  EXPECT_THAT(refusal(unknown), HasSubstr("command 5"));
  EXPECT_THAT(refusal(submit(1, 2, 0, 0)), HasSubstr("direction 2"));
  EXPECT_THAT(refusal(submit(1, 0, 16, 0)), HasSubstr("endpoint 16"));
  EXPECT_THAT(refusal(submit(1, 1, 1, kMostTransferBytes + 1)), HasSubstr("262145 bytes"));
  EXPECT_THAT(refusal(submit(1, 0, 1, 0xFFFFFFFF)), HasSubstr("4294967295 bytes"));
  Bytes isochronous = submit(1, 1, 1, 8);
  isochronous[35] = 4;
  EXPECT_THAT(refusal(isochronous), HasSubstr("4 isochronous packets"));
  Bytes told_none = submit(1, 1, 1, 8);
  std::fill(told_none.begin() + 32, told_none.begin() + 36, 0xFF);
  EXPECT_EQ(refusal(told_none), "");
}

TEST(UsbipCommand, AnyBytesAreACommandOrRefusedOrIncomplete) {
  RandomEngine random(1);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes(random() % 120);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (bytes.size() >= 4 && i % 2 == 0) {
      std::fill(bytes.begin(), bytes.begin() + 3, 0);
      bytes[3] = static_cast<std::uint8_t>(1 + i % 4 / 2);
    }
    const auto command = parse_usbip_command(bytes);
    if (command && *command) {
      EXPECT_LE((*command)->size, bytes.size());
    }
    const auto request = parse_usbip_request(bytes);
    if (request && *request) {
      EXPECT_LE((*request)->size, bytes.size());
    }
  }
}

UsbipDevice supply() {
  return {.bus_id = "1-2",
          .bus_number = 1,
          .device_number = 3,
          .vendor_id = 0x1209,
          .product_id = 0x0002,
          .device_release = 0x0100,
          .interface_class = {0xFE, 0x03, 0x01}};
}

TEST(UsbipAnswer, ListsADeviceWithItsInterface) {
  const Bytes list = encode_device_list(std::array{supply()});
  ASSERT_EQ(list.size(), 12U + 312U + 4U);
  EXPECT_EQ(be32_at(list, 0), 0x01110005U);
  EXPECT_EQ(be32_at(list, 4), 0U);  // status
  EXPECT_EQ(be32_at(list, 8), 1U);  // devices
  EXPECT_STREQ(reinterpret_cast<const char*>(list.data() + 12 + 256), "1-2");
  EXPECT_EQ(be32_at(list, 12 + 288), 1U);  // bus
  EXPECT_EQ(be32_at(list, 12 + 292), 3U);  // device
  EXPECT_EQ(be32_at(list, 12 + 296), 3U);  // high speed
  EXPECT_EQ(be16_at(list, 12 + 300), 0x1209);
  EXPECT_EQ(be16_at(list, 12 + 302), 0x0002);
  EXPECT_EQ(Bytes(list.end() - 10, list.end()), (Bytes{0, 0, 0, 1, 1, 1, 0xFE, 0x03, 0x01, 0}));
}

TEST(UsbipAnswer, ARefusedImportSendsTheStatusAlone) {
  EXPECT_EQ(encode_import(UsbipImportStatus::kNoDevice, supply()), words({0x01110003, 4}));
  EXPECT_EQ(encode_import(UsbipImportStatus::kOk, supply()).size(), 8U + 312U);
}

TEST(UsbipAnswer, ATransferInCarriesItsDataAndOneOutItsCount) {
  UsbipCommand command{.sequence = 5, .in = true};
  Bytes answer = encode_submitted(command, 0, 3, Bytes{1, 2, 3});
  ASSERT_EQ(answer.size(), 51U);
  EXPECT_EQ(Bytes(answer.begin(), answer.begin() + 28), words({3, 5, 0, 0, 0, 0, 3}));
  EXPECT_EQ(Bytes(answer.end() - 3, answer.end()), (Bytes{1, 2, 3}));
  command.in = false;
  answer = encode_submitted(command, kUsbStall, 7, {});
  ASSERT_EQ(answer.size(), 48U);
  EXPECT_EQ(be32_at(answer, 20), 0xFFFFFFE0U);
  EXPECT_EQ(be32_at(answer, 24), 7U);
}

}  // namespace
}  // namespace fogbench::simulator
