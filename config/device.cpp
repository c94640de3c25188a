#include "config/device.hpp"

#include <algorithm>
#include <cctype>

#include "config/describe_device.hpp"
#include "config/stated_unit.hpp"

namespace fogbench::config {
namespace {

std::size_t size_of(NumberType type) {
  switch (type) {
    case NumberType::kUint8:
    case NumberType::kInt8:
      return 1;
    case NumberType::kUint16:
    case NumberType::kInt16:
      return 2;
    default:
      return 4;
  }
}

/// A scale of zero would make every reading the same.
bool check_scale(const Place& at, double scale) {
  return scale != 0.0 || (at / "scale").wrong("a number other than 0");
}

/// Named bytes of a report or a frame: inside it, and no byte used twice.
class Layout {
 public:
  Layout(std::size_t bytes, std::string_view whole) : owner_(bytes), whole_(whole) {}

  bool claim(const Place& at, std::size_t first, std::size_t count, const std::string& name) {
    if (first + count > owner_.size()) {
      return at.wrong(fmt::format("{} at bytes {}...{} to lie inside the {} of {} bytes", name,
                                  first, first + count - 1, whole_, owner_.size()));
    }
    for (std::size_t i = first; i < first + count; ++i) {
      if (!owner_[i].empty()) {
        return at.fail(fmt::format("{} takes byte {}, which {} has already", name, i, owner_[i]));
      }
      owner_[i] = name;
    }
    return true;
  }
  bool claim(const Place& at, const FieldSpec& field) {
    return check_scale(at, field.scale) &&
           claim(at / "offset_bytes", field.offset_bytes, size_of(field.type), field.name);
  }

 private:
  std::vector<std::string> owner_;
  std::string_view whole_;
};

template <class Named>
bool check_unique(const Place& at, const std::vector<Named>& list) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (list[i].name == list[j].name) {
        return (at / i / "name").wrong("a name that does not stand twice");
      }
    }
  }
  return true;
}

template <class Named>
const Named* find_named(const std::vector<Named>& list, std::string_view name) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Named& n) { return n.name == name; });
  return found == list.end() ? nullptr : &*found;
}

template <class Named>
bool check_has(const Place& at, const std::vector<Named>& list,
               std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    if (find_named(list, name) == nullptr) {
      return at.fail(fmt::format("has no \"{}\"; expected {}", name, fmt::join(names, ", ")));
    }
  }
  return true;
}

bool check_register(const Place& at, const ModbusDevice& device, std::size_t index) {
  const RegisterSpec& r = device.registers[index];
  const std::size_t words = size_of(r.type) / 2;
  if (words == 0) return (at / "type").wrong("a type of 16 or 32 bits");
  if (device.even_counts_only && words != 2) {
    return (at / "type").wrong("a type of 32 bits, as even_counts_only demands");
  }
  if (r.address + words > 65536) return (at / "address").wrong("an address inside 0...65535");
  if (r.minimum && r.maximum && *r.minimum > *r.maximum) {
    return (at / "minimum").wrong(fmt::format("at most the maximum {}", *r.maximum));
  }
  for (std::size_t i = 0; i < index; ++i) {
    const RegisterSpec& other = device.registers[i];
    if (r.address < other.address + size_of(other.type) / 2 && other.address < r.address + words) {
      return (at / "address").wrong(fmt::format("an address that {} does not use", other.name));
    }
  }
  return check_scale(at, r.scale);
}

/// The largest and smallest raw number of an integer type.
bool fits(NumberType type, double raw) {
  switch (type) {
    case NumberType::kUint16:
      return raw >= 0 && raw <= 65535 && raw == std::floor(raw);
    case NumberType::kInt16:
      return raw >= -32768 && raw <= 32767 && raw == std::floor(raw);
    default:
      return true;
  }
}

bool check_modes(const Place& at, const ModbusDevice& device, const RegisterSpec& mode) {
  constexpr std::array<std::string_view, 3> kModes = {"off", "boost", "normal"};
  for (const auto& [name, value] : device.modes) {
    if (std::find(kModes.begin(), kModes.end(), name) == kModes.end()) {
      return (at / name).fail("unknown mode; expected off, boost and normal");
    }
    if (!fits(mode.type, (value - mode.offset) / mode.scale)) {
      return (at / name).wrong("a number that the register mode can hold");
    }
  }
  for (const std::string_view name : kModes) {
    const auto found = device.modes.find(std::string(name));
    if (found == device.modes.end()) {
      return at.fail(fmt::format("has no \"{}\"; expected off, boost and normal", name));
    }
    for (const auto& [other, value] : device.modes) {
      if (other != name && value == found->second) {
        return (at / name).wrong(fmt::format("a number that differs from that of {}", other));
      }
    }
  }
  return true;
}

