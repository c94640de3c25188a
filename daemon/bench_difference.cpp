#include "daemon/bench_difference.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "config/json_file.hpp"

namespace fogbench::daemon {
namespace {

using nlohmann::json;

constexpr std::size_t kMostSaid = 3;

json parsed(const std::string& text) {
  return json::parse(text, nullptr, /*exceptions=*/false);
}

/// A file of the record, {"name": "its text"...}, as what it says; null when it is not there.
json file_of(const json& record, const std::string& name) {
  const auto file = record.find(name);
  if (file == record.end() || !file->is_string()) return nullptr;
  return parsed(file->get_ref<const std::string&>());
}

std::string value_of(const json& value) {
  return config::one_line(value.dump(-1, ' ', false, json::error_handler_t::replace));
}

void compare_files(const std::string& name, const json& then, const json& now,
                   std::vector<std::string>& said) {
  for (const json& change : json::diff(then, now)) {
    const auto path = change.at("path").get<std::string>();
    const std::string where = name + ": " + (path.empty() ? "/" : path);
    const auto op = change.at("op").get<std::string>();
    if (op == "add") {
      said.push_back(fmt::format("{} is new: {}", where, value_of(change.at("value"))));
    } else if (op == "remove") {
      said.push_back(where + " is gone");
    } else {
      said.push_back(fmt::format("{} was {}, is {}", where,
                                 value_of(then.at(json::json_pointer(path))),
                                 value_of(change.at("value"))));
    }
  }
}

}  // namespace

std::string bench_difference(const std::string& then_json, const std::string& now_json) {
  if (then_json == now_json) return {};
  const json then = parsed(then_json), now = parsed(now_json);
  if (!then.is_object() || !now.is_object()) return "the record of the bench's files is damaged";
  std::vector<std::string> said;
  json names = then;
  names.update(now);
  for (const auto& [name, text] : names.items()) {
    const json before = file_of(then, name), after = file_of(now, name);
    if (before.is_null() || after.is_null()) {
      said.push_back(name + (before.is_null() ? " is new" : " is gone"));
    } else if (before.is_discarded() || after.is_discarded()) {
      said.push_back(name + " is another");
    } else {
      compare_files(name, before, after, said);
    }
  }
  const std::size_t more = said.size() > kMostSaid ? said.size() - kMostSaid : 0;
  said.resize(said.size() - more);
  return fmt::format("{}{}", fmt::join(said, "; "),
                     more > 0 ? fmt::format(" and {} more changes", more) : "");
}

}  // namespace fogbench::daemon
