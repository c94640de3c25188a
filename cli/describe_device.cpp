#include "cli/describe_device.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/output.hpp"
#include "config/codec.hpp"
#include "config/describe_device.hpp"
#include "config/device_file.hpp"
#include "config/paths.hpp"
#include "drivers/frame_parser.hpp"
#include "drivers/number_codec.hpp"

namespace fogbench::cli {
namespace {

std::string bounds(const std::optional<double>& minimum, const std::optional<double>& maximum) {
  if (!minimum && !maximum) return "";
  const auto text = [](const std::optional<double>& b) {
    return b ? fmt::format("{}", *b) : std::string("any");
  };
  return fmt::format("{} ... {}", text(minimum), text(maximum));
}

std::string scaling(double scale, double offset) {
  return offset == 0.0 ? fmt::format("{:.9g}", scale)
                       : fmt::format("{:.9g}, from {:.9g}", scale, offset);
}

std::string age(const config::Seconds& max_age, const std::optional<config::Seconds>& stuck) {
  return fmt::format("a reading is stale after {} s{}", max_age.count(),
                     stuck ? fmt::format(", or when it stands still for {} s", stuck->count())
                           : ", and may stand still");
}

std::string fields_text(const std::vector<config::FieldSpec>& fields) {
  using Align = TextTable::Align;
  TextTable table({{"quantity", "", Align::kLeft},
                   {"bytes", ""},
                   {"type", "", Align::kLeft},
                   {"one count", ""},
                   {"unit", "", Align::kLeft}});
  for (const config::FieldSpec& f : fields) {
    table.add_row(
        {f.name,
         fmt::format("{} ... {}", f.offset_bytes, f.offset_bytes + drivers::byte_count(f.type) - 1),
         std::string(drivers::name_of(f.type)), scaling(f.scale, f.offset), f.unit});
  }
  return table.text();
}

std::string describe(const config::ModbusDevice& d) {
  using Align = TextTable::Align;
  TextTable table({{"quantity", "", Align::kLeft},
                   {"register", ""},
                   {"type", "", Align::kLeft},
                   {"one count", ""},
                   {"unit", "", Align::kLeft},
                   {"access", "", Align::kLeft},
                   {"limits", "", Align::kLeft}});
  for (const config::RegisterSpec& r : d.registers) {
    const bool low_first =
        drivers::word_count(r.type) == 2 && r.word_order == config::WordOrder::kLowFirst;
    table.add_row({r.name, fmt::format("{}", r.address),
                   std::string(drivers::name_of(r.type)) + (low_first ? ", low word first" : ""),
                   scaling(r.scale, r.offset), r.unit,
                   config::Codec<config::Access>::write(r.access).get<std::string>(),
                   bounds(r.minimum, r.maximum)});
  }
  std::vector<std::string> modes;
  for (const auto& [name, value] : d.modes) modes.push_back(fmt::format("{} {}", name, value));
  return fmt::format("unit {}{}; set points from {} to {} degC; modes {}; {}\n{}", d.unit_id,
                     d.even_counts_only ? ", even register counts only" : "",
                     d.target_minimum.value, d.target_maximum.value, fmt::join(modes, ", "),
                     age(d.max_age, d.stuck_after), table.text());
}

std::string describe(const config::ScpiDevice& d) {
  using Align = TextTable::Align;
  TextTable table({{"what", "", Align::kLeft}, {"is said as", "", Align::kLeft}});
  const auto add = [&table](const char* what, const std::string& text) {
    if (!text.empty()) table.add_row({what, text});
  };
  add("identity contains", d.identity);
  for (const std::string& text : d.initialise) add("initialise", text);
  add("set", d.set);
  add("what was set", d.set_query);
  add("measured", d.measure_query);
  add("output on", d.output_on);
  add("output off", d.output_off);
  add("oldest error", d.error_query);
  add("busy, asked again", fmt::format("{}", fmt::join(d.busy_errors, ", ")));
  return fmt::format(
      "values from {} to {} {} in steps of {}; a read-back more than {} {} off is an error, valid "
      "{} s after a set\n{}",
      d.minimum, d.maximum, d.unit, d.resolution, d.read_back_tolerance, d.unit, d.settle.count(),
      table.text());
}

std::string describe(const config::HidDevice& d) {
  return fmt::format(
      "USB 0x{:04x}:0x{:04x}; report {} of {} bytes every {} s; fields within +-{} uT; {}\n{}",
      d.vendor_id, d.product_id, d.report_id, d.report_bytes, d.report_period.count(),
      d.range.value, age(d.max_age, d.stuck_after), fields_text(d.fields));
}

std::string describe(const config::FrameDevice& d) {
  std::vector<config::FieldSpec> fields{d.rate};
  if (d.temperature) fields.push_back(*d.temperature);
  fields.insert(fields.end(), d.others.begin(), d.others.end());
  return fmt::format(
      "frames of {} bytes from {:02X}, {} a second at {} baud; sequence 0 ... {}, {} in byte {}, "
      "{}, {} bits of check in byte {}{}\n{}",
      d.frame_bytes, fmt::join(d.header, " "), d.frame_rate_hz, d.baud, d.sequence_modulus - 1,
      drivers::name_of(d.sequence_type), d.sequence_offset_bytes,
      d.status_offset_bytes ? fmt::format("status in byte {}", *d.status_offset_bytes)
                            : std::string("no status"),
      d.crc.width_bits, d.crc.offset_bytes,
      d.stuck_after
          ? fmt::format("; a rate that stands still for {} s is not valid", d.stuck_after->count())
          : "",
      fields_text(fields));
}

template <class Sensor>
std::string describe(const Sensor& sensor) {
  using Align = TextTable::Align;
  TextTable table({{"channel", "", Align::kLeft},
                   {"unit", "", Align::kLeft},
                   {"one count", ""},
                   {"limits", "", Align::kLeft},
                   {"meaning", "", Align::kLeft}});
  for (const config::SensorChannel& c : sensor.channels) {
    table.add_row({c.name, std::string(config::unit_of(c.name)), scaling(c.scale, c.offset),
                   bounds(c.minimum, c.maximum), c.meaning});
  }
  return fmt::format("an auxiliary sensor: each channel is recorded beside the measurement\n{}",
                     table.text());
}

}  // namespace

Result<config::DeviceFile> read_device(const std::string& name) {
  const auto file = config::find_config("devices", name);
  if (!file) return file.error();
  config::DeviceFile device;
  std::vector<Error> problems = config::check_device(*file, device);
  const auto* frame = std::get_if<config::FrameDevice>(&device);
  if (problems.empty() && frame != nullptr) {
    const Status layout = drivers::check_layout(*frame);
    if (!layout) {
      problems.push_back({ErrorCode::kBadInput, file->string() + ": " + layout.error().message});
    }
  }
  if (problems.empty()) return device;
  for (std::size_t i = 0; i + 1 < problems.size(); ++i) print_error(problems[i].message);
  return problems.back();
}

std::string description_text(const config::DeviceFile& device) {
  return std::visit(
      [&](const auto& d) {
        return fmt::format("{}, {}: {}", d.name, kind_of(device), describe(d));
      },
      device);
}

}  // namespace fogbench::cli