/// A supply's self test swings its output to the maximum and magnetises the gyro's shield.
bool check_no_self_test(const Place& at, std::string command) {
  std::transform(command.begin(), command.end(), command.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return command.find("TST") == std::string::npos ||
         at.wrong("no self test: it swings the output to its maximum");
}

}  // namespace

bool check(const Place& at, const ModbusDevice& d) {
  const Place registers = at / "registers";
  if (!check_unique(registers, d.registers)) return false;
  bool ok = true;
  for (std::size_t i = 0; i < d.registers.size(); ++i) {
    ok = check_register(registers / i, d, i) && ok;
  }
  if (!ok) return false;
  if (!check_has(registers, d.registers,
                 {"temperature_working_1", "temperature_working_2", "temperature_control",
                  "temperature_ambient", "target", "mode", "boost_power", "normal_power"})) {
    return false;
  }
  for (std::size_t i = 0; i < d.registers.size(); ++i) {
    const RegisterSpec& r = d.registers[i];
    const bool commanded = r.name == "target" || r.name == "mode";
    if (commanded && r.access != Access::kReadWrite) {
      return (registers / i / "access").wrong("\"read_write\": it is written and read back");
    }
    if (r.access == Access::kWrite) {
      return (registers / i / "access").wrong("a register that can be read");
    }
  }
  if (d.target_minimum >= d.target_maximum) {
    return (at / "target_minimum_c")
        .wrong(fmt::format("less than target_maximum_c {}", d.target_maximum.value));
  }
  return check_modes(at / "modes", d, *find_named(d.registers, "mode"));
}

bool check(const Place& at, const ScpiDevice& d) {
  if (d.set.find("{value}") == std::string::npos) {
    return (at / "set").wrong("a command with {value} where the number goes");
  }
  if (!check_scale(at, d.scale)) return false;
  if (d.minimum >= d.maximum) {
    return (at / "minimum").wrong(fmt::format("less than the maximum {}", d.maximum));
  }
  const StatedUnit* const unit = find_unit(d.unit);
  const bool current = unit != nullptr && unit->dimension == Dimension::kCurrent;
  if (current && (d.minimum > 0 || d.maximum < 0)) {
    return (at / (d.minimum > 0 ? "minimum" : "maximum"))
        .wrong("a range with 0 A in it, where the safe state is");
  }
  if (d.output_on.empty() != d.output_off.empty()) {
    return (at / (d.output_on.empty() ? "output_on" : "output_off"))
        .wrong("output_on and output_off both, or neither");
  }
  const Place initialise = at / "initialise";
  for (std::size_t i = 0; i < d.initialise.size(); ++i) {
    if (!check_no_self_test(initialise / i, d.initialise[i])) return false;
  }
  return true;
}

bool is_invertible(const std::array<std::array<double, 3>, 3>& m) {
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return std::isfinite(determinant) && std::abs(determinant) > 1e-3;
}

/// The count of reports and the status enter as they come: there is nothing to scale.
bool check_counts(const Place& fields, const std::vector<FieldSpec>& list) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const FieldSpec& f = list[i];
    if ((f.name == "sequence" || f.name == "status") && (f.scale != 1.0 || f.offset != 0.0)) {
      return (fields / i / (f.scale != 1.0 ? "scale" : "offset"))
          .wrong(fmt::format("none: {} is a count", f.name));
    }
  }
  return true;
}

bool check(const Place& at, const HidDevice& d) {
  const Place fields = at / "fields";
  if (!check_unique(fields, d.fields) || !check_counts(fields, d.fields)) return false;
  if (!check_has(fields, d.fields, {"field_x", "field_y", "field_z"})) return false;
  Layout layout(d.report_bytes, "report");
  if (!layout.claim(at / "report_id", 0, 1, "the report id")) return false;
  for (std::size_t i = 0; i < d.fields.size(); ++i) {
    if (!layout.claim(fields / i, d.fields[i])) return false;
  }
  return true;
}

bool check_frame_rate(const Place& at, const FrameDevice& d) {
  const double most = d.baud / 10.0 / d.frame_bytes;  // start bit, 8 bits, stop bit
  return d.frame_rate_hz <= most ||
         (at / "frame_rate_hz")
             .wrong(fmt::format("at most {:.1f}: {} bytes a frame at {} bits a second", most,
                                d.frame_bytes, d.baud));
}

