#pragma once
// Looks at one instrument through its description, and changes nothing: only reads, questions and
// listens. No set point is written, nothing is initialised, no self test is asked for. What comes
// is shown raw beside scaled, so that a wrong address, type or word order is seen at a glance.

#include <optional>
#include <string>
#include <vector>

#include "config/device.hpp"
#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// One quantity: what came over the wire, and what it means.
struct ProbeRow {
  std::string name;
  std::string place;  ///< "register 32770", "MEAS:CURR?", "bytes 4 ... 7"
  std::string raw;    ///< as it came: words or bytes in hexadecimal, or text
  std::optional<double> value;
  std::string unit;
  std::string problem;  ///< why there is no value, or what is wrong with it; empty when all is well
};

struct ProbeReport {
  std::vector<ProbeRow> rows;
  std::vector<std::string> notes;  ///< identity, error queue, frames a second
};

/// Every register that may be read, one request each: a refused one does not hide the others. A
/// busy instrument is asked again, as it is in a run.
ProbeReport probe(const config::ModbusDevice& device, ModbusTransport& transport, Clock& clock);
/// Identity, set value, measured value, the oldest entry of the error queue. A description's text
/// that is no single question is not sent.
ProbeReport probe(const config::ScpiDevice& device, MessageTransport& transport);
/// The next input report.
ProbeReport probe(const config::HidDevice& device, HidTransport& transport);
/// A second of the stream, and where frames come as many more as their rate takes to be measured:
/// the newest good frame, what the line carries, and the frames a second by the clock.
ProbeReport probe(const config::FrameDevice& device, SerialTransport& transport, Clock& clock);

/// Every channel of an auxiliary sensor, once.
ProbeReport probe(AuxiliarySensor& sensor);

}  // namespace fogbench::drivers
