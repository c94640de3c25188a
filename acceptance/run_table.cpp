#include "acceptance/run_table.hpp"

#include <algorithm>
#include <string>

#include "procedures/channel_values.hpp"

namespace fogbench::acceptance {
using procedures::Point;

namespace {

template <class TextOf>
model::TextColumn text_column(const std::vector<Point>& points, TextOf text_of) {
  model::TextColumn column;
  for (const Point& point : points) {
    const std::string text = text_of(point);
    const auto known = std::find(column.values.begin(), column.values.end(), text);
    column.index.push_back(static_cast<std::uint32_t>(known - column.values.begin()));
    if (known == column.values.end()) column.values.push_back(text);
  }
  return column;
}

}  // namespace

model::Table to_table(const std::vector<Point>& points) {
  model::Table table;
  const auto add = [&](std::string name, const auto& value_of) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Point& point : points) values.push_back(value_of(point));
    table.set_column(std::move(name), std::move(values));
  };
  for (const procedures::PointChannel& channel : procedures::point_channels()) {
    add(std::string(channel.name), [&](const Point& point) { return point.*channel.value; });
  }
  for (const std::string& name : procedures::auxiliary_names(points)) {
    add(name, [&](const Point& point) { return procedures::value_of(point.auxiliary, name); });
  }
  table.set_run(text_column(points, [](const Point& point) { return std::to_string(point.test); }));
  table.set_run_word("test");
  table.set_segment(text_column(points, [](const Point& point) { return point.segment; }));
  return table;
}

}  // namespace fogbench::acceptance
