#include "simulator/wire/modbus_protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulator/random.hpp"

namespace fogbench::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ModbusRequest, TakesTheThreeFunctionsApart) {
  ModbusParsed parsed = parse_modbus_request(Bytes{3, 0x80, 0x02, 0, 4});
  EXPECT_EQ(parsed.exception, 0);
  EXPECT_EQ(parsed.request.address, 0x8002);
  EXPECT_EQ(parsed.request.count, 4);

  parsed = parse_modbus_request(Bytes{6, 0, 2, 0x12, 0x34});
  EXPECT_EQ(parsed.exception, 0);
  EXPECT_THAT(parsed.request.values, ElementsAre(0x1234));

  parsed = parse_modbus_request(Bytes{16, 0, 2, 0, 2, 4, 0x41, 0x20, 0, 1});
  EXPECT_EQ(parsed.exception, 0);
  EXPECT_EQ(parsed.request.count, 2);
  EXPECT_THAT(parsed.request.values, ElementsAre(0x4120, 1));
}

TEST(ModbusRequest, RefusesAsTheStandardSays) {
  const auto exception = [](const Bytes& bytes) { return parse_modbus_request(bytes).exception; };
  EXPECT_EQ(exception({1, 0, 0, 0, 1}), kIllegalFunction) << "coils";
  EXPECT_EQ(exception({43}), kIllegalFunction);
  EXPECT_EQ(exception({3, 0, 0, 0, 0}), kIllegalValue) << "nothing";
  EXPECT_EQ(exception({3, 0, 0, 0, 126}), kIllegalValue) << "too much";
  EXPECT_EQ(exception({3, 0, 0}), kIllegalValue) << "half a request";
  EXPECT_EQ(exception({6, 0, 0, 0}), kIllegalValue);
  EXPECT_EQ(exception({16, 0, 0, 0, 2, 4, 0, 0, 0}), kIllegalValue) << "a value is missing";
  EXPECT_EQ(exception({16, 0, 0, 0, 2, 2, 0, 0}), kIllegalValue) << "count and bytes disagree";
  EXPECT_EQ(exception({3, 0xFF, 0xFF, 0, 2}), kIllegalAddress) << "past the last register";
}

TEST(ModbusAnswer, EchoesAWriteAndCarriesWhatWasRead) {
  const ModbusRequest read{.function = ModbusFunction::kReadRegisters, .address = 1, .count = 2};
  EXPECT_EQ(encode_modbus_answer(read, {0x0102, 0x0304}), (Bytes{3, 4, 1, 2, 3, 4}));
  const ModbusRequest one{
      .function = ModbusFunction::kWriteRegister, .address = 2, .count = 1, .values = {0x1234}};
  EXPECT_EQ(encode_modbus_answer(one, {0}), (Bytes{6, 0, 2, 0x12, 0x34}));
  const ModbusRequest many{
      .function = ModbusFunction::kWriteRegisters, .address = 2, .count = 2, .values = {1, 2}};
  EXPECT_EQ(encode_modbus_answer(many, {}), (Bytes{16, 0, 2, 0, 2}));
  EXPECT_EQ(encode_modbus_exception(16, kIllegalAddress), (Bytes{0x90, 2}));
}

TEST(ModbusTcp, FramesAreWholeOrAwaited) {
  const Bytes bytes = encode_modbus_tcp(0xABCD, 1, Bytes{3, 0, 1, 0, 1});
  EXPECT_EQ(bytes, (Bytes{0xAB, 0xCD, 0, 0, 0, 6, 1, 3, 0, 1, 0, 1}));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto frame = parse_modbus_tcp(ByteView(bytes).first(size));
    ASSERT_TRUE(frame) << size;
    EXPECT_FALSE(*frame) << size;
  }
  const auto frame = parse_modbus_tcp(bytes);
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->transaction, 0xABCD);
  EXPECT_EQ((*frame)->unit, 1);
  EXPECT_THAT((*frame)->content, ElementsAre(3, 0, 1, 0, 1));
  EXPECT_EQ((*frame)->size, bytes.size());
}

TEST(ModbusTcp, WhatIsNoModbusIsAnError) {
  EXPECT_FALSE(parse_modbus_tcp(Bytes{'G', 'E', 'T', ' ', '/', ' ', 'H'}));
  EXPECT_FALSE(parse_modbus_tcp(Bytes{0, 1, 0, 0, 0, 1, 1})) << "no function";
  EXPECT_FALSE(parse_modbus_tcp(Bytes{0, 1, 0, 0, 0xFF, 0xFF, 1})) << "oversized";
}

TEST(ModbusRtu, TheCheckValueIsTheStandards) {
  // Modbus over serial line 1.02, appendix B: 02 07 has the check value 1241, low byte first.
  EXPECT_EQ(encode_modbus_rtu(2, Bytes{7}), (Bytes{0x02, 0x07, 0x41, 0x12}));
  const auto frame = parse_modbus_rtu(Bytes{0x02, 0x07, 0x41, 0x12});
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->unit, 2);
  EXPECT_THAT(frame->content, ElementsAre(7));
  EXPECT_FALSE(parse_modbus_rtu(Bytes{0x02, 0x07, 0x41, 0x13}));
  EXPECT_FALSE(parse_modbus_rtu(Bytes{0x02, 0x07, 0x41}));
  EXPECT_FALSE(parse_modbus_rtu({}));
}

TEST(ModbusRtu, KnowsTheLengthOfTheRequestsThatItKnows) {
  EXPECT_FALSE(modbus_rtu_request_size(Bytes{1}));
  EXPECT_EQ(modbus_rtu_request_size(Bytes{1, 3}), 8U);
  EXPECT_EQ(modbus_rtu_request_size(Bytes{1, 6}), 8U);
  EXPECT_FALSE(modbus_rtu_request_size(Bytes{1, 16, 0, 2, 0, 2}));
  EXPECT_EQ(modbus_rtu_request_size(Bytes{1, 16, 0, 2, 0, 2, 4}), 13U);
  EXPECT_FALSE(modbus_rtu_request_size(Bytes{1, 43, 14, 1, 0})) << "silence ends it";
}

TEST(Modbus, AnyBytesAreTakenWithoutHarm) {
  RandomEngine random(1);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes(1 + random() % 40);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (i % 2 == 0) bytes[0] = std::array<std::uint8_t, 3>{3, 6, 16}[random() % 3];
    const ModbusParsed parsed = parse_modbus_request(bytes);
    if (parsed.exception == 0) {
      EXPECT_GE(parsed.request.count, 1);
      EXPECT_LE(parsed.request.count, 125);
    }
    const auto frame = parse_modbus_tcp(bytes);
    if (frame && *frame) {
      EXPECT_LE((*frame)->size, bytes.size());
    }
    (void)modbus_rtu_request_size(bytes);
    (void)parse_modbus_rtu(bytes);
  }
}

}  // namespace
}  // namespace fogbench::simulator
