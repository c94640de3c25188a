#include "model/table/choose_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "config/channels.hpp"
#include "config/column_unit.hpp"
#include "config/units.hpp"
#include "model/table/text_fields.hpp"

namespace fogbench::model {
namespace {

using config::Dimension;
using config::StatedUnit;

/// What others call a column: in small letters, without unit, blanks and points as underscores.
struct CommonNames {
  std::string_view wanted;
  Dimension dimension;
  std::vector<std::string_view> names;
};

const std::vector<CommonNames>& common_names() {
  static const std::vector<CommonNames> kNames = {
      {"rate_deg_per_h",
       Dimension::kRate,
       {"rate",
        "gyro",
        "gyro_rate",
        "gyro_x",
        "gyro_y",
        "gyro_z",
        "gyrox",
        "gyroy",
        "gyroz",
        "gx",
        "gy",
        "gz",
        "gyr_x",
        "gyr_y",
        "gyr_z",
        "omega",
        "omega_x",
        "omega_y",
        "omega_z",
        "w",
        "wx",
        "wy",
        "wz",
        "ω",
        "fog",
        "fog_rate",
        "angular_rate",
        "angular_velocity",
        "angular_velocity_x",
        "angular_velocity_y",
        "angular_velocity_z",
        "field_angular_velocity_x",
        "field_angular_velocity_y",
        "field_angular_velocity_z",
        "rotation_rate",
        "rot_rate",
        "drehrate",
        "winkelgeschwindigkeit",
        "угловая_скорость",
        "скорость",
        "vitesse_angulaire"}},
      {"temperature_c",
       Dimension::kTemperature,
       {"t",
        "temp",
        "temperature",
        "t1",
        "t2",
        "t3",
        "temp1",
        "temp2",
        "temp_1",
        "temp_2",
        "temperature_1",
        "temperature_2",
        "gyro_temp",
        "gyro_temperature",
        "fog_temp",
        "thermometer",
        "field_temperature",
        "temperatur",
        "температура",
        "température"}},
      {"time_s",
       Dimension::kTime,
       {"time",      "t",     "timestamp", "time_stamp",   "stamp",       "datetime",
        "date_time", "date",  "elapsed",   "elapsed_time", "micros",      "millis",
        "seconds",   "sec",   "x_value",   "zeit",         "zeitstempel", "datum",
        "second",    "_time", "время",     "дата",         "дата_время",  "temps"}},
      {"duration_s", Dimension::kTime, {"duration", "window", "averaging_time", "dauer"}},
      {"field_x_ut",
       Dimension::kField,
       {"bx", "b_x", "hx", "h_x", "mag_x", "magx", "mx", "field_x", "magnetic_field_x",
        "field_magnetic_field_x"}},
      {"field_y_ut",
       Dimension::kField,
       {"by", "b_y", "hy", "h_y", "mag_y", "magy", "my", "field_y", "magnetic_field_y",
        "field_magnetic_field_y"}},
      {"field_z_ut",
       Dimension::kField,
       {"bz", "b_z", "hz", "h_z", "mag_z", "magz", "mz", "field_z", "magnetic_field_z",
        "field_magnetic_field_z"}},
      {"ambient_c",
       Dimension::kTemperature,
       {"ambient", "ambient_temp", "ambient_temperature", "t_amb", "t_ambient",
        "room_temperature"}},
      {"heater_w", Dimension::kPower, {"heater", "heater_power", "heizleistung"}},
      {"coil_current_a", Dimension::kCurrent, {"coil_current", "i_coil", "coil"}},
      {"azimuth_deg", Dimension::kAngle, {"azimuth", "азимут"}},
  };
  return kNames;
}

/// Lower case, of ASCII and of Cyrillic; what joins words is an underscore.
std::string plain_name(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (c >= 'A' && c <= 'Z') {
      out += static_cast<char>(c - 'A' + 'a');
    } else if (c == ' ' || c == '.' || c == '-' || c == '/' || c == '_' || c == ':') {
      if (!out.empty() && out.back() != '_') out += '_';
    } else if (c == '\xD0' && i + 1 < name.size() && name[i + 1] >= '\x90' &&
               name[i + 1] <= '\x9F') {
      out += c;
      out += static_cast<char>(name[++i] + 0x20);
    } else if (c == '\xD0' && i + 1 < name.size() && name[i + 1] >= '\xA0' &&
               name[i + 1] <= '\xAF') {
      out += '\xD1';
      out += static_cast<char>(name[++i] - 0x20);
    } else {
      out += c;
    }
  }
  while (out.ends_with('_')) out.pop_back();
  return out;
}

Error refusal(std::string message) {
  return {ErrorCode::kBadInput, std::move(message)};
}

std::string shell_quoted(const std::string& text) {
  const bool plain = std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '=' || c == '.' || c >= 0x80;
  });
  return plain ? text : "'" + text + "'";
}

