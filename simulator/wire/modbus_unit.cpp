#include "simulator/wire/modbus_unit.hpp"

namespace fogbench::simulator {

ModbusAnswer ModbusUnit::execute(ByteView content) {
  const ModbusParsed parsed = parse_modbus_request(content);
  const ModbusRequest& request = parsed.request;
  ModbusAnswer answer{.due = clock_.now()};
  if (parsed.exception != 0) {
    answer.content = encode_modbus_exception(content[0], parsed.exception);
    return answer;
  }
  std::vector<std::uint16_t> values(request.count);
  const Status done = request.function == ModbusFunction::kReadRegisters
                          ? far_end_.read_registers(request.address, values)
                          : far_end_.write_registers(request.address, request.values);
  answer.due = busy_until_ = clock_.take_due();
  answer.spoilt = !done && done.error().code == ErrorCode::kProtocol;
  if (done || answer.spoilt) {
    answer.content = encode_modbus_answer(request, values);
  } else if (const int exception = far_end_.last_exception(); exception != 0) {
    answer.content = encode_modbus_exception(content[0], static_cast<std::uint8_t>(exception));
  } else {
    answer.gone = done.error().code == ErrorCode::kUnplugged;
  }
  return answer;
}

}  // namespace fogbench::simulator
