// AdaptiveRun is one run of Adaptive, from event to event.
#pragma once

#include <vector>

#include "adaptive_motion.hpp"

namespace breakaway::hybrid {

class AdaptiveRun {
 public:
  AdaptiveRun(AdaptiveWalk walk, const std::vector<int>& places, const AdaptiveOptions& options,
              std::vector<Event>* log)
      : walk_{std::move(walk)}, places_{places}, options_{options}, log_{log} {}

  void begin(const Adaptive::State& start);
  Adaptive::Result go_on(double end_s, const EarlyDecision<Eigen::Dynamic>& decision,
                         const Observer<Eigen::Dynamic>& observer);

 private:
  Adaptive::State state() const { return {walk_.time.sum_s, walk_.q, walk_.v}; }
  Adaptive::Result finish(Verdict verdict);
  bool stands_still() const;
  void spend_a_step(double end_s);
  Ending wait(double duration_s);
  Ending move(double duration_s);
  void handle(const Ending& ending, double end_s);
  void change_laws();
  void record(const std::vector<int>& before);

  AdaptiveWalk walk_;
  const std::vector<int>& places_;  // of the machine's directions among those that have friction, -1 for none
  const AdaptiveOptions& options_;
  std::vector<Event>* log_;
  Adaptive::Result outcome_;
};

}  // namespace breakaway::hybrid
