#include "tests/architecture/rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>

namespace fogbench::tests {
namespace {

bool is_room(std::string_view folder) {
  return kMaySee.contains(folder);
}

bool may_see(std::string_view from, std::string_view to) {
  if (from == to || from == "tests") return true;
  const auto room = kMaySee.find(from);
  return room != kMaySee.end() && room->second.contains(std::string(to));
}

bool is_in_room(const SourceFile& file) {
  return file.is_cpp() && is_room(file.folder());
}

const SourceFile* find(const Tree& tree, std::string_view path) {
  const auto file =
      std::find_if(tree.begin(), tree.end(), [&](const SourceFile& f) { return f.path == path; });
  return file == tree.end() ? nullptr : &*file;
}

std::string parent(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash);
}

/// "file:line: <what was found> <says>" for every match of `pattern` in the member `text` of the
/// files chosen.
Violations matches(const Tree& tree, const std::function<bool(const SourceFile&)>& chosen,
                   std::string SourceFile::*text, const std::string& pattern,
                   const std::string& says) {
  const std::regex regex(pattern);
  Violations found;
  for (const SourceFile& file : tree) {
    if (!chosen(file)) continue;
    const std::string& subject = file.*text;
    for (std::sregex_iterator it(subject.begin(), subject.end(), regex), end; it != end; ++it) {
      const auto before =
          std::string_view(subject).substr(0, static_cast<std::size_t>(it->position()));
      found.push_back(
          fmt::format("{}:{}: `{}`: {}", file.path, line_count(before) + 1, it->str(), says));
    }
  }
  return found;
}

}  // namespace

Violations forbidden_includes(const Tree& tree) {
  Violations found;
  for (const SourceFile& file : tree) {
    if (!file.is_cpp()) continue;
    for (const std::string& include : quoted_includes(file)) {
      const std::string to = include.substr(0, include.find('/'));
      // What the build makes stands there as its template, or as the text that it holds.
      const std::string text = include.substr(0, include.rfind('.'));
      if (find(tree, include) == nullptr && find(tree, include + ".in") == nullptr &&
          find(tree, text) == nullptr) {
        found.push_back(fmt::format("{} includes \"{}\": no such file from the repository's root",
                                    file.path, include));
      } else if (!may_see(file.folder(), to)) {
        found.push_back(fmt::format("{} includes \"{}\": {} must not see {}", file.path, include,
                                    file.folder(), to));
      }
    }
  }
  return found;
}

Violations wrong_links(const Tree& tree) {
  static const std::string kPrefix = "fogbench::";
  Violations found;
  for (const auto& [room, seen] : kMaySee) {
    const SourceFile* cmake = find(tree, room + "/CMakeLists.txt");
    if (cmake == nullptr) continue;
    std::set<std::string> linked{room};
    for (const std::string& word : cmake_words(*cmake)) {
      if (!word.starts_with(kPrefix)) continue;
      const std::string to = word.substr(kPrefix.size());
      linked.insert(to);
      if (!may_see(room, to)) {
        found.push_back(
            fmt::format("{} links {}: {} must not see {}", cmake->path, word, room, to));
      }
    }
    for (const SourceFile& file : tree) {
      if (!file.is_cpp() || file.folder() != room) continue;
      for (const std::string& include : quoted_includes(file)) {
        const std::string to = include.substr(0, include.find('/'));
        if (!linked.contains(to)) {
          found.push_back(fmt::format("{} includes \"{}\", but {} does not link {}{}", file.path,
                                      include, cmake->path, kPrefix, to));
        }
      }
    }
  }
  return found;
}

Violations unlisted_sources(const Tree& tree) {
  Violations found;
  for (const SourceFile& file : tree) {
    if (!file.path.ends_with(".cpp") || is_in_room(file)) continue;
    std::string folder = parent(file.path);
    while (!folder.empty() && find(tree, folder + "/CMakeLists.txt") == nullptr) {
      folder = parent(folder);
    }
    const std::string list = folder.empty() ? "CMakeLists.txt" : folder + "/CMakeLists.txt";
    const std::string name = folder.empty() ? file.path : file.path.substr(folder.size() + 1);
    const SourceFile* cmake = find(tree, list);
    const auto words = cmake == nullptr ? std::vector<std::string>{} : cmake_words(*cmake);
    if (std::find(words.begin(), words.end(), name) == words.end()) {
      found.push_back(fmt::format("{} is not listed in {}", file.path, list));
    }
  }
  return found;
}

Violations homeless_sources(const Tree& tree) {
  Violations found;
  for (const SourceFile& file : tree) {
    if (file.is_cpp() && !is_room(file.folder()) && file.folder() != "tests") {
      found.push_back(fmt::format("{}: its folder is not a room of the house", file.path));
    }
  }
  return found;
}

