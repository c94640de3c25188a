#include "config/device.hpp"

#include <algorithm>
#include <cctype>

#include "config/describe_device.hpp"
#include "config/nearest_name.hpp"
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
    const bool scaled = check_scale(at, field.scale);
    return claim(at / "offset_bytes", field.offset_bytes, size_of(field.type), field.name) &&
           scaled;
  }

 private:
  std::vector<std::string> owner_;
  std::string_view whole_;
};

template <class Named>
bool check_unique(const Place& at, const std::vector<Named>& list) {
  bool ok = true;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto same = [&](const Named& before) { return before.name == list[i].name; };
    if (std::any_of(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(i), same)) {
      ok = (at / i / "name").wrong("a name that does not stand twice");
    }
  }
  return ok;
}

template <class Named>
const Named* find_named(const std::vector<Named>& list, std::string_view name) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Named& n) { return n.name == name; });
  return found == list.end() ? nullptr : &*found;
}

template <class Named, class Names>
bool check_has(const Place& at, const std::vector<Named>& list, const Names& names) {
  std::vector<std::string> missing;
  for (const std::string_view name : names) {
    if (find_named(list, name) == nullptr) missing.push_back(fmt::format("\"{}\"", name));
  }
  return missing.empty() || at.fail(fmt::format("has no {}; expected {}", fmt::join(missing, ", "),
                                                fmt::join(names, ", ")));
}

/// Of a thermostat: what its driver cannot do without, and what it uses where it is there.
constexpr std::array<std::string_view, 8> kNeededRegisters = {"temperature_working_1",
                                                              "temperature_working_2",
                                                              "temperature_control",
                                                              "temperature_ambient",
                                                              "target",
                                                              "mode",
                                                              "boost_power",
                                                              "normal_power"};
constexpr std::array<std::string_view, 2> kFurtherRegisters = {"working_target", "status"};

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

bool check_mode_names(const Place& at, const std::map<std::string, double>& modes) {
  constexpr std::array<std::string_view, 3> kModes = {"off", "boost", "normal"};
  bool ok = true;
  for (const auto& [name, value] : modes) {
    if (std::find(kModes.begin(), kModes.end(), name) == kModes.end()) {
      ok = (at / name).fail("unknown mode; expected off, boost and normal");
    }
    for (const auto& [other, its] : modes) {
      if (other < name && its == value) {
        ok = (at / name).wrong(fmt::format("a number that differs from that of {}", other));
      }
    }
  }
  for (const std::string_view name : kModes) {
    if (!modes.contains(std::string(name))) {
      ok = at.fail(fmt::format("has no \"{}\"; expected off, boost and normal", name));
    }
  }
  return ok;
}

bool check_mode_values(const Place& at, const ModbusDevice& device, const RegisterSpec& mode) {
  bool ok = true;
  for (const auto& [name, value] : device.modes) {
    if (!fits(mode.type, (value - mode.offset) / mode.scale)) {
      ok = (at / name).wrong("a number that the register mode can hold");
    }
  }
  return ok;
}

/// A supply's self test swings its output to the maximum and magnetises the gyro's shield.
bool check_no_self_test(const Place& at, std::string command) {
  std::transform(command.begin(), command.end(), command.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return command.find("TST") == std::string::npos ||
         at.wrong("no self test: it swings the output to its maximum");
}

}  // namespace

