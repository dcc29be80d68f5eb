// What the coast "brake" needs on the controller, and what it promises: worked out for a class of axes.
//
// A kick of force F and n periods moves an axis of the class by at least D_min(F) and at most D_max(F); see
// pulse_travel.hpp. With A' and B' the friction bounds, a force of w beside the drive's taken off the one and put on
// the other, D_max is the travel under friction A', the largest force gain, the least mass and the fastest current
// loop, D_min that under B', the least gain, the largest mass and the slowest loop. The table holds F with D_max(F) = y
// at each distance y, rounded to one side: no kick goes beyond the target.
//
// The friction and the force beside the drive's may vary as they like within their bounds. That D grows with the
// force gain and falls with the lag, for the kicks that the table holds, is not proved but tested over random kicks.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "breakaway/design/spring_load.hpp"
#include "breakaway/law/braked_kicks.hpp"
#include "breakaway/law/friction_bounds.hpp"

namespace breakaway::design {

struct Interval {
  double least = 0;
  double most = 0;

  friend constexpr bool operator==(const Interval&, const Interval&) = default;
};

// What a move may take until brake and kicks end it. All must be above 0.
struct MoveRequest {
  double distance_m = 0;  // the longest
  double speed_m_s = 0;
  double acceleration_m_s2 = 0;       // either way, of every axis of the class
  std::optional<double> jerk_m_s3{};  // of what is planned; friction that jumps moves the axis as it likes

  friend constexpr bool operator==(const MoveRequest&, const MoveRequest&) = default;
};

// By how much readings of an axis at rest may differ [m]. Noise however small takes a place at the edge of a count to
// either side of it, so that they differ by whole counts; rounding adds its own at each of two places.
inline double flicker_m(double noise_m, double rounding_m, double resolution_m) {
  constexpr double rounding = 1e-6;  // of a count: so much above whole ones is none
  const double counts = std::ceil(2 * (noise_m - rounding_m) / resolution_m - rounding);
  return std::max(counts, 0.0) * resolution_m + 2 * rounding_m;
}

// The axes that the kicks are made for. All but lags, load_N, jitter_s, encoder_resolution_m, encoder_noise_m and
// latency_periods must be above 0, and jitter_s at most most_jitter of the period.
struct BrakedClass {
  Interval mass_kg{1, 1};
  Interval force_gain{1, 1};  // force that acts, per force that is commanded
  Interval lag_s{0, 0};       // time constant of the current loop
  law::FrictionBounds<double> friction{};
  double load_N = 0;        // of a force beside the drive's, either way
  double max_force_N = 0;   // as commanded
  double force_step_N = 0;  // in which force can be commanded
  double period_s = 0;
  double jitter_s =
      0;  // by which the instants of sampling and of new forces are off whole periods, one against another
  double encoder_resolution_m = 0;
  double encoder_noise_m = 0;  // by which a reading is off beside half a count, either way
  double rounding_m = 0;       // the share of that which is the same at the same place, as that of a float
  int latency_periods = 1;
  double presliding_stiffness_N_per_m = 0;  // of friction before it slides, at least; 0: it holds at once
  double fine_tolerance_m = 0;  // law::FineStage aims at this tolerance where it is below the least; 0: never
  std::optional<MoveRequest> move{};
  std::optional<SpringLoad> spring_load{};  // mass_kg and friction are of both then

  double reading_error_m() const { return encoder_resolution_m / 2 + encoder_noise_m; }
  double flicker_m() const { return design::flicker_m(encoder_noise_m, rounding_m, encoder_resolution_m); }

  friend constexpr bool operator==(const BrakedClass&, const BrakedClass&) = default;
};

constexpr int longest_pulse_periods = 255;
constexpr double most_jitter = 0.5;  // of the period

// Of the error before it, a kick takes at least this share away, under any friction of the class.
constexpr double least_share = 0.03;

template <class Real>
struct BrakedDesign {
  law::BrakedKicks<Real> kicks{};
  bool brake_holds = false;   // b is below A' with the largest gain, and A' is above 0
  bool breaks_away = false;   // some pulse within max_force_N is sure to exceed B', and can be cut
  bool rest_is_seen = false;  // the time that proves rest can be counted
  double pulse_needed_N = 0;  // the least command that is sure to exceed B' within some number of periods; infinite
                              // where the current loop is so slow that the drive cannot cut a pulse
  double floor_m = 0;         // from here on each kick takes at least least_share away; infinite where none does
  double reach_m = 0;         // up to here: beyond it kicks are those of the table's end
  double aim_lost = 0;        // largest share of the distance by which a kick aims short, rounding to steps apart
  double peak_speed_m_s = 0;  // which no kick exceeds, from rest anywhere
  double farthest_m = 0;  // from further away Real no longer tells an axis that sets off slowly from one that sticks
  std::size_t table_bytes = 0;

