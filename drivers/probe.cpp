#include "drivers/probe.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>

#include "config/json_file.hpp"
#include "drivers/crc.hpp"
#include "drivers/frame_parser.hpp"
#include "drivers/frame_rate_meter.hpp"
#include "drivers/number_codec.hpp"
#include "drivers/patience.hpp"
#include "drivers/scpi_dialogue.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;
using config::one_line;

constexpr Clock::Duration kProbePatience = 1s;
/// Half more than the rate takes of a gyro that sends twenty frames a second or more.
constexpr Clock::Duration kRatePatience = 12s;

std::string hex(std::span<const std::uint8_t> bytes) {
  return fmt::format("{:02X}", fmt::join(bytes, " "));
}

void take_value(const Result<double>& value, ProbeRow& row) {
  if (value) {
    row.value = *value;
  } else {
    row.problem = value.error().message;
  }
}

ProbeRow row_of(const FieldSpec& field, ByteOrder order, std::span<const std::uint8_t> bytes) {
  const std::size_t count = byte_count(field.type);
  ProbeRow row{field.name,
               fmt::format("bytes {} ... {}, {}", field.offset_bytes,
                           field.offset_bytes + count - 1, name_of(field.type)),
               {},
               {},
               field.unit,
               {}};
  if (field.offset_bytes + count <= bytes.size()) {
    row.raw = hex(bytes.subspan(field.offset_bytes, count));
  }
  take_value(read_field(field, order, bytes), row);
  return row;
}

/// One question, and nothing that could set something or start a self test.
bool is_question(const std::string& text) {
  std::string upper = text;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return upper.ends_with('?') && upper.find_first_of("; \t\n") == std::string::npos &&
         upper.find("TST") == std::string::npos;
}

ProbeRow ask(const std::string& name, const std::string& question, MessageTransport& transport) {
  ProbeRow row{name, question, {}, {}, {}, {}};
  if (!is_question(question)) {
    row.problem = "is not a single question; not sent";
    return row;
  }
  const Status sent = transport.write(question);
  auto answer = sent ? transport.read(kProbePatience) : Result<std::string>(sent.error());
  if (!answer) {
    row.problem = answer.error().message;
    (void)transport.clear();  // what comes late is not the next question's
    return row;
  }
  row.raw = one_line(*answer);
  return row;
}

/// A question for the value that the instrument sets.
ProbeRow ask_value(const std::string& name, const std::string& question,
                   const config::ScpiDevice& device, MessageTransport& transport) {
  ProbeRow row = ask(name, question, transport);
  row.unit = device.unit;
  if (!row.problem.empty()) return row;
  const auto number = parse_scpi_number(row.raw);
  if (number) {
    row.value = *number * device.scale;
  } else {
    row.problem = "is no number";
  }
  return row;
}

}  // namespace

ProbeReport probe(const config::ModbusDevice& device, ModbusTransport& transport, Clock& clock) {
  ProbeReport report;
  for (const RegisterSpec& spec : device.registers) {
    if (spec.access == config::Access::kWrite) continue;
    ProbeRow row{spec.name, fmt::format("register {}, {}", spec.address, name_of(spec.type)),
                 {},        {},
                 spec.unit, {}};
    std::vector<std::uint16_t> words(word_count(spec.type));
    const Status read = ask_again(Patience(clock, Patience::kForReading),
                                  [&] { return transport.read_registers(spec.address, words); });
    if (read) {
      row.raw = fmt::format("{:04X}", fmt::join(words, " "));
      take_value(read_words(spec, words), row);
      if (row.value && ((spec.minimum && *row.value < *spec.minimum) ||
                        (spec.maximum && *row.value > *spec.maximum))) {
        row.problem = "outside the limits of the description";
      }
    } else {
      row.problem = read.error().message;
    }
    report.rows.push_back(std::move(row));
  }
  return report;
}

ProbeReport probe(const config::ScpiDevice& device, MessageTransport& transport) {
  ProbeReport report;
  report.rows.push_back(ask("identity", "*IDN?", transport));
  ProbeRow& identity = report.rows.back();
  if (identity.problem.empty() && identity.raw.find(device.identity) == std::string::npos) {
    identity.problem = fmt::format("expected {} in it", device.identity);
  }
  report.rows.push_back(ask_value("set", device.set_query, device, transport));
  report.rows.push_back(ask_value("measured", device.measure_query, device, transport));
  report.rows.push_back(ask("oldest error", device.error_query, transport));
  return report;
}

ProbeReport probe(const config::HidDevice& device, HidTransport& transport) {
  ProbeReport report;
  std::vector<std::uint8_t> bytes(device.report_bytes);
  const auto size = transport.read_report(bytes, kProbePatience);
  if (!size) {
    report.rows.push_back({"report", "", {}, {}, {}, size.error().message});
    return report;
  }
  const auto came = std::span(bytes).first(std::min(*size, bytes.size()));
  ProbeRow whole{"report", fmt::format("{} bytes", *size), hex(came), {}, {}, {}};
  if (*size != device.report_bytes) {
    whole.problem = fmt::format("expected {} bytes", device.report_bytes);
  } else if (device.report_id != 0 && bytes[0] != device.report_id) {
    whole.problem = fmt::format("expected report {}", device.report_id);
  }
  report.rows.push_back(std::move(whole));
  for (const FieldSpec& field : device.fields) {
    report.rows.push_back(row_of(field, device.byte_order, came));
  }
  return report;
}

