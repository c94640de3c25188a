#include "config/column_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "config/json_file.hpp"

namespace fogbench::config {
namespace {

struct Ending {
  std::string_view ending, unit;
};

/// In small letters; a longer one before a shorter one that it ends in.
constexpr Ending kEndings[] = {
    {"_mdeg_per_s", "mdeg/s"},
    {"_mdeg_s", "mdeg/s"},
    {"_deg_per_s", "deg/s"},
    {"_deg_s", "deg/s"},
    {"_dps", "deg/s"},
    {"_deg_per_min", "deg/min"},
    {"_deg_per_h", "deg/h"},
    {"_deg_h", "deg/h"},
    {"_dph", "deg/h"},
    {"_mrad_per_s", "mrad/s"},
    {"_mrad_s", "mrad/s"},
    {"_urad_per_s", "urad/s"},
    {"_urad_s", "urad/s"},
    {"_rad_per_s", "rad/s"},
    {"_rad_s", "rad/s"},
    {"_arcsec_per_s", "arcsec/s"},
    {"_arcsec_s", "arcsec/s"},
    {"_rpm", "rpm"},
    {"_mdegc", "mdegC"},
    {"_degc", "degC"},
    {"_degf", "degF"},
    {"_kelvin", "K"},
    {"_k", "K"},
    {"_c", "degC"},
    {"_ut", "uT"},
    {"_nt", "nT"},
    {"_mt", "mT"},
    {"_gauss", "G"},
    {"_ma", "mA"},
    {"_a", "A"},
    {"_mw", "mW"},
    {"_kw", "kW"},
    {"_w", "W"},
    {"_ms", "ms"},
    {"_min", "min"},
    {"_s", "s"},
    {"_h", "h"},
    {"_mrad", "mrad"},
    {"_rad", "rad"},
    {"_arcmin", "arcmin"},
    {"_arcsec", "arcsec"},
    {"_mdeg", "mdeg"},
    {"_deg", "deg"},
    {"_mv", "mV"},
    {"_v", "V"},
};

/// What stands between the brackets that a name ends in.
std::string_view in_brackets(std::string_view name) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const std::size_t begin = name.rfind(open);
    if (!name.ends_with(close) || begin == std::string_view::npos) continue;
    std::string_view inside = name.substr(begin + 1, name.size() - begin - 2);
    while (inside.starts_with(' ')) inside.remove_prefix(1);
    while (inside.ends_with(' ')) inside.remove_suffix(1);
    return inside;
  }
  return {};
}

}  // namespace

Result<const StatedUnit*> unit_in_name(std::string_view name) {
  if (const std::string_view stated = in_brackets(name); !stated.empty()) {
    if (const StatedUnit* const unit = find_unit(stated)) return unit;
    return Error{
        ErrorCode::kBadInput,
        fmt::format("column {}: found the unit \"{}\", expected one of {}",
                    one_line(std::string(name)), one_line(std::string(stated)), known_units())};
  }
  std::string small(name);
  std::transform(small.begin(), small.end(), small.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const auto& [ending, unit] : kEndings) {
    if (small.ends_with(ending)) return find_unit(unit);
  }
  return static_cast<const StatedUnit*>(nullptr);
}

}  // namespace fogbench::config
