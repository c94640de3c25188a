#include "config/limits.hpp"

#include "config/describe_model.hpp"

namespace fogbench::config {

bool check(const Place& at, const Limit& l) {
  if (!l.minimum && !l.maximum && !l.repeatability) {
    return at.fail(
        "has neither \"minimum\" nor \"maximum\" nor \"repeatability\"; expected one or more");
  }
  if (l.minimum && l.maximum && *l.minimum > *l.maximum) {
    return (at / "minimum").wrong(fmt::format("at most the maximum {}", *l.maximum));
  }
  return true;
}

bool check(const Place& at, const LimitsConfig& l) {
  const Place limits = at / "limits";
  for (std::size_t i = 0; i < l.limits.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (l.limits[i].quantity == l.limits[j].quantity) {
        return (limits / i / "quantity").wrong("a quantity that does not stand twice");
      }
    }
  }
  return true;
}

Result<LimitsConfig> load_limits(const std::filesystem::path& file) {
  return read_config<LimitsConfig>(file);
}

}  // namespace fogbench::config
