#pragma once
// The daemon in the text format of Prometheus (0.0.4): what daemon/README.md lists.

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "config/result.hpp"
#include "daemon/run_desk.hpp"
#include "daemon/totals.hpp"
#include "drivers/clock.hpp"

namespace fogbench::daemon {

/// `bench` is its name. Values of a run are there while it is under way: an old temperature that
/// looks new is worse than none.
std::string metrics_text(const std::string& bench, const DeskView& view,
                         const ControlTotals& control);

/// The same in a file, for node_exporter's textfile collector: a reader sees the old text or the
/// new one. The file goes with the daemon; what a killed one leaves is old, which its time of
/// modification says.
class MetricsFile {
 public:
  static constexpr std::chrono::seconds kEvery{10};

  /// kBadInput when the file cannot be written. An empty path: none is.
  static Result<std::unique_ptr<MetricsFile>> open(const std::filesystem::path& path,
                                                   drivers::Clock& clock);
  MetricsFile(const MetricsFile&) = delete;
  MetricsFile& operator=(const MetricsFile&) = delete;
  ~MetricsFile();

  /// Writes when kEvery has passed. A failure is in the log once, and tried again.
  void update(const std::function<std::string()>& text);

 private:
  MetricsFile(std::filesystem::path path, drivers::Clock& clock)
      : path_(std::move(path)), clock_(clock) {}

  std::filesystem::path path_;
  drivers::Clock& clock_;
  drivers::Clock::Instant due_ = drivers::Clock::Instant::min();
  bool failing_ = false;
};

}  // namespace fogbench::daemon