class Chooser {
 public:
  Chooser(std::span<const SourceColumn> source, const ReadOptions& options)
      : source_(source), options_(options) {
    for (const SourceColumn& column : source) choice_.columns.push_back({.name = column.name});
  }

  Result<Choice> choose() {
    if (Status found = no_name_twice(); !found) return found.error();
    if (Status renamed = rename(); !renamed) return renamed.error();
    recognise_common();
    for (std::size_t i = 0; i < source_.size(); ++i) {
      if (Status known = learn_unit(i); !known) return known.error();
    }
    for (const auto& [column, unit] : options_.units) {
      if (options_.need_all && find(column) == source_.size()) {
        return refusal(fmt::format("--unit {}: there is no such column", column));
      }
    }
    return std::move(choice_);
  }

 private:
  std::size_t find(const std::string& name) const {
    const auto found = std::find_if(source_.begin(), source_.end(),
                                    [&](const SourceColumn& c) { return c.name == name; });
    return static_cast<std::size_t>(found - source_.begin());
  }

  Status no_name_twice() const {
    std::set<std::string_view> seen;
    for (const SourceColumn& column : source_) {
      if (!column.name.empty() && !seen.insert(column.name).second) {
        return refusal(fmt::format("column {}: found twice, expected each name once", column.name));
      }
    }
    return {};
  }

  void take(std::size_t from, const std::string& wanted) {
    for (ChosenColumn& column : choice_.columns) {
      if (column.name == wanted) column.name.clear();
    }
    choice_.columns[from].name = wanted;
    choice_.columns[from].is_foreign = true;
  }

  Status rename() {
    for (const auto& [wanted, found] : options_.columns) {
      if (found == "-") continue;
      const std::size_t from = find(found);
      if (from == source_.size()) {
        if (!options_.need_all) continue;
        return refusal(fmt::format(
            "column {}: not found, expected it because {} is to be read from it", found, wanted));
      }
      take(from, wanted);
    }
    return {};
  }

  /// The unit that is stated for a column; null for none and for one that nobody knows.
  const StatedUnit* stated_unit(std::size_t i) const {
    const auto said = options_.units.find(source_[i].name);
    if (said != options_.units.end()) return config::unit_spelt(said->second);
    if (!source_[i].unit.empty()) return config::unit_spelt(source_[i].unit);
    const auto in_name = config::unit_in_name(source_[i].name);
    return in_name ? *in_name : nullptr;
  }

  bool free(std::size_t i) const {
    const ChosenColumn& column = choice_.columns[i];
    return !column.name.empty() && !column.is_foreign && !options_.kept.contains(column.name) &&
           config::find_channel(column.name) == nullptr;
  }

  void recognise_common() {
    for (const CommonNames& common : common_names()) {
      const std::string wanted(common.wanted);
      const bool there =
          options_.columns.contains(wanted) ||
          std::any_of(choice_.columns.begin(), choice_.columns.end(),
                      [&](const ChosenColumn& column) { return column.name == wanted; });
      if (there) continue;
      std::vector<std::size_t> candidates;
      for (std::size_t i = 0; i < source_.size(); ++i) {
        if (free(i) && may_be(i, common)) candidates.push_back(i);
      }
      if (candidates.size() == 1) {
        take(candidates.front(), wanted);
      } else if (candidates.size() > 1) {
        std::vector<std::string> options;
        for (const std::size_t i : candidates) {
          options.push_back("--column " + shell_quoted(wanted + "=" + source_[i].name));
        }
        choice_.undecided.emplace_back(
            wanted, fmt::format("column {}: several may be it, expected one of {}", wanted,
                                fmt::join(options, ", ")));
        std::vector<std::string> names;
        for (const std::size_t i : candidates) names.push_back(source_[i].name);
        choice_.says.push_back(
            fmt::format("{} from none, as {} may be it", wanted, fmt::join(names, ", ")));
      }
    }
  }

