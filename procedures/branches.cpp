#include "procedures/branches.hpp"

#include <map>

namespace fogbench::procedures {
namespace {

int direction(double from, double to) {
  return to > from ? 1 : (to < from ? -1 : 0);
}

bool returns_to_zero(double first, double last, int way) {
  return last == 0.0 && (way > 0 ? first <= 0.0 : first >= 0.0);
}

}  // namespace

std::vector<std::string> branch_names(const std::vector<double>& levels) {
  std::vector<std::string> names;
  std::map<std::string, int> uses;
  while (names.size() < levels.size()) {
    const std::size_t begin = names.size();
    const std::size_t before = begin == 0 ? 0 : begin - 1;  // where the field comes from
    int way = 0;
    std::size_t last = before;
    while (last + 1 < levels.size()) {
      const int next = direction(levels[last], levels[last + 1]);
      if (way != 0 && next != 0 && next != way) break;
      if (next != 0) way = next;
      ++last;
    }
    std::string name = way < 0 ? "down" : "up";
    if (begin > 0 && returns_to_zero(levels[before], levels[last], way)) name = "return";
    const int use = ++uses[name];
    if (use > 1) name += std::to_string(use);
    names.resize(std::max(last, begin) + 1, name);
  }
  return names;
}

}  // namespace fogbench::procedures
