// KickPromise: how many kicks any axis of a class may need, and how long they take.
//
// A kick from an error y takes at least D_min of the pulse that the worst of its readings asks for. What counts is the
// worst of all errors up to y, so that the sequence y, y - D_min, ... bounds every sequence of kicks from there; and
// so does the sum of the longest times, each over all errors up to one of the sequence. The time of one kick is
//   preload + pulse + cut + the later of (the force is sure to be down, the axis has stopped) + the proof of rest,
// from the sample that says how far to go to the one that proves rest. The axis stops within
//   gain (F n T + 2 b tau) / (A' + gain b)
// after its pulse, under any friction of the class: at the stop the impulse of the force, that of a lagging current
// loop with what it owes, is spent by friction. A fine stage chooses its next kick a period later, and a sample that is
// lost adds a period.
//
// With a fine stage the least tolerance is what is promised to be reached: by kicks to the floor, all of the fine
// stage's, and from where these may have led as many of the table's as lead back to the floor.
#pragma once

#include <memory>

#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design {

namespace detail {
class WorstKicks;
}

class KickPromise {
 public:
  // Promises nothing where the design is not possible, or has no fine stage and the tolerance is below its least.
  template <class Real>
  KickPromise(const BrakedClass& axes, const BrakedDesign<Real>& design, double tolerance_m);

  // The tolerance that is promised to be reached: the one asked for, or with a fine stage the least.
  double reached_m() const { return tolerance_m_; }
  // From the distance to within the tolerance; 0 where no end is promised or nothing is to do.
  int most_kicks(double distance_m) const;
  // From the decision for the first of these kicks to the hold [s]; infinite where no end is promised.
  double most_s(double distance_m) const;

 private:
  struct Sequence {
    int kicks;
    double time_s;
  };
  // Where friction bends, beside the kicks [s].
  struct OnSpring {
    double ringing_s = 0;  // after a kick
    double leading_s = 0;  // until a force that no longer leads the axis ends in the next kick
    double holding_s = 0;  // until one does in a hold
    double reach_m = 0;
  };

  template <class Real>
  static OnSpring on_spring(const BrakedClass& axes, const law::BrakedKicks<Real>& flashed, double tolerance_m);
  Sequence from(double distance_m) const;
  Sequence kicked_from(double distance_m) const;
  Sequence by_table(double distance_m) const;

  std::shared_ptr<const detail::WorstKicks> worst_;
  double reading_error_m_, tolerance_m_;
  OnSpring spring_;
  double fine_tolerance_m_, fine_reach_m_;  // of the fine stage: aimed at, and where it may lead; 0: there is none
};

}  // namespace breakaway::design
