#pragma once
// The three visitors of a struct's description (codec.hpp): one reads a JSON object into it, one
// writes the object's JSON Schema, one writes the object. And the rules that values must satisfy.

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "config/place.hpp"

namespace fogbench::config {

using nlohmann::ordered_json;

/// What a value must satisfy. The bounds hold for a number and for every number of a list or map.
struct Rule {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool open_minimum = false;    ///< the minimum itself is not allowed
  std::size_t least_items = 0;  ///< of a list
};

constexpr Rule at_least(double minimum) {
  return {.minimum = minimum};
}
constexpr Rule above(double minimum) {
  return {.minimum = minimum, .open_minimum = true};
}
constexpr Rule between(double minimum, double maximum) {
  return {.minimum = minimum, .maximum = maximum};
}
constexpr Rule not_empty() {
  return {.least_items = 1};
}

/// "a number above 0", "an integer from 0 to 255".
std::string expectation(std::string_view kind, const Rule& rule);
bool satisfies(double value, const Rule& rule);
/// minimum, exclusiveMinimum, maximum.
void add_bounds(ordered_json& schema, const Rule& rule);
/// A number, within the rule.
bool read_number(const Place& at, double& out, const Rule& rule);
/// An integer, or the same in hexadecimal as a string ("0x80F0"), within the rule.
bool read_integer(const Place& at, std::int64_t& out, const Rule& rule);
/// A string that is not empty and has no control characters.
bool read_text(const Place& at, std::string& out);

/// The primary template is for described structs.
template <class T>
struct Codec;

template <class T>
ordered_json schema_of(const Rule& rule = {}) {
  return Codec<T>::schema(rule);
}

/// Visitor that reads one object.
class ObjectReader {
 public:
  explicit ObjectReader(const Place& at) : at_(at) {}

  template <class T>
  void required(std::string_view key, T&& member, std::string_view description,
                const Rule& rule = {}) {
    known_.push_back(key);
    const Place child = at_ / key;
    if (child.present()) {
      ok_ = Codec<std::decay_t<T>>::read(child, member, rule) && ok_;
    } else {
      missing_.push_back({key, description});
    }
  }
  template <class T>
  void optional(std::string_view key, T&& member, std::string_view /*description*/,
                const Rule& rule = {}) {
    known_.push_back(key);
    const Place child = at_ / key;
    if (child.present()) ok_ = Codec<std::decay_t<T>>::read(child, member, rule) && ok_;
  }
  /// An object that only groups keys: `fill` describes its inside.
  template <class Fill>
  void section(std::string_view key, std::string_view /*description*/, Fill fill) {
    known_.push_back(key);
    const Place child = at_ / key;
    if (!child.present()) return;
    if (!child.value().is_object()) {
      ok_ = child.wrong("an object");
      return;
    }
    ObjectReader inside(child);
    fill(inside);
    ok_ = inside.finish() && ok_;
  }
  /// The key that says which of several shapes this object has; already looked at.
  void tag(std::string_view key, std::string_view /*name*/) { known_.push_back(key); }
  /// All further keys, as numbers.
  void rest(std::map<std::string, double>& members, std::string_view description);

  /// Unknown and missing keys are errors. An unknown one is named first: it is often the missing
  /// one, misspelt.
  bool finish();

 private:
  struct Missing {
    std::string_view key, description;
  };
  const Place& at_;
  std::vector<std::string_view> known_;
  std::vector<Missing> missing_;
  bool open_ = false;
  bool ok_ = true;
};

/// Visitor that writes the schema of one object.
class SchemaWriter {
 public:
  template <class T>
  void required(std::string_view key, T&& member, std::string_view description,
                const Rule& rule = {}) {
    add<std::decay_t<T>>(key, description, rule, nullptr);
    required_.push_back(key);
    (void)member;
  }
  template <class T>
  void optional(std::string_view key, T&& member, std::string_view description,
                const Rule& rule = {}) {
    add<std::decay_t<T>>(key, description, rule, Codec<std::decay_t<T>>::write(member));
  }
  template <class Fill>
  void section(std::string_view key, std::string_view description, Fill fill) {
    SchemaWriter inside;
    fill(inside);
    put(key, inside.finish(), description, nullptr);
  }
  void tag(std::string_view key, std::string_view name);
  void rest(std::map<std::string, double>& members, std::string_view description);
  ordered_json finish();

 private:
  template <class T>
  void add(std::string_view key, std::string_view description, const Rule& rule,
           const ordered_json& default_value) {
    put(key, Codec<T>::schema(rule), description, default_value);
  }
  void put(std::string_view key, ordered_json schema, std::string_view description,
           const ordered_json& default_value);

  ordered_json properties_ = ordered_json::object();
  ordered_json required_ = ordered_json::array();
  ordered_json further_ = false;
};

/// Visitor that writes one object: what is absent, empty or false is left out.
class ObjectWriter {
 public:
  template <class T>
  void required(std::string_view key, T&& member, std::string_view /*description*/,
                const Rule& /*rule*/ = {}) {
    put(key, Codec<std::decay_t<T>>::write(member));
  }
  template <class T>
  void optional(std::string_view key, T&& member, std::string_view /*description*/,
                const Rule& /*rule*/ = {}) {
    put(key, Codec<std::decay_t<T>>::write(member));
  }
  template <class Fill>
  void section(std::string_view key, std::string_view /*description*/, Fill fill) {
    ObjectWriter inside;
    fill(inside);
    put(key, inside.finish());
  }
  void tag(std::string_view key, std::string_view name) { object_[std::string(key)] = name; }
  void rest(std::map<std::string, double>& members, std::string_view description);
  ordered_json finish() { return std::move(object_); }

 private:
  void put(std::string_view key, ordered_json value);
  ordered_json object_ = ordered_json::object();
};

}  // namespace fogbench::config
