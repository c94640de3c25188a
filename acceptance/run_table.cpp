#include "acceptance/run_table.hpp"

#include <algorithm>
#include <string>

#include "record/store.hpp"

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
  for (const record::PointColumn& column : record::point_columns()) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Point& point : points) values.push_back(point.*column.value);
    table.set_column(std::string(column.name), std::move(values));
  }
  table.set_run(text_column(points, [](const Point& point) { return std::to_string(point.test); }));
  table.set_segment(text_column(points, [](const Point& point) { return point.segment; }));
  return table;
}

}  // namespace fogbench::acceptance
