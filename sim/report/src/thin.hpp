// Fewer points for the same picture, so that a long run makes no longer report.
#pragma once

#include <cstddef>
#include <vector>

namespace breakaway::report {

struct Point {
  double x = 0;
  double y = 0;
};

// What thin_series leaves of any series, gaps aside.
constexpr std::size_t most_of_series(int columns) { return 4 * static_cast<std::size_t>(columns); }

// A series over rising x: in each of `columns` equal spans the first, the last, the least and the greatest point, which
// is all that a column of pixels can show. A point with y = NaN is a gap; of several in a row one stays. A series of no
// more than most_of_series(columns) points stays as it is.
std::vector<Point> thin_series(const std::vector<Point>& points, int columns);

// A curve in the plane: no point of the given curve is further than one tolerance, in x and y each measured in its own,
// from the lines that join the points that stay. All finite; tolerances > 0.
std::vector<Point> thin_curve(const std::vector<Point>& points, double tolerance_x, double tolerance_y);

}  // namespace breakaway::report