bool check(const Place& at, const FrameDevice& d) {
  const Place crc = at / "crc";
  const std::uint8_t width = d.crc.width_bits;
  if (width != 8 && width != 16 && width != 32) return (crc / "width_bits").wrong("8, 16 or 32");
  const std::uint64_t values = std::uint64_t{1} << width;
  for (const auto& [key, value] :
       {std::pair{"polynomial", d.crc.polynomial}, std::pair{"initial", d.crc.initial},
        std::pair{"final_xor", d.crc.final_xor}}) {
    if (value >= values) return (crc / key).wrong(fmt::format("a number of {} bits", width));
  }
  if (d.crc.polynomial == 0) return (crc / "polynomial").wrong("a number other than 0");

  Layout layout(d.frame_bytes, "frame");
  if (!layout.claim(at / "header", 0, d.header.size(), "the header") ||
      !layout.claim(at / "rate", d.rate) ||
      !layout.claim(at / "status_offset_bytes", d.status_offset_bytes, 1, "the status") ||
      !layout.claim(at / "sequence_offset_bytes", d.sequence_offset_bytes, 1, "the sequence") ||
      !layout.claim(crc / "offset_bytes", d.crc.offset_bytes, width / 8U, "the check value")) {
    return false;
  }
  if (d.temperature && !layout.claim(at / "temperature", *d.temperature)) return false;
  const Place others = at / "others";
  for (std::size_t i = 0; i < d.others.size(); ++i) {
    if (!layout.claim(others / i, d.others[i])) return false;
  }
  const std::size_t covered_end = std::size_t{d.crc.first_byte} + d.crc.count_bytes;
  const std::size_t value_end = d.crc.offset_bytes + width / 8U;
  if (covered_end > d.frame_bytes) {
    return (crc / "count_bytes").wrong(fmt::format("the check to cover bytes of the frame only"));
  }
  if (d.crc.first_byte < value_end && d.crc.offset_bytes < covered_end) {
    return (crc / "count_bytes").wrong("a check that does not cover its own value");
  }
  return check_frame_rate(at, d);
}

bool Codec<std::vector<std::uint8_t>>::read(const Place& at, std::vector<std::uint8_t>& out,
                                            const Rule& /*rule*/) {
  out.clear();
  std::string digits;
  if (at.value().is_string()) {
    for (const char c : at.value().get_ref<const std::string&>()) {
      if (c != ' ') digits += c;
    }
  }
  const bool hexadecimal = std::all_of(digits.begin(), digits.end(),
                                       [](unsigned char c) { return std::isxdigit(c) != 0; });
  if (digits.empty() || !hexadecimal || digits.size() % 2 != 0 || digits.size() > 512) {
    return at.wrong("bytes in hexadecimal, such as \"FE 81 FF 55\"");
  }
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    out.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  }
  return true;
}

ordered_json Codec<std::vector<std::uint8_t>>::schema(const Rule& /*rule*/) {
  return {{"type", "string"}, {"pattern", "^ *([0-9A-Fa-f] *[0-9A-Fa-f] *)+$"}};
}

ordered_json Codec<std::vector<std::uint8_t>>::write(const std::vector<std::uint8_t>& bytes) {
  return fmt::format("{:02X}", fmt::join(bytes, " "));
}

bool Codec<MagnetometerCalibration>::read(const Place& at, MagnetometerCalibration& out,
                                          const Rule& /*rule*/) {
  if (!at.value().is_object()) return at.wrong("an object");
  ObjectReader reader(at);
  describe(reader, out);
  if (!reader.finish()) return false;
  return is_invertible(out.matrix) ||
         (at / "matrix").fail("cannot be inverted; expected a matrix near the unit matrix");
}

ordered_json Codec<MagnetometerCalibration>::schema(const Rule& /*rule*/) {
  HidDevice identity;
  MagnetometerCalibration calibration{identity.calibration_offset_ut, identity.calibration_matrix};
  SchemaWriter writer;
  describe(writer, calibration);
  return writer.finish();
}

ordered_json Codec<MagnetometerCalibration>::write(const MagnetometerCalibration& calibration) {
  ObjectWriter writer;
  MagnetometerCalibration copy = calibration;
  describe(writer, copy);
  return writer.finish();
}

}  // namespace fogbench::config
