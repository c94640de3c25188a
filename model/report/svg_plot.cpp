#include "model/report/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fogbench::model {
namespace {

// The plot's own coordinates; the page scales it to the width it has.
constexpr double kWidth = 480.0, kHeight = 306.0;
constexpr double kLeft = 66.0, kRight = 14.0, kTop = 40.0, kBottom = 48.0;

/// One axis: data to the plot's coordinates.
struct Axis {
  double low, high, start, end;
  double operator()(double value) const {
    return start + (value - low) / (high - low) * (end - start);
  }
};

Axis make_axis(double low, double high, double start, double end) {
  if (!(low < high)) {
    const double half = std::max(std::abs(low) * 0.05, 1e-6);
    low -= half;
    high += half;
  }
  const double margin = 0.04 * (high - low);
  return {low - margin, high + margin, start, end};
}

std::string tick_text(double value, double span, bool decimal_comma) {
  if (std::abs(value) < 1e-9 * span) value = 0.0;
  std::string text = fmt::format("{:.6g}", value);
  if (decimal_comma) std::replace(text.begin(), text.end(), '.', ',');
  return text;
}

bool is_finite(const std::pair<double, double>& point) {
  return std::isfinite(point.first) && std::isfinite(point.second);
}

struct Extent {
  double x_low = HUGE_VAL, x_high = -HUGE_VAL, y_low = HUGE_VAL, y_high = -HUGE_VAL;
  bool empty() const { return !(x_low <= x_high); }
};

Extent extent_of(const SvgPlot& plot) {
  Extent out;
  for (const SvgPlot::Series& series : plot.series) {
    for (const auto& point : series.points) {
      if (!is_finite(point)) continue;
      out.x_low = std::min(out.x_low, point.first);
      out.x_high = std::max(out.x_high, point.first);
      out.y_low = std::min(out.y_low, point.second);
      out.y_high = std::max(out.y_high, point.second);
    }
  }
  if (plot.zero_line) {
    out.y_low = std::min(out.y_low, -plot.envelope);
    out.y_high = std::max(out.y_high, plot.envelope);
  }
  if (plot.diagonal) {
    out.x_low = out.y_low = std::min(out.x_low, out.y_low);
    out.x_high = out.y_high = std::max(out.x_high, out.y_high);
  }
  return out;
}

/// What follows the mark's centre in a path.
std::string mark_path(SvgPlot::Mark mark, double radius) {
  switch (mark) {
    case SvgPlot::Mark::kSquare:
      return fmt::format("m-{0} -{0}h{1}v{1}h-{1}z", radius, 2.0 * radius);
    case SvgPlot::Mark::kRight:
      return fmt::format("m{0} 0l-{1} -{0}v{1}z", radius, 2.0 * radius);
    case SvgPlot::Mark::kLeft:
      return fmt::format("m-{0} 0l{1} -{0}v{1}z", radius, 2.0 * radius);
    case SvgPlot::Mark::kDot:
      break;
  }
  return "h0";  // no length: a round line cap of the dot's width
}

/// One plot being drawn.
class Drawing {
 public:
  Drawing(const SvgPlot& plot, const Extent& extent)
      : plot_(plot),
        x_(make_axis(extent.x_low, extent.x_high, kLeft, kWidth - kRight)),
        y_(make_axis(extent.y_low, extent.y_high, kHeight - kBottom, kTop)) {}

  std::string svg() {
    out_ = fmt::format("<svg{} viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">\n",
                       plot_.kind.empty() ? "" : fmt::format(" class=\"{}\"", plot_.kind), kWidth,
                       kHeight, escaped(plot_.title));
    bands();
    grid();
    lines();
    for (const SvgPlot::Series& series : plot_.series) marks(series);
    band_labels();
    labels();
    return out_ + "</svg>\n";
  }

 private:
  void line(const char* kind, double x1, double y1, double x2, double y2) {
    out_ += fmt::format(
        "<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind, x1,
        y1, x2, y2);
  }

  void text(const char* kind, double x, double y, const std::string& words) {
    out_ += fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", kind, x, y,
                        escaped(words));
  }

  /// Where a band begins and ends: a single value is widened until it can be seen. False: outside
  /// the plot.
  bool place(const SvgPlot::Band& band, double& from, double& to) const {
    constexpr double kLeastWidth = 10.0, kLeastMargin = 0.5;
    const double margin =
        std::max(0.5 * (kLeastWidth - (x_(band.to) - x_(band.from))), kLeastMargin);
    from = std::max(x_(band.from) - margin, kLeft);
    to = std::min(x_(band.to) + margin, kWidth - kRight);
    return to > from;
  }