bool check_names(const Place& at, const ModbusDevice& d) {
  std::vector<std::string_view> known(kNeededRegisters.begin(), kNeededRegisters.end());
  known.insert(known.end(), kFurtherRegisters.begin(), kFurtherRegisters.end());
  const bool whole = std::all_of(kNeededRegisters.begin(), kNeededRegisters.end(), [&](auto name) {
    return find_named(d.registers, name) != nullptr;
  });
  bool ok = true;
  for (std::size_t i = 0; i < d.registers.size(); ++i) {
    const std::string& name = d.registers[i].name;
    if (name.empty() || std::find(known.begin(), known.end(), name) != known.end()) continue;
    // Where nothing lacks, a register more is for people to look at.
    const std::string_view near = nearest_name(name, known);
    const bool misspelt = !near.empty() && find_named(d.registers, near) == nullptr;
    if (!misspelt && whole) continue;
    ok = (at / "registers" / i / "name")
             .fail(fmt::format("unknown register \"{}\"; {}", name,
                               misspelt ? fmt::format("did you mean \"{}\"?", near)
                                        : fmt::format("known: {}", fmt::join(known, ", "))));
  }
  if (!d.registers.empty()) {
    ok = check_has(at / "registers", d.registers, kNeededRegisters) && ok;
  }
  if (!d.modes.empty()) ok = check_mode_names(at / "modes", d.modes) && ok;
  return ok;
}

bool check(const Place& at, const ModbusDevice& d) {
  const Place registers = at / "registers";
  bool ok = check_unique(registers, d.registers);
  for (std::size_t i = 0; i < d.registers.size(); ++i) {
    ok = check_register(registers / i, d, i) && ok;
  }
  for (std::size_t i = 0; i < d.registers.size(); ++i) {
    const RegisterSpec& r = d.registers[i];
    const bool commanded = r.name == "target" || r.name == "mode";
    if (commanded && r.access != Access::kReadWrite) {
      ok = (registers / i / "access").wrong("\"read_write\": it is written and read back");
    } else if (r.access == Access::kWrite) {
      ok = (registers / i / "access").wrong("a register that can be read");
    }
  }
  if (d.target_minimum >= d.target_maximum) {
    ok = (at / "target_minimum_c")
             .wrong(fmt::format("less than target_maximum_c {}", d.target_maximum.value));
  }
  const RegisterSpec* const mode = find_named(d.registers, "mode");
  return (mode == nullptr || check_mode_values(at / "modes", d, *mode)) && ok;
}

bool check(const Place& at, const ScpiDevice& d) {
  bool ok = d.set.find("{value}") != std::string::npos ||
            (at / "set").wrong("a command with {value} where the number goes");
  ok = check_scale(at, d.scale) && ok;
  const StatedUnit* const unit = find_unit(d.unit);
  const bool current = unit != nullptr && unit->dimension == Dimension::kCurrent;
  if (d.minimum >= d.maximum) {
    ok = (at / "minimum").wrong(fmt::format("less than the maximum {}", d.maximum));
  } else if (current && (d.minimum > 0 || d.maximum < 0)) {
    ok = (at / (d.minimum > 0 ? "minimum" : "maximum"))
             .wrong("a range with 0 A in it, where the safe state is");
  }
  if (d.output_on.empty() != d.output_off.empty()) {
    ok = (at / (d.output_on.empty() ? "output_on" : "output_off"))
             .wrong("output_on and output_off both, or neither");
  }
  const Place initialise = at / "initialise";
  for (std::size_t i = 0; i < d.initialise.size(); ++i) {
    ok = check_no_self_test(initialise / i, d.initialise[i]) && ok;
  }
  return ok;
}

bool is_invertible(const std::array<std::array<double, 3>, 3>& m) {
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return std::isfinite(determinant) && std::abs(determinant) > 1e-3;
}

/// The count of reports and the status enter as they come: there is nothing to scale.
bool check_counts(const Place& fields, const std::vector<FieldSpec>& list) {
  bool ok = true;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const FieldSpec& f = list[i];
    if ((f.name == "sequence" || f.name == "status") && (f.scale != 1.0 || f.offset != 0.0)) {
      ok = (fields / i / (f.scale != 1.0 ? "scale" : "offset"))
               .wrong(fmt::format("none: {} is a count", f.name));
    }
  }
  return ok;
}

bool check(const Place& at, const HidDevice& d) {
  const Place fields = at / "fields";
  constexpr std::array<std::string_view, 3> kAxes = {"field_x", "field_y", "field_z"};
  bool ok = check_unique(fields, d.fields);
  ok = check_counts(fields, d.fields) && ok;
  ok = check_has(fields, d.fields, kAxes) && ok;
  Layout layout(d.report_bytes, "report");
  ok = layout.claim(at / "report_id", 0, 1, "the report id") && ok;
  for (std::size_t i = 0; i < d.fields.size(); ++i) {
    ok = layout.claim(fields / i, d.fields[i]) && ok;
  }
  return ok;
}

