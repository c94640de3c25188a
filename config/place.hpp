#pragma once
// Where a value stands in a JSON file while it is read, and the one error that reading ends with:
// file, JSON pointer, what was found, what was expected.

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"

namespace fogbench::config {

/// Of one file's reading. A file is read to its end, whatever is wrong in it.
struct ReadState {
  const std::filesystem::path& file;
  std::optional<Error> error;  ///< the first one
  std::vector<Error> further;  ///< the first few after it
};

/// A value (or its absence) and the way to it. A place refers to the one it was reached from, so it
/// lives no longer than that one: `at / "registers" / 2` inside one expression, or as a local.
class Place {
 public:
  Place(const nlohmann::json& root, ReadState& state) : value_(&root), state_(state) {}

  Place operator/(std::string_view key) const;
  Place operator/(std::size_t index) const;

  /// Precondition: present().
  const nlohmann::json& value() const { return *value_; }
  bool present() const { return value_ != nullptr; }
  std::string pointer() const;
  const std::filesystem::path& file() const { return state_.file; }

  /// Notes "found ..., expected `expected`". Returns false, for `return at.wrong(...)`.
  bool wrong(std::string_view expected) const;
  /// Notes a sentence of one's own about this place. Returns false.
  bool fail(std::string_view sentence) const;
  /// Notes an error that already says where it is. Returns false.
  bool fail(const Error& error) const;

 private:
  Place(const nlohmann::json* value, const Place& parent) : value_(value), state_(parent.state_) {}

  const nlohmann::json* value_;
  ReadState& state_;
  const Place* parent_ = nullptr;
  std::string_view key_;
  std::size_t index_ = 0;
};

}  // namespace fogbench::config