Violations sources_without_header(const Tree& tree) {
  const SourceFile* commands = find(tree, "cli/command.hpp");
  Violations found;
  for (const SourceFile& file : tree) {
    if (!file.path.ends_with(".cpp") || !is_in_room(file)) continue;
    const std::string header = file.path.substr(0, file.path.size() - 3) + "hpp";
    const std::string name = std::filesystem::path(file.path).stem();
    const bool is_family = file.path.starts_with("model/effects/catalogue/") ||
                           file.path.starts_with("simulator/effects/catalogue/");
    const bool is_command = file.folder() == "cli" && commands != nullptr &&
                            commands->code.find("void add_" + name + "(") != std::string::npos;
    if (name == "main" || is_family || is_command || find(tree, header) != nullptr) continue;
    found.push_back(fmt::format(
        "{} has no {} beside it: join it with what it was cut from, or say there what it is",
        file.path, header));
  }
  return found;
}

Violations machine_time_or_chance(const Tree& tree) {
  const auto elsewhere = [](const SourceFile& file) {
    return is_in_room(file) && !file.path.starts_with("drivers/clock.") &&
           file.path != "daemon/session.cpp";
  };
  return matches(tree, elsewhere, &SourceFile::code,
                 R"(\b(steady_clock|system_clock|high_resolution_clock|file_clock|this_thread|)"
                 R"(clock_gettime|gettimeofday|nanosleep|usleep|wait_for|wait_until|)"
                 R"(random_device)\b|\b(time\(nullptr\)|s?rand\())",
                 "time comes from the Clock, chance from a seed");
}

Violations commands_outside_the_engine(const Tree& tree) {
  const auto above_the_engine = [](const SourceFile& file) {
    return is_in_room(file) && (file.folder() == "daemon" || file.folder() == "cli");
  };
  return matches(tree, above_the_engine, &SourceFile::code,
                 R"((->|\.)(set_target|set_mode|set_current|rotate_to)\()",
                 "only the run engine commands devices");
}

Violations thrown_exceptions(const Tree& tree) {
  return matches(tree, is_in_room, &SourceFile::code, R"(\bthrow\b)",
                 "errors are returned as Result");
}

Violations effects_known_by_name(const Tree& tree) {
  static const std::regex kName(
      R"re((==|!=|_with\(|find\(|compare\()\s*"(magnetic_\w*|bias_step|drift_linear|warm_up|)re"
      R"re(heater_power|ambient_temperature|coil_heating|earth_rate_projection|)re"
      R"re(temperature_(linear|quadratic|cubic|rate|rate_lagged|rate_cross|acceleration|gradient|)re"
      R"re(gradient_rate|hysteresis|ripple))")re");
  Violations found;
  for (const SourceFile& file : tree) {
    const bool asked = file.folder() == "model" || file.folder() == "cli" ||
                       file.folder() == "daemon" || file.folder() == "simulator";
    if (!asked || !file.is_cpp() || file.path.find("/effects/") != std::string::npos) continue;
    // Literals are blank in `code`.
    std::istringstream lines(file.includes);
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      std::smatch match;
      if (!std::regex_search(line, match, kName)) continue;
      found.push_back(fmt::format("{}:{} knows an effect by its name, \"{}\"", file.path, number,
                                  match[2].str()));
    }
  }
  return found;
}

Violations long_files(const Tree& tree) {
  Violations found;
  for (const SourceFile& file : tree) {
    const std::size_t lines = line_count(file.text);
    if (lines > kMostLines) {
      found.push_back(fmt::format("{}: {} lines, the most is {}", file.path, lines, kMostLines));
    }
  }
  return found;
}

Violations unfinished_work(const Tree& tree) {
  // Brackets around one letter of each word, so that this file is not found itself.
  static const std::string kPattern =
      R"(\b(T[O]DO|F[I]XME|X[X]X|H[A]CK|GTEST_[S]KIP|DISABLE[D]_\w+)\b)";
  return matches(
      tree, [](const SourceFile&) { return true; }, &SourceFile::text, kPattern,
      "finish it, or leave it out");
}

Violations dead_references(const Tree& tree,
                           const std::function<bool(const std::string&)>& exists) {
  // `model/effects/` or `config/units.hpp`; not `config/devices/NAME.json`, nor a segment such as
  // `coil_z/down`, whose first part is no folder of ours.
  static const std::regex kPath("`([a-z_]+/[a-z0-9_./-]*)`");
  Violations found;
  for (const SourceFile& file : tree) {
    if (!file.path.ends_with(".md")) continue;
    for (std::sregex_iterator it(file.text.begin(), file.text.end(), kPath), end; it != end; ++it) {
      const std::string path = (*it)[1];
      const std::string folder = path.substr(0, path.find('/'));
      const bool ours = is_room(folder) || folder == "tests" || folder == "scripts";
      if (ours && !exists(path)) {
        found.push_back(fmt::format("{} names `{}`, which does not exist", file.path, path));
      }
    }
  }
  return found;
}

}  // namespace fogbench::tests
