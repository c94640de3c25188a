// What a client of the served controller sends, on TCP and on a serial line.

#include "simulator/wire/modbus_protocol.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace fogbench::fuzz {
namespace {

using namespace simulator;  // NOLINT(google-build-using-namespace)

void parse_content(ByteView content) {
  if (content.empty()) return;
  const ModbusParsed parsed = parse_modbus_request(content);
  if (parsed.exception != 0) {
    require(encode_modbus_exception(content[0], parsed.exception).size() == 2);
    return;
  }
  const ModbusRequest& request = parsed.request;
  require(request.count >= 1 && request.count <= 125);
  const bool reads = request.function == ModbusFunction::kReadRegisters;
  require(request.values.size() == (reads ? 0 : request.count));
  const std::vector<std::uint16_t> values(reads ? request.count : 0);
  require(encode_modbus_answer(request, values).size() <= 253);
}

}  // namespace
}  // namespace fogbench::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;             // NOLINT(google-build-using-namespace)
  using namespace fogbench::simulator;  // NOLINT(google-build-using-namespace)
  const ByteView bytes(data, size);
  fuzz::parse_content(bytes);
  for (ByteView rest = bytes;;) {
    const auto frame = parse_modbus_tcp(rest);
    if (!frame || !*frame) break;
    fuzz::require((*frame)->size > 0 && (*frame)->size <= rest.size());
    fuzz::require(!(*frame)->content.empty());
    fuzz::parse_content((*frame)->content);
    rest = rest.subspan((*frame)->size);
  }
  if (const auto whole = modbus_rtu_request_size(bytes)) fuzz::require(*whole >= 4);
  if (const auto frame = parse_modbus_rtu(bytes)) fuzz::parse_content(frame->content);
  if (size > 0 && size < 250) {
    // What is framed comes out of the frame again.
    const auto framed = encode_modbus_rtu(7, bytes);
    const auto back = parse_modbus_rtu(framed);
    fuzz::require(
        back && back->unit == 7 &&
        std::equal(bytes.begin(), bytes.end(), back->content.begin(), back->content.end()));
  }
  return 0;
}
