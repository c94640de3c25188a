#include "record/export.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "config/csv_text.hpp"
#include "procedures/channel_values.hpp"

namespace fogbench::record {
using procedures::Point;
using procedures::point_channels;

namespace {

template <class Number>
void append_number(fmt::memory_buffer& out, Number value) {
  if (!std::isnan(value)) fmt::format_to(std::back_inserter(out), "{}", value);
}

std::string_view text_of(const fmt::memory_buffer& buffer) {
  return {buffer.data(), buffer.size()};
}

}  // namespace

Result<std::vector<Point>> valid_points(RunLogReader& reader, std::int64_t run, bool unfinished) {
  const auto info = reader.run(run);
  if (!info) return info.error();
  if (!info->completed() && !unfinished) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("run {} was not completed ({}); --unfinished takes what it has", run,
                             info->outcome())};
  }
  const auto stored = reader.chain_points(run);
  if (!stored) return stored.error();
  std::vector<Point> points;
  for (const StoredPoint& point : *stored) {
    if (point.void_because.empty()) points.push_back(point.point);
  }
  if (points.empty()) {
    return Error{ErrorCode::kBadInput, fmt::format("run {} has no points", run)};
  }
  return points;
}

Status write_points(const std::vector<Point>& points, config::OutputFile& out) {
  fmt::memory_buffer text;
  const auto append = std::back_inserter(text);
  fmt::format_to(append, "test,segment,kind");
  for (const auto& channel : point_channels()) fmt::format_to(append, ",{}", channel.name);
  fmt::format_to(append, ",frames,frames_dropped");
  const auto auxiliary = procedures::auxiliary_names(points);
  for (const std::string& name : auxiliary) fmt::format_to(append, ",{}", name);
  text.push_back('\n');
  for (const Point& point : points) {
    fmt::format_to(append, "{},{},{}", point.test, config::csv_text(point.segment),
                   name_of(point.kind));
    for (const auto& channel : point_channels()) {
      text.push_back(',');
      append_number(text, point.*channel.value);
    }
    fmt::format_to(append, ",{},{}", point.count, point.dropped);
    for (const std::string& name : auxiliary) {
      text.push_back(',');
      append_number(text, procedures::value_of(point.auxiliary, name));
    }
    text.push_back('\n');
  }
  return out.write(text_of(text));
}

Status write_gyro(RunLogReader& reader, const StoredRun& run, config::OutputFile& out) {
  if (const Status ok = out.write("time_s,rate_deg_per_h,temperature_c\n"); !ok) return ok;
  const procedures::RunHeader& header = run.header;
  fmt::memory_buffer text;
  return reader.read_gyro(run.run, [&](const drivers::GyroBlock& block) -> Status {
    text.clear();
    const auto append = std::back_inserter(text);
    for (std::size_t i = 0; i < block.index.size(); ++i) {
      const double time_s = static_cast<double>(block.index[i]) / header.frame_rate_hz;
      // The difference is exact in double; float digits hold what the instrument said.
      const double rate = static_cast<double>(block.rate_deg_per_h[i]);
      const float corrected = static_cast<float>(rate - header.reference_rate_deg_per_h);
      fmt::format_to(append, "{:.6f},", time_s);
      append_number(text, corrected);
      text.push_back(',');
      if (!block.temperature_c.empty()) append_number(text, block.temperature_c[i]);
      text.push_back('\n');
    }
    return out.write(text_of(text));
  });
}

}  // namespace fogbench::record