ProbeReport probe(const config::FrameDevice& device, SerialTransport& transport, Clock& clock) {
  ProbeReport report;
  if (const Status layout = check_layout(device); !layout) {
    report.rows.push_back({"layout", "", {}, {}, {}, layout.error().message});
    return report;
  }
  // The parser says what it makes of the stream; the newest frame is found here, with all fields.
  FrameParser parser(device);
  const Crc crc(device.crc);
  std::vector<std::uint8_t> newest;
  std::vector<std::uint8_t> recent;
  GyroBlock block;
  std::string failure;
  FrameRateMeter meter(device.frame_rate_hz);
  const Clock::Instant begun = clock.now();
  const auto goes_on = [&] {
    const Clock::Duration lasted = clock.now() - begun;
    return lasted < kProbePatience ||
           (parser.counted() >= 0 && !meter.rate() && lasted < kRatePatience);
  };
  while (failure.empty() && goes_on()) {
    const std::span<std::byte> space = parser.space();
    const auto count = transport.read_some(space);
    if (!count) {
      failure = count.error().message;
      break;
    }
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(space.data());
    recent.insert(recent.end(), bytes, bytes + *count);
    parser.parse(*count, block);
    if (*count != 0) continue;
    if (parser.counted() >= 0) meter.look(clock.now(), parser.counted());
    clock.sleep_for(5ms);
  }
  parser.settle(std::nullopt, block);
  for (std::size_t at = 0; at + device.frame_bytes <= recent.size();) {
    const std::uint8_t* const place = recent.data() + at;
    const bool good =
        std::equal(device.header.begin(), device.header.end(), place) && crc.holds(place);
    if (good) newest.assign(place, place + device.frame_bytes);
    at += good ? device.frame_bytes : 1;
  }
  const StreamStatistics& s = parser.statistics();
  report.notes.push_back(fmt::format(
      "{} good frames in {:.1f} s, expected about {:.0f}; {} missing, {} with a wrong check value, "
      "{} not valid, {} bytes skipped",
      s.frames_good, to_seconds(clock.now() - begun),
      to_seconds(clock.now() - begun) * device.frame_rate_hz, s.frames_missing,
      s.frames_bad_checksum, s.frames_invalid, s.bytes_skipped));
  if (newest.empty()) {
    const std::size_t shown = std::min<std::size_t>(recent.size(), 32);
    report.rows.push_back(
        {"frame",
         "",
         hex(std::span(recent).first(shown)),
         {},
         {},
         failure.empty() ? "no frame with this header and check value" : failure});
    return report;
  }
  report.rows.push_back({"frame", fmt::format("{} bytes", newest.size()), hex(newest), {}, {}, {}});
  if (const auto rate = meter.rate()) {
    report.rows.push_back(
        {"frame rate",
         "by this machine's clock",
         {},
         rate->measured_hz,
         "Hz",
         rate->as_stated ? ""
                         : fmt::format("expected {} as the description states, "
                                       "within {} %",
                                       device.frame_rate_hz, 100.0 * FrameRateMeter::kTolerance)});
  }
  report.rows.push_back(row_of(device.rate, device.byte_order, newest));
  if (device.temperature) {
    report.rows.push_back(row_of(*device.temperature, device.byte_order, newest));
  }
  for (const FieldSpec& field : device.others) {
    report.rows.push_back(row_of(field, device.byte_order, newest));
  }
  if (device.status_offset_bytes) {
    const std::uint8_t status = newest[*device.status_offset_bytes];
    const bool valid = (status & device.status_valid_mask) == device.status_valid_mask;
    report.rows.push_back({"status",
                           fmt::format("byte {}", *device.status_offset_bytes),
                           fmt::format("{:02X}", status),
                           {},
                           {},
                           valid ? "" : "says that the reading is not valid"});
  }
  FieldSpec counter;
  counter.name = "sequence";
  counter.offset_bytes = device.sequence_offset_bytes;
  counter.type = device.sequence_type;
  ProbeRow sequence = row_of(counter, device.byte_order, newest);
  if (sequence.value && *sequence.value >= static_cast<double>(device.sequence_modulus)) {
    sequence.problem = "is beyond its modulus";
  }
  report.rows.push_back(std::move(sequence));
  return report;
}

ProbeReport probe(AuxiliarySensor& sensor) {
  ProbeReport report;
  const auto identity = sensor.identity();
  report.rows.push_back({"identity",
                         "",
                         identity ? *identity : "",
                         {},
                         {},
                         identity ? "" : identity.error().message});
  const auto values = sensor.read();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string& name = sensor.channels()[i].name;
    ProbeRow row{name, sensor.channels()[i].meaning,       {},
                 {},   std::string(config::unit_of(name)), {}};
    take_value(values[i], row);
    report.rows.push_back(std::move(row));
  }
  return report;
}

}  // namespace fogbench::drivers
