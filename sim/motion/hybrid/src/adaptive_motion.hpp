// AdaptiveStep takes one step of an AdaptiveWalk, during which the same directions slide.
#pragma once

#include <limits>
#include <vector>

#include "adaptive_walk.hpp"

namespace breakaway::hybrid {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

// Says why a step ended where it did.
struct Ending {
  enum class Kind { none, time, stop, limit, edge };
  Kind kind = Kind::none;
  DirectionSet stopped = 0;    // stop
  Limit limit{};               // limit
  Eigen::Index direction = 0;  // edge
  double edge_m = 0;
};

// Paths, speeds and times count from where the step starts. Trials move the walk about; the one that is taken last.
class AdaptiveStep {
 public:
  AdaptiveStep(AdaptiveWalk& walk, double tolerance);

  // Moves the walk on by at most duration_s and longest_s, or to the first event if that is earlier.
  Ending take(double duration_s, double longest_s);

 private:
  using Vector = Eigen::VectorXd;
  using Index = Eigen::Index;

  struct Range {
    double least, greatest;
    void include(double value);
  };
  struct Trial {
    bool converged;
    double duration_s;
    Vector path, speeds;  // integral of u, u
    double suggested_s;
  };
  // A guard must not become negative: it is the way to the edge of a law while `direction` slides, or what is left to a
  // static limit.
  struct Guard {
    bool is_edge;
    Index direction;
    double edge_m;
    Limit limit;
    Range range;  // over the stages of a trial
    Range slope;  // of a limit, over the same, as far as springs and dampers make it
  };

  template <class Path, class Speeds>
  Vector acceleration(double tau_s, const Path& path, const Speeds& speeds, Index exchanged, double speed_m_s);
  template <class Path, class Speeds>
  void move_to(const Path& path, const Speeds& speeds);
  void forget_ranges();
  double value(const Guard& guard, double tau_s, const Vector& force);
  double slope(const Guard& guard, const Vector& acceleration) const;
  bool surely_kept(const Guard& guard, double duration_s) const;
  double speed(Index i, const Vector& u) const;
  int sign(Index i) const { return walk_.signs[static_cast<std::size_t>(i)]; }

  DirectionSet stopped_at_start() const;
  Index next_to_stop() const;
  Trial step_in_time(double step_s);
  Trial step_to_stop(Index direction);
  bool keeps_signs(const Trial& trial, Index stopping);
  bool looks_again(const Trial& trial);
  bool passes(const Trial& trial);
  Trial locate(const Trial& beyond);
  Ending cause(const Trial& trial);
  bool stops_in_rounding(Index direction) const;
  DirectionSet stops_with(const Trial& trial, Index direction) const;

  AdaptiveWalk& walk_;
  const HeldSet& held_;
  double tolerance_;
  std::vector<Guard> guards_;
  std::vector<Range> rates_;  // of the sliding speeds, over the stages of a trial
  Vector q0_, u0_, a0_;       // at the start
  Vector speed_m_s_, rate_m_s2_, rounding_m_s2_;
  double rounding_u_ = 0;  // of a0_
  int refusals_ = 0;
  bool constant_levels_ = true;  // of all laws, between events
};

}  // namespace breakaway::hybrid
