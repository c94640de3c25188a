#include "config/place.hpp"

#include <fmt/format.h>

#include "config/json_file.hpp"

namespace fogbench::config {
namespace {

std::string found(const nlohmann::json& value) {
  switch (value.type()) {
    case nlohmann::json::value_t::object:
      return value.empty() ? "an empty object" : "an object";
    case nlohmann::json::value_t::array:
      return value.empty() ? "an empty list" : fmt::format("a list of {}", value.size());
    case nlohmann::json::value_t::string:
      return "\"" + one_line(value.get_ref<const std::string&>()) + "\"";
    default:
      return value.dump();
  }
}

}  // namespace

Place Place::operator/(std::string_view key) const {
  const nlohmann::json* child = nullptr;
  if (present() && value_->is_object()) {
    const auto member = value_->find(std::string(key));
    if (member != value_->end()) child = &*member;
  }
  Place place(child, *this);
  place.parent_ = this;
  place.key_ = key;
  return place;
}

Place Place::operator/(std::size_t index) const {
  const bool inside = present() && value_->is_array() && index < value_->size();
  Place place(inside ? &(*value_)[index] : nullptr, *this);
  place.parent_ = this;
  place.index_ = index;
  return place;
}

std::string Place::pointer() const {
  if (parent_ == nullptr) return {};
  if (key_.data() == nullptr) return parent_->pointer() + "/" + std::to_string(index_);
  std::string escaped;
  for (const char c : one_line(key_)) {
    escaped += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  }
  return parent_->pointer() + "/" + escaped;
}

bool Place::wrong(std::string_view expected) const {
  return fail(
      fmt::format("found {}, expected {}", present() ? found(*value_) : "nothing", expected));
}

bool Place::fail(std::string_view sentence) const {
  const std::string where = parent_ == nullptr ? "" : pointer() + ": ";
  return fail(
      Error{ErrorCode::kBadInput, fmt::format("{}: {}{}", state_.file.string(), where, sentence)});
}

bool Place::fail(const Error& error) const {
  constexpr std::size_t kMost = 50;
  if (!state_.error) {
    state_.error = error;
  } else if (state_.further.size() < kMost) {
    state_.further.push_back(error);
  }
  return false;
}

}  // namespace fogbench::config
