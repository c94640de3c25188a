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

/// As others write it, where it is not the house's spelling.
constexpr Ending kSpellings[] = {
    {"°/h", "deg/h"},     {"°/hr", "deg/h"},    {"deg/hr", "deg/h"},  {"deg/hour", "deg/h"},
    {"dph", "deg/h"},     {"°/ч", "deg/h"},     {"град/ч", "deg/h"},  {"град/час", "deg/h"},
    {"grad/h", "deg/h"},  {"°/min", "deg/min"}, {"°/s", "deg/s"},     {"º/s", "deg/s"},
    {"deg/sec", "deg/s"}, {"dps", "deg/s"},     {"°/с", "deg/s"},     {"град/с", "deg/s"},
    {"mdps", "mdeg/s"},   {"rad/sec", "rad/s"}, {"рад/с", "rad/s"},   {"µrad/s", "urad/s"},
    {"μrad/s", "urad/s"}, {"\"/s", "arcsec/s"}, {"\"/h", "arcsec/h"}, {"rps", "rev/s"},
    {"об/с", "rev/s"},    {"U/min", "rpm"},     {"об/мин", "rpm"},    {"°C", "degC"},
    {"ºC", "degC"},       {"℃", "degC"},        {"C", "degC"},        {"Celsius", "degC"},
    {"celsius", "degC"},  {"deg C", "degC"},    {"°С", "degC"},  // with a Cyrillic letter
    {"С", "degC"},        {"гр.С", "degC"},     {"m°C", "mdegC"},     {"°F", "degF"},
    {"F", "degF"},        {"kelvin", "K"},      {"Kelvin", "K"},      {"К", "K"},  // Cyrillic
    {"µT", "uT"},         {"μT", "uT"},         {"мкТл", "uT"},       {"нТл", "nT"},
    {"мТл", "mT"},        {"Тл", "T"},          {"Gauss", "G"},       {"gauss", "G"},
    {"Гс", "G"},          {"А/м", "A/m"},       {"µA", "uA"},         {"μA", "uA"},
    {"А", "A"},           {"мА", "mA"},         {"Вт", "W"},          {"мВт", "mW"},
    {"°", "deg"},         {"град", "deg"},      {"degrees", "deg"},   {"рад", "rad"},
    {"В", "V"},           {"мВ", "mV"},         {"sec", "s"},         {"seconds", "s"},
    {"S", "s"},           {"с", "s"},           {"сек", "s"},         {"Sek", "s"},
    {"мс", "ms"},         {"msec", "ms"},       {"µs", "us"},         {"μs", "us"},
    {"usec", "us"},       {"мкс", "us"},        {"мин", "min"},       {"minutes", "min"},
    {"ч", "h"},           {"час", "h"},         {"hr", "h"},          {"hours", "h"},
    {"Std", "h"},         {"days", "d"},
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
    {"_arcsec_per_h", "arcsec/h"},
    {"_arcsec_h", "arcsec/h"},
    {"_rev_per_s", "rev/s"},
    {"_rev_s", "rev/s"},
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
    {"_mgauss", "mG"},
    {"_ka_per_m", "kA/m"},
    {"_a_per_m", "A/m"},
    {"_a_m", "A/m"},
    {"_ma", "mA"},
    {"_ua", "uA"},
    {"_a", "A"},
    {"_mw", "mW"},
    {"_kw", "kW"},
    {"_w", "W"},
    {"millis", "ms"},
    {"micros", "us"},
    {"_ms", "ms"},
    {"_us", "us"},
    {"_ns", "ns"},
    {"_sec", "s"},
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

/// The last bracketed part of a name that ends in one: its place and what it says.
struct Bracket {
  std::size_t begin = std::string_view::npos;
  std::string_view inside;
};

Bracket bracket_of(std::string_view name) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const std::size_t begin = name.rfind(open);
    if (!name.ends_with(close) || begin == std::string_view::npos) continue;
    std::string_view inside = name.substr(begin + 1, name.size() - begin - 2);
    while (inside.starts_with(' ')) inside.remove_prefix(1);
    while (inside.ends_with(' ')) inside.remove_suffix(1);
    if (!inside.empty()) return {begin, inside};
  }
  return {};
}

const Ending* ending_of(std::string_view name) {
  std::string small(name);
  std::transform(small.begin(), small.end(), small.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto* const found =
      std::find_if(std::begin(kEndings), std::end(kEndings),
                   [&](const Ending& known) { return small.ends_with(known.ending); });
  return found == std::end(kEndings) ? nullptr : found;
}

}  // namespace

const StatedUnit* unit_spelt(std::string_view text) {
  if (const StatedUnit* const unit = find_unit(text)) return unit;
  const auto* const found = std::find_if(std::begin(kSpellings), std::end(kSpellings),
                                         [&](const Ending& known) { return known.ending == text; });
  return found == std::end(kSpellings) ? nullptr : find_unit(found->unit);
}

std::string_view name_without_unit(std::string_view name) {
  if (const Bracket stated = bracket_of(name); !stated.inside.empty()) {
    name = name.substr(0, stated.begin);
  } else if (const Ending* const ending = ending_of(name)) {
    name.remove_suffix(ending->ending.size());
  }
  while (name.ends_with(' ') || name.ends_with('_')) name.remove_suffix(1);
  return name;
}

Result<const StatedUnit*> unit_in_name(std::string_view name) {
  if (const Bracket stated = bracket_of(name); !stated.inside.empty()) {
    if (const StatedUnit* const unit = unit_spelt(stated.inside)) return unit;
    return Error{
        ErrorCode::kBadInput,
        fmt::format("column {}: found the unit \"{}\", expected {}", one_line(std::string(name)),
                    one_line(std::string(stated.inside)), known_units())};
  }
  const Ending* const ending = ending_of(name);
  return ending == nullptr ? nullptr : find_unit(ending->unit);
}

}  // namespace fogbench::config