bool check_frame_rate(const Place& at, const FrameDevice& d) {
  const double most = d.baud / 10.0 / d.frame_bytes;  // start bit, 8 bits, stop bit
  return d.frame_rate_hz <= most ||
         (at / "frame_rate_hz")
             .wrong(fmt::format("at most {:.1f}: {} bytes a frame at {} bits a second", most,
                                d.frame_bytes, d.baud));
}

bool check_sequence(const Place& at, const FrameDevice& d) {
  const bool counts = d.sequence_type == NumberType::kUint8 ||
                      d.sequence_type == NumberType::kUint16 ||
                      d.sequence_type == NumberType::kUint32;
  if (!counts) return (at / "sequence_type").wrong("uint8, uint16 or uint32: it counts");
  const std::uint64_t most = std::uint64_t{1} << (8 * size_of(d.sequence_type));
  return d.sequence_modulus <= most ||
         (at / "sequence_modulus").wrong(fmt::format("at most {}, or a wider sequence_type", most));
}

bool check_crc(const Place& crc, const FrameDevice& d) {
  const std::uint8_t width = d.crc.width_bits;
  if (width != 8 && width != 16 && width != 32) return (crc / "width_bits").wrong("8, 16 or 32");
  const std::uint64_t values = std::uint64_t{1} << width;
  bool ok = true;
  for (const auto& [key, value] :
       {std::pair{"polynomial", d.crc.polynomial}, std::pair{"initial", d.crc.initial},
        std::pair{"final_xor", d.crc.final_xor}}) {
    if (value >= values) ok = (crc / key).wrong(fmt::format("a number of {} bits", width));
  }
  if (d.crc.polynomial == 0) ok = (crc / "polynomial").wrong("a number other than 0");
  const std::size_t covered_end = std::size_t{d.crc.first_byte} + d.crc.count_bytes;
  const std::size_t value_end = d.crc.offset_bytes + width / 8U;
  if (covered_end > d.frame_bytes) {
    ok = (crc / "count_bytes").wrong("the check to cover bytes of the frame only");
  } else if (d.crc.first_byte < value_end && d.crc.offset_bytes < covered_end) {
    ok = (crc / "count_bytes").wrong("a check that does not cover its own value");
  }
  return ok;
}

bool check(const Place& at, const FrameDevice& d) {
  const Place crc = at / "crc";
  bool ok = check_crc(crc, d);
  ok = check_sequence(at, d) && ok;
  if (d.status_offset_bytes.has_value() != (d.status_valid_mask != 0)) {
    ok = (at / (d.status_offset_bytes ? "status_valid_mask" : "status_offset_bytes"))
             .wrong("status_offset_bytes and a status_valid_mask other than 0, or neither");
  }
  Layout layout(d.frame_bytes, "frame");
  ok = layout.claim(at / "header", 0, d.header.size(), "the header") && ok;
  ok = layout.claim(at / "rate", d.rate) && ok;
  if (d.status_offset_bytes) {
    ok = layout.claim(at / "status_offset_bytes", *d.status_offset_bytes, 1, "the status") && ok;
  }
  ok = layout.claim(at / "sequence_offset_bytes", d.sequence_offset_bytes, size_of(d.sequence_type),
                    "the sequence") &&
       ok;
  ok = layout.claim(crc / "offset_bytes", d.crc.offset_bytes, d.crc.width_bits / 8U,
                    "the check value") &&
       ok;
  if (d.temperature) ok = layout.claim(at / "temperature", *d.temperature) && ok;
  const Place others = at / "others";
  for (std::size_t i = 0; i < d.others.size(); ++i) {
    ok = layout.claim(others / i, d.others[i]) && ok;
  }
  return check_frame_rate(at, d) && ok;
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
