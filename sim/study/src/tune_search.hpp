// The search of tune(): gains that may be certified, judged by certificate and study.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/study/tune.hpp"
#include "tuned_axis.hpp"

namespace breakaway::study {

// What every set of gains that is tried has to keep, and the coasts that can be certified to.
struct Tolerance {
  double position_m = 0;
  double settle_m = 0;  // 0: the file states none
  double least_m = 0;   // that can be certified
  std::vector<law::Coast> coasts;
};

// How finely the gains are varied: the second is for a look at what can be certified.
enum class GainGrid : std::uint8_t { fine, coarse };

class Search {
 public:
  Search(const TunedAxis& axis, const TuneOptions& options, std::function<void(double share)> progress);

  // Throws InputError with the reason where no tolerance can be certified.
  Tolerance tolerance() const;

  // The fastest gains of this tolerance. Throws InputError where none are certified, or none settle.
  TunedPoint fastest(const Tolerance& tolerance);

  // These gains with the least force whose worst settling time is at most this.
  TunedPoint gentlest(const TunedPoint& fastest, double longest_s);

  // All gains that were tried so far.
  const std::vector<TunedPoint>& tried() const { return tried_; }

 private:
  TunedPoint judged(const Gains& gains, int random_laws, double longest_s, unsigned threads,
                    const std::function<void(int, int)>& progress = {}) const;
  // By all threads. On the way the share that is behind is told again, so that whoever is told can end it.
  TunedPoint judged_alone(const Gains& gains, int random_laws, double longest_s) const;
  void tell(double share) { progress_(share_ = share); }
  // The fastest of them: all under a few laws, those that may be it under all.
  TunedPoint best_of(const std::vector<Gains>& gains, double longest_s);
  // These, or others that take a little longer and overshoot by no more than the tolerance.
  TunedPoint without_overshoot(const TunedPoint& fastest);
  double settle_time_s() const;
  double first_duration_s() const;

  const TunedAxis& axis_;
  const TuneOptions& options_;
  std::function<void(double share)> progress_;
  double share_ = 0;  // that was told last
  std::vector<TunedPoint> tried_;
};

}  // namespace breakaway::study
