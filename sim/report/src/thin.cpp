#include "thin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace breakaway::report {
namespace {

// The points of one column of pixels.
class Column {
 public:
  explicit Column(std::size_t first) : first_{first}, last_{first}, least_{first}, most_{first} {}

  void add(const std::vector<Point>& points, std::size_t i) {
    last_ = i;
    if (points[i].y < points[least_].y) least_ = i;
    if (points[i].y > points[most_].y) most_ = i;
  }

  void append_to(std::vector<Point>& out, const std::vector<Point>& points) const {
    std::array kept{first_, least_, most_, last_};
    std::ranges::sort(kept);
    const auto end = std::unique(kept.begin(), kept.end());
    for (auto i = kept.begin(); i != end; ++i) out.push_back(points[*i]);
  }

 private:
  std::size_t first_, last_, least_, most_;
};

// From a to b, in tolerances.
Point between(Point a, Point b, double tolerance_x, double tolerance_y) {
  return {(b.x - a.x) / tolerance_x, (b.y - a.y) / tolerance_y};
}

// The distance of `p` from the segment 0..`end`.
double distance(Point p, Point end) {
  const double length2 = end.x * end.x + end.y * end.y;
  const double along = length2 > 0 ? std::clamp((p.x * end.x + p.y * end.y) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - along * end.x, p.y - along * end.y);
}

}  // namespace

std::vector<Point> thin_series(const std::vector<Point>& points, int columns) {
  if (points.size() <= most_of_series(columns)) return points;
  const double width = (points.back().x - points.front().x) / columns;
  const auto column_of = [&](const Point& p) { return std::floor((p.x - points.front().x) / width); };
  std::vector<Point> out;
  for (std::size_t i = 0; i < points.size();) {
    const double place = column_of(points[i]);
    const bool gap = std::isnan(points[i].y);
    if (gap && (out.empty() || !std::isnan(out.back().y))) out.push_back(points[i]);
    Column column{i};
    for (++i; i < points.size() && std::isnan(points[i].y) == gap && (gap || column_of(points[i]) == place); ++i) {
      column.add(points, i);
    }
    if (!gap) column.append_to(out, points);
  }
  return out;
}

// The method of Ramer, Douglas and Peucker: a stretch keeps its point that is furthest from the line between its ends,
// until none is further than the tolerance.
std::vector<Point> thin_curve(const std::vector<Point>& points, double tolerance_x, double tolerance_y) {
  if (points.size() < 3) return points;
  std::vector<bool> kept(points.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> stretches{{0, points.size() - 1}};
  while (!stretches.empty()) {
    const auto [from, to] = stretches.back();
    stretches.pop_back();
    const Point end = between(points[from], points[to], tolerance_x, tolerance_y);
    std::size_t furthest = from;
    double most = 1;
    for (std::size_t i = from + 1; i < to; ++i) {
      const double d = distance(between(points[from], points[i], tolerance_x, tolerance_y), end);
      if (d > most) most = d, furthest = i;
    }
    if (furthest == from) continue;
    kept[furthest] = true;
    stretches.push_back({from, furthest});
    stretches.push_back({furthest, to});
  }
  std::vector<Point> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kept[i]) out.push_back(points[i]);
  }
  return out;
}

}  // namespace breakaway::report
