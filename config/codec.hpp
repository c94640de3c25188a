#pragma once
// How every type of the configuration lies in JSON, described once and used three ways.
//
// A struct is described by one function template beside its reader:
//
//   template <class Visitor>
//   void describe(Visitor& v, CoilConfig& c) {
//     v.required("field_ut_per_a", c.field_ut_per_a, "Field per ampere at the centre.", above(0));
//     v.optional("current_limit_a", c.current_limit, "Largest current.", above(0));
//   }
//
// and, where the parts have to agree with each other, by `bool check(const Place&, const T&)`.
// Codec<T> turns that into read (with errors that say where and what), schema (draft-07) and write.
// Types that are no struct have a specialisation here or beside their reader.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "config/json_file.hpp"
#include "config/place.hpp"
#include "config/units.hpp"
#include "config/visitors.hpp"

namespace fogbench::config {

/// The name of an effect, of a parameter: small letters, digits and underscores, a letter first.
bool is_identifier(std::string_view name);
inline constexpr std::string_view kIdentifier =
    "a name of small letters, digits and underscores, a letter first";
inline constexpr std::string_view kIdentifierExpected =
    "this key names something; expected small letters, digits and underscores, a letter first";

/// One name of an enumeration; the list is found by overload: enum_names(HeatingMode{}).
template <class E>
struct EnumName {
  std::string_view name;
  E value;
};

template <class T>
struct Codec {
  static bool read(const Place& at, T& out, const Rule& /*rule*/) {
    if (!at.value().is_object()) return at.wrong("an object");
    ObjectReader reader(at);
    describe(reader, out);
    const bool whole = reader.finish();
    bool ok = whole;
    if constexpr (requires { check_names(at, out); }) ok = check_names(at, out) && ok;
    // How the parts agree can only be told when all have been read.
    if constexpr (requires { check(at, out); }) ok = whole && check(at, out) && ok;
    return ok;
  }
  static ordered_json schema(const Rule& /*rule*/) {
    SchemaWriter writer;
    T value{};
    describe(writer, value);
    return writer.finish();
  }
  static ordered_json write(const T& value) {
    ObjectWriter writer;
    T copy = value;
    describe(writer, copy);
    return writer.finish();
  }
};

template <>
struct Codec<double> {
  static bool read(const Place& at, double& out, const Rule& rule) {
    return read_number(at, out, rule);
  }
  static ordered_json schema(const Rule& rule) {
    ordered_json schema = {{"type", "number"}};
    add_bounds(schema, rule);
    return schema;
  }
  /// A number that is not finite has no place in JSON: null.
  static ordered_json write(double value) {
    return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
  }
};

template <class T>
requires(std::is_integral_v<T>) struct Codec<T> {
  static Rule bounded(const Rule& rule) {
    return {.minimum = std::max(rule.minimum, static_cast<double>(std::numeric_limits<T>::min())),
            .maximum = std::min(rule.maximum,
                                sizeof(T) < 8 ? static_cast<double>(std::numeric_limits<T>::max())
                                              : 9007199254740992.0)};
  }
  static bool read(const Place& at, T& out, const Rule& rule) {
    std::int64_t value = 0;
    if (!read_integer(at, value, bounded(rule))) return false;
    out = static_cast<T>(value);
    return true;
  }
  static ordered_json schema(const Rule& rule) {
    ordered_json number = {{"type", "integer"}};
    add_bounds(number, bounded(rule));
    return {{"anyOf", {number, {{"type", "string"}, {"pattern", "^0[xX][0-9A-Fa-f]{1,8}$"}}}}};
  }
  static ordered_json write(T value) { return value; }
};

template <>
struct Codec<bool> {
  static bool read(const Place& at, bool& out, const Rule& /*rule*/) {
    if (!at.value().is_boolean()) return at.wrong("true or false");
    out = at.value().get<bool>();
    return true;
  }
  static ordered_json schema(const Rule& /*rule*/) { return {{"type", "boolean"}}; }
  static ordered_json write(bool value) { return value; }
};

template <>
struct Codec<std::string> {
  static bool read(const Place& at, std::string& out, const Rule& /*rule*/) {
    return read_text(at, out);
  }
  static ordered_json schema(const Rule& /*rule*/) {
    return {{"type", "string"}, {"minLength", 1}};
  }
  static ordered_json write(const std::string& value) { return value; }
};

template <class Unit>
struct Codec<Quantity<Unit>> : Codec<double> {
  static bool read(const Place& at, Quantity<Unit>& out, const Rule& rule) {
    return read_number(at, out.value, rule);
  }
  static ordered_json write(Quantity<Unit> value) { return Codec<double>::write(value.value); }
};

template <>
struct Codec<Seconds> : Codec<double> {
  static bool read(const Place& at, Seconds& out, const Rule& rule) {
    double seconds = 0;
    if (!read_number(at, seconds, rule)) return false;
    out = Seconds{seconds};
    return true;
  }
  static ordered_json write(Seconds value) { return Codec<double>::write(value.count()); }
};

template <class E>
requires(std::is_enum_v<E>) struct Codec<E> {
  static bool read(const Place& at, E& out, const Rule& /*rule*/) {
    std::string expected;
    for (const auto& [name, value] : enum_names(E{})) {
      if (at.value().is_string() && at.value().get_ref<const std::string&>() == name) {
        out = value;
        return true;
      }
      expected += fmt::format("{}\"{}\"", expected.empty() ? "one of " : ", ", name);
    }
    return at.wrong(expected);
  }
  static ordered_json schema(const Rule& /*rule*/) {
    ordered_json names = ordered_json::array();
    for (const auto& entry : enum_names(E{})) names.push_back(entry.name);
    return {{"type", "string"}, {"enum", names}};
  }
  static ordered_json write(E value) {
    for (const auto& entry : enum_names(E{})) {
      if (entry.value == value) return entry.name;
    }
    return nullptr;
  }
};

template <class T>
struct Codec<std::optional<T>> {
  static bool read(const Place& at, std::optional<T>& out, const Rule& rule) {
    return Codec<T>::read(at, out.emplace(), rule);
  }
  static ordered_json schema(const Rule& rule) { return Codec<T>::schema(rule); }
  static ordered_json write(const std::optional<T>& value) {
    return value ? Codec<T>::write(*value) : ordered_json(nullptr);
  }
};

template <class T>
struct Codec<std::vector<T>> {
  static bool read(const Place& at, std::vector<T>& out, const Rule& rule) {
    if (!at.value().is_array() || at.value().size() < rule.least_items) {
      return at.wrong(rule.least_items > 0 ? "a list that is not empty" : "a list");
    }
    out.assign(at.value().size(), T{});
    bool ok = true;
    for (std::size_t i = 0; i < out.size(); ++i) ok = Codec<T>::read(at / i, out[i], rule) && ok;
    return ok;
  }
  static ordered_json schema(const Rule& rule) {
    ordered_json schema = {{"type", "array"}, {"items", Codec<T>::schema(rule)}};
    if (rule.least_items > 0) schema["minItems"] = rule.least_items;
    return schema;
  }
  static ordered_json write(const std::vector<T>& values) {
    ordered_json list = ordered_json::array();
    for (const T& value : values) list.push_back(Codec<T>::write(value));
    return list;
  }
};

template <class T, std::size_t N>
struct Codec<std::array<T, N>> {
  static bool read(const Place& at, std::array<T, N>& out, const Rule& rule) {
    if (!at.value().is_array() || at.value().size() != N) {
      return at.wrong(fmt::format("a list of {}", N));
    }
    for (std::size_t i = 0; i < N; ++i) {
      if (!Codec<T>::read(at / i, out[i], rule)) return false;
    }
    return true;
  }
  static ordered_json schema(const Rule& rule) {
    return {{"type", "array"}, {"items", Codec<T>::schema(rule)}, {"minItems", N}, {"maxItems", N}};
  }
  static ordered_json write(const std::array<T, N>& values) {
    ordered_json list = ordered_json::array();
    for (const T& value : values) list.push_back(Codec<T>::write(value));
    return list;
  }
};

template <class T>
struct Codec<std::map<std::string, T>> {
  static bool read(const Place& at, std::map<std::string, T>& out, const Rule& rule) {
    if (!at.value().is_object()) return at.wrong("an object");
    out.clear();
    for (const auto& [key, member] : at.value().items()) {
      if (!Codec<T>::read(at / key, out[key], rule)) return false;
    }
    return true;
  }
  static ordered_json schema(const Rule& rule) {
    return {{"type", "object"}, {"additionalProperties", Codec<T>::schema(rule)}};
  }
  /// Entries that are not finite are left out.
  static ordered_json write(const std::map<std::string, T>& values) {
    ordered_json object = ordered_json::object();
    for (const auto& [key, value] : values) {
      ordered_json member = Codec<T>::write(value);
      if (!member.is_null()) object[key] = std::move(member);
    }
    return object;
  }
};

/// Reads a whole file into `out`. Everything that is wrong, each in a line, as far as it can be
/// told at once; empty when nothing is.
template <class T>
std::vector<Error> read_config(const std::filesystem::path& file, T& out) {
  auto tree = read_json_file(file);
  if (!tree) return {tree.error()};
  if (tree->is_object()) tree->erase("$schema");
  ReadState state{file, std::nullopt, {}};
  if (Codec<T>::read(Place(*tree, state), out, {})) return {};
  std::vector<Error> problems{*state.error};
  problems.insert(problems.end(), state.further.begin(), state.further.end());
  return problems;
}

/// Reads a whole file as a T. The key "$schema" is an editor's and is left alone.
template <class T>
Result<T> read_config(const std::filesystem::path& file) {
  T out{};
  const auto problems = read_config(file, out);
  if (problems.empty()) return out;
  return problems.front();
}

}  // namespace fogbench::config