  double least_reading_m = 0;  // no tolerance below this can be told from another reading

  // The tolerance must be at least this: the floor, and what can be read.
  double least_tolerance_m = 0;

  bool has_fine_stage() const { return kicks.fine_floor_m > 0; }
  bool possible() const { return brake_holds && breaks_away && rest_is_seen && floor_m < reach_m; }
};

template <class Real>
BrakedDesign<Real> design_braked_kicks(const BrakedClass& axes);

// The distance from the target at which the approach gives way to brake and kicks.
template <class Real>
double hand_over_m(const BrakedDesign<Real>& design);

// An approach that may go this fast moves every axis of the class, and no rise of friction stops it before the plan can
// answer; a slower one may have too little force for that, or get on by a few periods at a time.
template <class Real>
double least_approach_speed_m_s(const BrakedClass& axes, const BrakedDesign<Real>& design);

// The way over which Real tells what an approach does that may go this fast, [m].
template <class Real>
double farthest_approach_m(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s);

// The distance from which kicks may be needed: a hundredth more than hand_over_m, or what one kick can aim for,
// whichever is more. In a move, whose limits no kick keeps, they begin from beyond hand_over_m only where friction has
// stopped as many approaches as the law tries.
template <class Real>
double kicks_begin_m(const BrakedDesign<Real>& design);

// The most that a pulse moves an axis of the class, and the least; force_N is as commanded.
double most_travel_m(const BrakedClass& axes, double force_N, int periods, int cut_periods);
double least_travel_m(const BrakedClass& axes, double force_N, int periods, int cut_periods);

// The limits of a move that are certified: an acceleration and a speed of at least this, and a jerk between those,
// behind a current loop whose time constant is at most a share of the period, where mass and force gain are known well.
// The first is needed by proof; the others are what was tested.
double least_acceleration_m_s2(const BrakedClass& axes);
template <class Real>
double least_move_speed_m_s(const BrakedDesign<Real>& design);
template <class Real>
bool keeps_speed(const BrakedClass& axes, const BrakedDesign<Real>& design);  // with a margin that leaves enough of it
Interval jerk_m_s3(const BrakedClass& axes);                                  // of a class with a move
constexpr double most_lag_with_jerk = 0.5;                                    // of the period
constexpr double most_unknown_with_jerk = 0.1;                                // of mass and force gain together

// The speed that an approach from up to so far away may reach which is to go no faster than this, [m/s]: tested, not
// proved.
template <class Real>
double approach_peak_m_s(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s,
                         double from_m = 0);

// So far may an axis go on whose target comes to lie behind it, until it turns, where its approach goes no faster than
// this, [m].
template <class Real>
double turning_m(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s, double from_m = 0);

// So far may an approach go beyond its target before brake and kicks take over, where it goes no faster than this, also
// where readings that jitter or are lost are off as it is to begin to brake: tested, not proved.
template <class Real>
double approach_beyond_m(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s);

// So far may a kick go beyond its target where friction bends before it slides; 0 where it holds at once. Friction that
// has not bent yet leaves the axis some energy, which the pulse and the coast make a way of: tested, not proved.
template <class Real>
double bent_beyond_m(const BrakedClass& axes, const BrakedDesign<Real>& design);

// The time that a move of the longest distance takes at least, from rest to rest within its limits, under any law.
double least_move_s(const MoveRequest& move);

// The most kicks that a design can need from the distance to within the tolerance; 0 where it promises no end.
template <class Real>
int most_kicks(const BrakedClass& axes, const BrakedDesign<Real>& design, double distance_m, double tolerance_m);

}  // namespace breakaway::design