  bool may_be(std::size_t i, const CommonNames& common) const {
    const std::string& name = source_[i].name;
    const StatedUnit* const unit = stated_unit(i);
    if (unit != nullptr && unit->dimension != common.dimension) return false;
    // "t" is a time and "T" a temperature, unless a unit says otherwise.
    const std::string_view bare = config::name_without_unit(name);
    if (unit == nullptr && bare == "T" && common.dimension == Dimension::kTime) return false;
    if (unit == nullptr && bare == "t" && common.dimension == Dimension::kTemperature) return false;
    for (const std::string& plain : {plain_name(bare), plain_name(name)}) {
      if (std::find(common.names.begin(), common.names.end(), plain) != common.names.end()) {
        return true;
      }
    }
    // Whatever it is called: nothing else has a rotation rate's unit.
    return common.dimension == Dimension::kRate && unit != nullptr;
  }

  Status learn_unit(std::size_t i) {
    ChosenColumn& column = choice_.columns[i];
    if (column.name.empty()) return {};
    const std::string& name = source_[i].name;
    column.house = config::find_unit(config::unit_of(column.name));
    const auto said = options_.units.find(name);
    const bool is_said = said != options_.units.end();
    const std::string& text = is_said ? said->second : source_[i].unit;
    bool is_stated = !text.empty();  // not only the end of a name, which may mean something else
    if (is_stated) {
      column.unit = config::unit_spelt(text);
      if (column.unit == nullptr && (is_said || column.house != nullptr)) {
        return Error{is_said ? ErrorCode::kUsage : ErrorCode::kBadInput,
                     fmt::format("{} {}: found the unit \"{}\", expected {}",
                                 is_said ? "--unit" : "column", name, text, config::known_units())};
      }
    } else if (const auto in_name = config::unit_in_name(name)) {
      column.unit = *in_name;
      is_stated = name.ends_with(']') || name.ends_with(')');
    } else if (column.house != nullptr && column.is_foreign) {
      return in_name.error();
    }
    if (column.house != nullptr && column.unit != nullptr &&
        column.unit->dimension != column.house->dimension) {
      if (is_stated) {
        return refusal(fmt::format("column {}: is in {}, expected {} for {}", name,
                                   column.unit->name, config::known_units(column.house->dimension),
                                   column.name));
      }
      column.unit = nullptr;
    }
    if (!is_said && !column.is_foreign && column.house != nullptr && column.unit != nullptr &&
        column.unit != column.house) {
      return refusal(fmt::format("column {}: its name says {}, the units say {}", name,
                                 column.house->name, column.unit->name));
    }
    say(column, name);
    return {};
  }

  void say(const ChosenColumn& column, const std::string& name) {
    const bool converted =
        column.house != nullptr && column.unit != nullptr && column.unit != column.house;
    if (!column.is_foreign && !converted) return;
    std::string says = column.is_foreign ? fmt::format("{} from {}", column.name, name) : name;
    if (column.house != nullptr && column.unit != nullptr) {
      const bool strength = column.unit->name.ends_with("A/m");
      says += fmt::format(" in {}{}", column.unit->name, strength ? " (in vacuum)" : "");
    } else if (column.house != nullptr && column.name != "time_s") {
      says += fmt::format(", whose unit is not stated, as {}", column.house->name);
    }
    choice_.says.push_back(std::move(says));
  }

  std::span<const SourceColumn> source_;
  const ReadOptions& options_;
  Choice choice_;
};

}  // namespace

Result<Choice> choose_columns(std::span<const SourceColumn> source, const ReadOptions& options) {
  return Chooser(source, options).choose();
}

void convert(const ChosenColumn& column, std::vector<double>& values) {
  if (column.unit == nullptr || column.house == nullptr || column.unit == column.house) return;
  const StatedUnit &from = *column.unit, &to = *column.house;
  for (double& value : values) value = (value * from.factor + from.offset - to.offset) / to.factor;
}

}  // namespace fogbench::model
