#pragma once
// The bytes of Modbus requests and answers (Modbus Application Protocol V1.1b3), and the header
// that TCP puts in front of them. Pure functions; whatever arrives, they do not read past it.
//
//   request, answer    unit  function  data              RTU adds a check value behind them
//   TCP                transaction (2)  0 0  length (2)  then the same

#include <cstdint>
#include <span>
#include <vector>

#include "config/result.hpp"

namespace fogbench::drivers::modbus {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::size_t kTcpHeaderBytes = 6;

/// Function 3, read holding registers.
Bytes encode_read(std::uint8_t unit, std::uint16_t address, std::size_t count);
/// Function 16, write multiple registers.
Bytes encode_write(std::uint8_t unit, std::uint16_t address, std::span<const std::uint16_t> values);
/// How many registers such a request is about.
std::size_t register_count(const Bytes& request);
/// With TCP's header in front.
Bytes encode_tcp(std::uint16_t transaction, const Bytes& request);

/// The answer to the request with this number, without TCP's header. kProtocol for any other.
Result<Bytes> decode_tcp(std::uint16_t transaction, std::span<const std::uint8_t> bytes);

/// That it is the answer to this request, an exception included: kProtocol for another unit,
/// function, count or address.
Status check_answer(const Bytes& request, const Bytes& answer);

// Precondition: the answer has been checked.
/// What an exception says: kBusy for one that only asks for time, else kDevice, both with its
/// number. Success when it is none.
Status exception_in(const Bytes& answer);
/// Precondition: no exception, and out.size() registers were asked for.
void take_registers(const Bytes& answer, std::span<std::uint16_t> out);

}  // namespace fogbench::drivers::modbus
