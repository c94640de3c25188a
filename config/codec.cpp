#include "config/codec.hpp"

#include <algorithm>
#include <charconv>

#include "config/json_file.hpp"
#include "config/nearest_name.hpp"

namespace fogbench::config {

bool is_identifier(std::string_view name) {
  return !name.empty() && name.front() >= 'a' && name.front() <= 'z' &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
         });
}

std::string expectation(std::string_view kind, const Rule& rule) {
  const bool low = std::isfinite(rule.minimum);
  const bool high = std::isfinite(rule.maximum);
  if (low && high && !rule.open_minimum) {
    return fmt::format("{} from {} to {}", kind, rule.minimum, rule.maximum);
  }
  std::string text(kind);
  if (low) text += fmt::format(" {} {}", rule.open_minimum ? "above" : "of at least", rule.minimum);
  if (high) text += fmt::format("{} at most {}", low ? " and" : " of", rule.maximum);
  return text;
}

bool satisfies(double value, const Rule& rule) {
  return std::isfinite(value) && value <= rule.maximum &&
         (rule.open_minimum ? value > rule.minimum : value >= rule.minimum);
}

void add_bounds(ordered_json& schema, const Rule& rule) {
  const auto whole = [](double value) {
    const bool integer = value == std::floor(value) && std::abs(value) < 1e15;
    return integer ? ordered_json(static_cast<std::int64_t>(value)) : ordered_json(value);
  };
  if (std::isfinite(rule.minimum)) {
    schema[rule.open_minimum ? "exclusiveMinimum" : "minimum"] = whole(rule.minimum);
  }
  if (std::isfinite(rule.maximum)) schema["maximum"] = whole(rule.maximum);
}

bool read_number(const Place& at, double& out, const Rule& rule) {
  if (at.value().is_number()) {
    const auto value = at.value().get<double>();
    if (satisfies(value, rule)) {
      out = value;
      return true;
    }
  }
  return at.wrong(expectation("a number", rule));
}

bool read_integer(const Place& at, std::int64_t& out, const Rule& rule) {
  std::optional<std::int64_t> value;
  if (at.value().is_number_unsigned()) {
    const auto number = at.value().get<std::uint64_t>();
    if (number <= std::uint64_t{1} << 53) value = static_cast<std::int64_t>(number);
  } else if (at.value().is_number_integer()) {
    value = at.value().get<std::int64_t>();
  } else if (at.value().is_string()) {
    const std::string_view text = at.value().get_ref<const std::string&>();
    std::uint32_t number = 0;
    if (text.starts_with("0x") || text.starts_with("0X")) {
      const auto [end, error] =
          std::from_chars(text.data() + 2, text.data() + text.size(), number, 16);
      if (error == std::errc{} && end == text.data() + text.size()) value = number;
    }
  }
  if (value && satisfies(static_cast<double>(*value), rule)) {
    out = *value;
    return true;
  }
  return at.wrong(expectation("an integer (or \"0x...\")", rule));
}

bool read_text(const Place& at, std::string& out) {
  if (at.value().is_string()) {
    const auto& text = at.value().get_ref<const std::string&>();
    const bool printable = std::none_of(text.begin(), text.end(),
                                        [](char c) { return static_cast<unsigned char>(c) < ' '; });
    if (!text.empty() && printable) {
      out = text;
      return true;
    }
  }
  return at.wrong("a text of one line that is not empty");
}

void ObjectReader::rest(std::map<std::string, double>& members, std::string_view /*description*/) {
  open_ = true;
  members.clear();
  for (const auto& [key, member] : at_.value().items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    ok_ = read_number(at_ / key, members[key], {}) && ok_;
  }
}

bool ObjectReader::finish() {
  if (!open_) {
    for (const auto& [key, member] : at_.value().items()) {
      if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
      const std::string meant = did_you_mean(key, known_);
      ok_ = (at_ / key).fail(
          "unknown key" +
          (meant.empty() ? fmt::format("; expected one of {}", fmt::join(known_, ", ")) : meant));
    }
  }
  for (const Missing& missing : missing_) {
    ok_ =
        at_.fail(fmt::format("has no key \"{}\"; expected: {}", missing.key, missing.description));
  }
  return ok_;
}

void SchemaWriter::tag(std::string_view key, std::string_view name) {
  properties_[std::string(key)] = {{"const", name}};
  required_.push_back(key);
}

void SchemaWriter::rest(std::map<std::string, double>& /*members*/, std::string_view description) {
  further_ = {{"type", "number"}, {"description", description}};
}

void SchemaWriter::put(std::string_view key, ordered_json schema, std::string_view description,
                       const ordered_json& default_value) {
  std::string text(description);
  const std::string_view unit = unit_of(key);
  if (!unit.empty()) text += fmt::format(" In {}.", unit);
  ordered_json entry = {{"description", text}};
  entry.update(schema);
  const bool says_something =
      !default_value.is_null() && !default_value.is_object() &&
      !(default_value.is_string() && default_value.get_ref<const std::string&>().empty()) &&
      !(default_value.is_array() && default_value.empty());
  if (says_something) entry["default"] = default_value;
  properties_[std::string(key)] = std::move(entry);
}

ordered_json SchemaWriter::finish() {
  ordered_json schema = {{"type", "object"}, {"properties", std::move(properties_)}};
  if (!required_.empty()) schema["required"] = std::move(required_);
  schema["additionalProperties"] = std::move(further_);
  return schema;
}

void ObjectWriter::rest(std::map<std::string, double>& members, std::string_view /*description*/) {
  for (const auto& [key, value] : members) put(key, Codec<double>::write(value));
}

void ObjectWriter::put(std::string_view key, ordered_json value) {
  const bool silent = value.is_null() || (value.is_structured() && value.empty()) ||
                      (value.is_string() && value.get_ref<const std::string&>().empty()) ||
                      (value.is_boolean() && !value.get<bool>());
  if (!silent) object_[std::string(key)] = std::move(value);
}

}  // namespace fogbench::config
