#include "drivers/modbus_messages.hpp"

#include <gtest/gtest.h>

#include <array>

namespace fogbench::drivers::modbus {
namespace {

const Bytes kRead = encode_read(17, 0x6B, 2);
const std::array<std::uint16_t, 2> kValues{0x000A, 0x0102};
const Bytes kWrite = encode_write(17, 1, kValues);

// The examples of the application protocol V1.1b3, sections 6.3 and 6.12.
TEST(ModbusMessages, RequestsAreThoseOfTheStandard) {
  EXPECT_EQ(kRead, (Bytes{17, 3, 0, 0x6B, 0, 2}));
  EXPECT_EQ(kWrite, (Bytes{17, 16, 0, 1, 0, 2, 4, 0, 0x0A, 1, 2}));
  EXPECT_EQ(register_count(kRead), 2U);
  EXPECT_EQ(register_count(kWrite), 2U);
  EXPECT_EQ(encode_tcp(0x1501, kRead), (Bytes{0x15, 1, 0, 0, 0, 6, 17, 3, 0, 0x6B, 0, 2}));
}

TEST(ModbusMessages, ATcpAnswerIsThatOfItsTransaction) {
  const Bytes framed = encode_tcp(7, {17, 3, 2, 1, 2});
  EXPECT_EQ(*decode_tcp(7, framed), (Bytes{17, 3, 2, 1, 2}));
  EXPECT_EQ(decode_tcp(8, framed).error().code, ErrorCode::kProtocol);
  Bytes other = framed;
  other[3] = 5;
  EXPECT_EQ(decode_tcp(7, other).error().code, ErrorCode::kProtocol) << "another protocol";
  for (std::size_t size = 0; size < kTcpHeaderBytes; ++size) {
    EXPECT_FALSE(decode_tcp(7, std::span(framed).first(size))) << size;
  }
}

TEST(ModbusMessages, AnAnswerIsTakenOnlyForItsOwnRequest) {
  EXPECT_TRUE(check_answer(kRead, {17, 3, 4, 0, 1, 0, 2}));
  EXPECT_TRUE(check_answer(kRead, {17, 0x83, 6}));
  EXPECT_TRUE(check_answer(kWrite, {17, 16, 0, 1, 0, 2}));
  EXPECT_TRUE(check_answer(kWrite, {17, 0x90, 2}));
  const Bytes none;
  for (const Bytes& other :
       {none, Bytes{17, 3}, Bytes{18, 3, 4, 0, 1, 0, 2}, Bytes{17, 4, 4, 0, 1, 0, 2},
        Bytes{17, 3, 2, 0, 1}, Bytes{17, 3, 4, 0, 1, 0}, Bytes{17, 3, 6, 0, 1, 0, 2, 0, 3},
        Bytes{17, 0x90, 2}, Bytes{18, 0x83, 6}, Bytes{17, 0x83, 6, 0}}) {
    const Status taken = check_answer(kRead, other);
    ASSERT_FALSE(taken);
    EXPECT_EQ(taken.error().code, ErrorCode::kProtocol);
  }
  for (const Bytes& other :
       {Bytes{17, 16, 0, 2, 0, 2}, Bytes{17, 16, 0, 1, 0, 1}, Bytes{17, 16, 0, 1, 0}, kWrite}) {
    EXPECT_FALSE(check_answer(kWrite, other));
  }
}

TEST(ModbusMessages, RegistersComeHighByteFirst) {
  std::array<std::uint16_t, 2> out{};
  take_registers({17, 3, 4, 1, 2, 0xFF, 0xFE}, out);
  EXPECT_EQ(out, (std::array<std::uint16_t, 2>{0x0102, 0xFFFE}));
  EXPECT_TRUE(exception_in({17, 3, 4, 1, 2, 0xFF, 0xFE}));
}

}  // namespace
}  // namespace fogbench::drivers::modbus
