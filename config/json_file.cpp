#include "config/json_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace fogbench::config {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kLargestFile = std::size_t{64} << 20;
constexpr std::size_t kDeepestNesting = 64;

Error bad(const std::string& where, const std::string& what) {
  return Error{ErrorCode::kBadInput, fmt::format("{}: {}", where, what)};
}

/// "parse error at line 3, column 5: unexpected ..." without what stands before the reason: the
/// library's own numbering of columns counts from the last byte read.
std::string reason_of(const std::string& library_message) {
  std::string_view text = library_message;
  for (const std::string_view mark : {"] ", "column ", ": "}) {
    const auto at = text.find(mark);
    if (at != std::string_view::npos) text.remove_prefix(at + mark.size());
    if (mark == "] " && text.find("column ") == std::string_view::npos) break;
  }
  return one_line(text, 200);
}

/// Builds the tree and refuses what the standard leaves to the reader.
class TreeBuilder final : public nlohmann::json_sax<json> {
 public:
  TreeBuilder(const std::string& text, const std::string& name) : text_(text), name_(name) {}

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t& /*digits*/) override {
    return put(value);
  }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t& /*value*/) override { return false; }
  bool start_object(std::size_t /*size*/) override { return open(json::object()); }
  bool start_array(std::size_t /*size*/) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& value) override {
    if (open_.back()->contains(value)) {
      error_ = bad(name_, fmt::format("{}/{}: this key stands twice; expected it once", pointer(),
                                      one_line(value)));
      return false;
    }
    keys_.back() = value;
    return true;
  }

  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::detail::exception& what) override {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(
                                         std::min(position > 0 ? position - 1 : 0, text_.size()));
    const auto line = 1 + std::count(text_.begin(), end, '\n');
    const auto line_begin = std::find(std::make_reverse_iterator(end), text_.rend(), '\n').base();
    error_ = bad(name_, fmt::format("line {}, column {}: {}", line, end - line_begin + 1,
                                    reason_of(what.what())));
    return false;
  }

  json root;
  const std::optional<Error>& error() const { return error_; }

 private:
  template <class T>
  json* place(T&& value) {
    if (open_.empty()) return &(root = std::forward<T>(value));
    json& parent = *open_.back();
    if (parent.is_array()) return &parent.emplace_back(std::forward<T>(value));
    return &(parent[keys_.back()] = std::forward<T>(value));
  }
  template <class T>
  bool put(T&& value) {
    place(std::forward<T>(value));
    return true;
  }
  bool open(json container) {
    if (open_.size() == kDeepestNesting) {
      error_ = bad(name_, fmt::format("nested deeper than {} levels", kDeepestNesting));
      return false;
    }
    open_.push_back(place(std::move(container)));
    keys_.emplace_back();
    return true;
  }
  bool close() {
    open_.pop_back();
    keys_.pop_back();
    return true;
  }
  std::string pointer() const {
    std::string result;
    for (std::size_t i = 0; i + 1 < open_.size(); ++i) {
      result += '/';
      result += open_[i]->is_array() ? std::to_string(open_[i]->size() - 1) : one_line(keys_[i]);
    }
    return result;
  }

  const std::string& text_;
  const std::string& name_;
  std::vector<json*> open_;
  std::vector<std::string> keys_;  ///< the key under way in each open container
  std::optional<Error> error_;
};

/// Length of the printable character that the text starts with, in UTF-8; 0 when it is none.
std::size_t printable_prefix(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < 0x80) return lead >= ' ' && lead != 0x7f ? 1 : 0;
  const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc2 ? 2 : 0;
  if (length == 0 || lead > 0xf4 || length > text.size()) return 0;
  const std::string_view tail = text.substr(1, length - 1);
  const bool whole = std::all_of(tail.begin(), tail.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0U) == 0x80;
  });
  return whole ? length : 0;
}

/// Appends `value`; on one line when it fits into what is left of it.
void append(std::string& out, const nlohmann::ordered_json& value, std::size_t indent,
            std::size_t column);

std::string on_one_line(const nlohmann::ordered_json& value) {
  std::string out;
  const char* separator = "";
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      out += separator + nlohmann::ordered_json(key).dump() + ": " + on_one_line(member);
      separator = ", ";
    }
    return "{" + out + "}";
  }
  if (value.is_array()) {
    for (const auto& member : value) {
      out += separator + on_one_line(member);
      separator = ", ";
    }
    return "[" + out + "]";
  }
  return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void append(std::string& out, const nlohmann::ordered_json& value, std::size_t indent,
            std::size_t column) {
  constexpr std::size_t kColumns = 100;
  const std::string line = on_one_line(value);
  if (!value.is_structured() || value.empty() || (indent > 0 && column + line.size() < kColumns)) {
    out += line;
    return;
  }
  const std::string margin(indent + 2, ' ');
  out += value.is_object() ? "{" : "[";
  const char* separator = "\n";
  for (const auto& [key, member] : value.items()) {
    std::string label;
    if (value.is_object()) label = nlohmann::ordered_json(key).dump() + ": ";
    out += separator + margin + label;
    append(out, member, indent + 2, margin.size() + label.size());
    separator = ",\n";
  }
  out += "\n" + std::string(indent, ' ') + (value.is_object() ? "}" : "]");
}

}  // namespace

Result<std::string> read_text_file(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) return bad(file.string(), "no such file");
  if (fs::is_directory(status)) return bad(file.string(), "a directory; expected a file");
  std::ifstream in(file, std::ios::binary);
  if (!in) return bad(file.string(), "cannot be opened for reading");
  std::string text;
  std::vector<char> block(std::size_t{1} << 16);
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (text.size() > kLargestFile) {
      return bad(file.string(), fmt::format("larger than {} MiB", kLargestFile >> 20));
    }
  }
  if (in.bad()) return bad(file.string(), "cannot be read");
  return text;
}

Result<json> parse_json(const std::string& text, const std::string& name) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    return bad(name, "empty; expected a JSON object");
  }
  TreeBuilder builder(text, name);
  if (json::sax_parse(text, &builder)) return std::move(builder.root);
  return builder.error().value_or(bad(name, "not JSON"));
}

Result<json> read_json_file(const fs::path& file) {
  auto text = read_text_file(file);
  if (!text) return text.error();
  return parse_json(*text, file.string());
}

std::string pretty_json(const nlohmann::ordered_json& value) {
  std::string out;
  append(out, value, 0, 0);
  return out + "\n";
}

std::string one_line(std::string_view text, std::size_t limit) {
  std::string out;
  while (!text.empty() && out.size() < limit) {
    const std::size_t length = printable_prefix(text);
    out += length > 0 ? text.substr(0, length) : "?";
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  if (!text.empty()) out += "...";
  return out;
}

}  // namespace fogbench::config
