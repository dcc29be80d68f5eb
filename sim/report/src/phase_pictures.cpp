#include "phase_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/plot_style.hpp"
#include "plot_data.hpp"
#include "thin.hpp"

namespace breakaway::report {
namespace {

using config::Axis;
using sil::AxisResult;

// c_hi and c_lo of (9): where the axis can stick.
struct StickSets {
  double upper_m, lower_m;
};

// There are none where no spring acts on an axis at rest, under the coasts "brake" and "work": it sticks anywhere.
std::optional<StickSets> stick_sets(const Axis& axis) {
  const auto& gains = axis.controller.impulsive;
  if (gains && gains->coast != law::Coast::pd) return std::nullopt;
  const double stiffness = gains ? gains->stiffness_N_per_m : axis.controller.pid->proportional_N_per_m;
  return StickSets{axis.friction.bounds.upper_N / stiffness, axis.friction.bounds.lower_N / stiffness};
}

struct Window {
  double least, most;
  double width() const { return most - least; }
};

template <class Value>
Window window_of(const AxisResult& result, Value value) {
  const auto [least, most] = std::ranges::minmax(result.trace, {}, value);
  return {std::invoke(value, least), std::invoke(value, most)};
}

// What is shown of the plane. Positions count from origin_m, so that the last micrometres have readable numbers.
struct View {
  double origin_m;
  Window position_m, velocity_m_s;
};

// Position and velocity to a fifth of a pixel of what is shown.
std::string solution(const AxisResult& result, const View& view) {
  std::vector<Point> points;
  for (const sil::Sample& s : result.trace) points.push_back({s.position_m - view.origin_m, s.velocity_m_s});
  const double share = 0.2 / format::width_px;
  return data("solution", thin_curve(points, std::max(share * view.position_m.width(), 1e-30),
                                     std::max(share * view.velocity_m_s.width(), 1e-30)));
}

// What lies in the plane beside the solution: blocks of data, and what is plotted of them before it.
struct Marks {
  std::string blocks, plots;
};

Marks marks_of(const StickSets& sets, double target_m) {
  return {fmt::format("$outer << END\n{} 0 {} 0\nEND\n$inner << END\n{} 0 {} 0\nEND\n", number(target_m - sets.upper_m),
                      number(2 * sets.upper_m), number(target_m - sets.lower_m), number(2 * sets.lower_m)),
          "$outer using 1:2:3:4 with vectors nohead linestyle 6 title 'maximal stick set', "
          "$inner using 1:2:3:4 with vectors nohead linestyle 7 title 'minimal stick set', "};
}

// The tolerance around the target, and the places from which the axis is kicked.
Marks marks_of_kicks(double tolerance_m, const AxisResult& result, Window velocity_m_s) {
  const auto edge = [&](double place_m) {
    return fmt::format("{} {} {}\n", number(place_m), number(velocity_m_s.least), number(velocity_m_s.most));
  };
  const double target_m = result.trace.back().target_m;
  return {"$band << END\n" + edge(-tolerance_m) + edge(tolerance_m) + "END\n" +
              data("kicks", result.kicks,
                   [&](const sil::KickRecord& k) {
                     return std::array{k.position_m - target_m, 0.0};
                   }),
          "$band using 1:2:3 with filledcurves fillcolor '#d9efe3' title 'tolerance', "
          "$kicks using 1:2 with points linestyle 8 title 'kicks', "};
}

std::string phase_plot(const AxisResult& result, const View& view, const Marks& marks, const std::string& settings) {
  return format::plot_style + solution(result, view) + marks.blocks +
         "set tmargin 3\nset offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05\n" + settings +
         "set ylabel 'velocity [m/s]'\nplot " + marks.plots +
         "$solution using 1:2 with lines linestyle 1 title 'solution'";
}

std::string caption(const Axis& axis, bool has_sets) {
  if (!has_sets)
    return "The solution in the plane of position and velocity. The law has no spring that pulls an axis at rest, so "
           "that "
           "it can stick anywhere.";
  return axis.controller.pid
             ? "The solution in the plane of position and velocity, with the sets in which friction can hold "
               "the proportional part: the greatest friction (maximal) and the least (minimal)."
             : "The solution in the plane of position and velocity, with the sets in which the axis can "
               "stick: for the greatest friction (maximal) and for the least (minimal). Compare Figure 6 of "
               "van de Wouw & Leine.";
}

Picture phase_plane(const Axis& axis, const AxisResult& result) {
  const auto sets = stick_sets(axis);
  const View whole{0, window_of(result, &sil::Sample::position_m), window_of(result, &sil::Sample::velocity_m_s)};
  const Marks marks = sets ? marks_of(*sets, result.trace.back().target_m) : Marks{};
  const std::string plot = phase_plot(result, whole, marks, "set xlabel 'position [m]'\n") +
                           ", $solution every ::0::0 using 1:2 with points pointtype 7 pointsize 0.6 linecolor "
                           "'#1c5d99' title 'start'";
  return {"Phase plane", caption(axis, sets.has_value()), format::draw_svg("phase", format::width_px, 460, plot)};
}

// What is shown near the target: so far to either side, and as fast as the axis is from some time on where it is near.
struct Nearness {
  double half_width_m, near_m, from_s;
};

// The first kick on the last way to the target; nullptr without one.
const sil::KickRecord* first_kick(const AxisResult& result) {
  const double target_m = result.trace.back().target_m;
  const auto set_after = std::ranges::find_if(result.trace.rbegin(), result.trace.rend(),
                                              [&](const sil::Sample& s) { return s.target_m != target_m; });
  const double set_s = set_after == result.trace.rend() ? -1 : set_after->time_s;
  const auto kick = std::ranges::find_if(result.kicks, [&](const sil::KickRecord& k) { return k.time_s > set_s; });
  return kick == result.kicks.end() ? nullptr : &*kick;
}

// Where the axis can stick; or where it is kicked, which is how the coasts "brake" and "work" lead it on.
std::optional<Nearness> nearness(const Axis& axis, double tolerance_m, const AxisResult& result) {
  if (const auto sets = stick_sets(axis)) return Nearness{1.25 * sets->upper_m, sets->upper_m / 3, 0};
  const sil::KickRecord* kick = first_kick(result);
  if (kick == nullptr) return std::nullopt;
  const double half_m = 1.3 * std::max(std::fabs(kick->error_m), tolerance_m);
  return Nearness{half_m, half_m, kick->time_s};
}

// Around the final target, as fast as the axis moves on its last way there.
std::optional<View> view_near_target(const Nearness& near, const AxisResult& result) {
  const double target_m = result.trace.back().target_m;
  constexpr double seen = 0.0375;  // of the whole, in which what is wider shows
  if (near.half_width_m > seen * window_of(result, &sil::Sample::position_m).width()) return std::nullopt;
  Window v{0, 0};
  for (const sil::Sample& x : result.trace) {
    const bool is_shown = x.time_s >= near.from_s && std::fabs(x.position_m - target_m) <= near.near_m;
    if (x.target_m == target_m && is_shown) v = {std::min(v.least, x.velocity_m_s), std::max(v.most, x.velocity_m_s)};
  }
  if (v.width() == 0) return std::nullopt;  // it never moved there
  const double margin_m_s = 0.15 * v.width();
  return View{target_m, {-near.half_width_m, near.half_width_m}, {v.least - margin_m_s, v.most + margin_m_s}};
}

std::string caption_near_target(const Axis& axis, bool has_sets) {
  if (axis.controller.pid) return "The same around the stick sets.";
  return has_sets ? "The same around the stick sets: each kick gives the axis speed, and it slides to rest closer to "
                    "the target."
                  : "The same where the axis is kicked on: each kick gives it speed, and it slides to rest again. The "
                    "line joins "
                    "the ends of the periods.";
}

Picture phase_plane_near_target(const Axis& axis, double tolerance_m, const AxisResult& result, const View& view) {
  const auto [x, v] = std::pair{view.position_m, view.velocity_m_s};
  const std::string settings =
      fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\nset xlabel 'position less target [m]'\n", number(x.least),
                  number(x.most), number(v.least), number(v.most));
  const auto sets = stick_sets(axis);
  const Marks marks = sets ? marks_of(*sets, 0) : marks_of_kicks(tolerance_m, result, v);
  return {"Phase plane near the target", caption_near_target(axis, sets.has_value()),
          format::draw_svg("phase_near", format::width_px, 420, phase_plot(result, view, marks, settings))};
}

}  // namespace

std::vector<Picture> draw_phase_planes(const Axis& axis, double tolerance_m, const AxisResult& result) {
  std::vector<Picture> pictures{phase_plane(axis, result)};
  const auto near = nearness(axis, tolerance_m, result);
  const auto view = near ? view_near_target(*near, result) : std::nullopt;
  if (view) pictures.push_back(phase_plane_near_target(axis, tolerance_m, result, *view));
  return pictures;
}

}  // namespace breakaway::report