  void bands() {
    double from = 0.0, to = 0.0;
    for (const SvgPlot::Band& band : plot_.bands) {
      if (!place(band, from, to)) continue;
      out_ += fmt::format(
          "<rect class=\"band\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\">"
          "<title>{}</title></rect>\n",
          from, kTop, to - from, kHeight - kBottom - kTop, escaped(band.title));
    }
  }

  /// The first band's number wins where two would overlap.
  void band_labels() {
    constexpr double kRoom = 15.0;
    std::vector<double> taken;
    double from = 0.0, to = 0.0;
    for (const SvgPlot::Band& band : plot_.bands) {
      if (band.label.empty() || !place(band, from, to)) continue;
      const double at = 0.5 * (from + to);
      if (std::any_of(taken.begin(), taken.end(),
                      [&](double other) { return std::abs(other - at) < kRoom; })) {
        continue;
      }
      taken.push_back(at);
      text("number middle", at, kTop - 4.0, band.label);
    }
  }

  void grid() {
    for (double tick : round_ticks(x_.low, x_.high)) {
      line("grid", x_(tick), kTop, x_(tick), kHeight - kBottom);
      text("tick middle", x_(tick), kHeight - kBottom + 16.0,
           tick_text(tick, x_.high - x_.low, plot_.decimal_comma));
    }
    for (double tick : round_ticks(y_.low, y_.high)) {
      line("grid", kLeft, y_(tick), kWidth - kRight, y_(tick));
      text("tick end", kLeft - 6.0, y_(tick) + 4.0,
           tick_text(tick, y_.high - y_.low, plot_.decimal_comma));
    }
  }

  void lines() {
    if (plot_.diagonal) line("model", x_(x_.low), y_(x_.low), x_(x_.high), y_(x_.high));
    if (plot_.zero_line) line("model", kLeft, y_(0.0), kWidth - kRight, y_(0.0));
    if (!(plot_.envelope > 0.0)) return;
    for (double y : {-plot_.envelope, plot_.envelope}) {
      line("noise", kLeft, y_(y), kWidth - kRight, y_(y));
    }
  }

  void marks(const SvgPlot::Series& series) {
    const auto kind = escaped(series.kind);
    const std::size_t n = series.points.size();
    const double radius = n <= 100 ? 3.5 : n <= 500 ? 2.5 : 1.5;
    const std::string mark = mark_path(series.mark, radius);
    std::string path, joint, rows;
    bool pen_down = false;
    for (std::size_t i = 0; i < n; ++i) {
      const bool drawn = is_finite(series.points[i]);
      if (drawn) {
        const double x = x_(series.points[i].first), y = y_(series.points[i].second);
        path += fmt::format("M{:.1f} {:.1f}{}", x, y, mark);
        joint += fmt::format("{}{:.1f} {:.1f}", pen_down ? 'L' : 'M', x, y);
        if (!series.rows.empty()) rows += (rows.empty() ? "" : " ") + series.rows[i];
      }
      pen_down = drawn;
    }
    if (path.empty()) return;
    if (series.joined) out_ += fmt::format("<path class=\"joint {}\" d=\"{}\"/>\n", kind, joint);
    const bool dots = series.mark == SvgPlot::Mark::kDot;
    out_ += fmt::format("<path class=\"{} {}\"{}{} d=\"{}\"/>\n", dots ? "dots" : "marks", kind,
                        dots ? fmt::format(" stroke-width=\"{}\"", 2.0 * radius) : "",
                        rows.empty() ? "" : fmt::format(" data-rows=\"{}\"", rows), path);
  }

  void labels() {
    text("title", kLeft, 20.0, plot_.title);
    text("label middle", 0.5 * (kLeft + kWidth - kRight), kHeight - 10.0, plot_.x_label);
    out_ += fmt::format(
        "<text class=\"label middle\" transform=\"translate(14 {:.1f}) rotate(-90)\">{}</text>\n",
        0.5 * (kTop + kHeight - kBottom), escaped(plot_.y_label));
  }

  const SvgPlot& plot_;
  Axis x_, y_;
  std::string out_;
};

}  // namespace

std::vector<double> round_ticks(double low, double high) {
  const double raw = (high - low) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double part = raw / power;
  const double step = power * (part < 1.5 ? 1.0 : part < 3.5 ? 2.0 : part < 7.5 ? 5.0 : 10.0);
  std::vector<double> out;
  for (double k = std::ceil(low / step); k * step <= high; k += 1.0) out.push_back(k * step);
  return out;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string SvgPlot::svg() const {
  const Extent extent = extent_of(*this);
  return extent.empty() ? "" : Drawing(*this, extent).svg();
}

}  // namespace fogbench::model
