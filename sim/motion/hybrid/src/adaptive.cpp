#include "breakaway/hybrid/adaptive.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "adaptive_run.hpp"
#include "breakaway/hybrid/friction_groups.hpp"
#include "breakaway/hybrid/refused.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/model/shapes.hpp"

namespace breakaway::hybrid {
namespace {

using Eigen::Index;

model::FrictionLaw constant_law(double level_N) {
  return {law::FrictionBounds<double>{level_N, level_N}, model::shape::constant(1)};
}

void require(bool holds, const std::string& otherwise) {
  if (!holds) throw InputError{otherwise};
}

void require_valid(const LinearMachine<>& machine, std::size_t laws, const AdaptiveOptions& options) {
  stability::require_valid(machine);
  require(laws == static_cast<std::size_t>(machine.frictions()),
          "there are " + std::to_string(laws) + " friction laws for " + std::to_string(machine.frictions()) +
              " columns of directions: give one for each");
  if (machine.frictions() > most_directions) {
    throw Refused{
        "directions has " + std::to_string(machine.frictions()) + " columns, and the adaptive method takes at most 16",
        "leave out those without friction, and join what is parallel"};
  }
  require(options.tolerance >= 1e-14 && options.tolerance <= 1e-2,
          "tolerance is " + shown(options.tolerance) + ": give a number from 1e-14 to 1e-2");
  require(options.longest_step_s > 0, "longest_step_s must be above 0");
}

}  // namespace

Adaptive::Adaptive(const LinearMachine<>& machine, const Laws& laws, AdaptiveOptions options,
                   EarlyDecision<Eigen::Dynamic> decision)
    : options_{options}, decision_{std::move(decision)} {
  require_valid(machine, laws.size(), options);
  LinearMachine<> rubbing = machine;
  rubbing.friction_N.setOnes();
  const FrictionGroups groups = group_frictions(rubbing);
  std::vector<int> columns;
  places_.assign(laws.size(), -1);
  for (std::size_t i = 0; i < laws.size(); ++i) {
    if (groups.leader[i] < 0) continue;
    // Directions that rounding cannot tell apart become parallel, so that none slides while another of them sticks.
    rubbing.directions.col(static_cast<Index>(i)) = groups.multiple[i] * machine.directions.col(groups.leader[i]);
    places_[i] = static_cast<int>(columns.size());
    columns.push_back(static_cast<int>(i));
    laws_.push_back(laws[i]);
  }
  keep_directions(rubbing, columns);
}

Adaptive::Adaptive(const LinearMachine<>& machine, AdaptiveOptions options, EarlyDecision<Eigen::Dynamic> decision)
    : options_{options}, decision_{std::move(decision)} {
  require_valid(machine, static_cast<std::size_t>(machine.frictions()), options);
  const FrictionGroups groups = group_frictions(machine);
  std::vector<int> columns;
  places_.assign(groups.leader.size(), -1);
  for (std::size_t i = 0; i < groups.leader.size(); ++i) {
    const int leader = groups.leader[i];
    if (leader == static_cast<int>(i)) {
      places_[i] = static_cast<int>(columns.size());
      columns.push_back(leader);
      laws_.push_back(constant_law(groups.machine.friction_N[leader]));
    } else if (leader >= 0) {
      places_[i] = places_[static_cast<std::size_t>(leader)];
    }
  }
  keep_directions(groups.machine, columns);
}

// Keeps these columns of directions only, and no constant friction.
void Adaptive::keep_directions(const LinearMachine<>& machine, const std::vector<int>& columns) {
  machine_ = machine;
  machine_.directions = machine.directions(Eigen::all, columns);
  machine_.friction_N = Eigen::VectorXd::Zero(machine_.frictions());
  machine_.force_N = stability::constant_force(machine);
  choice_ = std::make_shared<const ModeChoice>(machine_);
}

Adaptive::Result Adaptive::run(const State& start, double end_time_s, std::vector<Event>* log,
                               const Observer<Eigen::Dynamic>& observer) const {
  Laws laws = laws_;
  return resume(laws, start, end_time_s, log, observer);
}

Adaptive::Result Adaptive::resume(Laws& laws, const State& start, double end_time_s, std::vector<Event>* log,
                                  const Observer<Eigen::Dynamic>& observer) const {
  const Index n = machine_.coordinates();
  require(start.q.size() == n && start.v.size() == n, "the start has " + std::to_string(start.q.size()) +
                                                          " coordinates and " + std::to_string(start.v.size()) +
                                                          " velocities: give " + std::to_string(n) + " of each");
  require(start.q.allFinite() && start.v.allFinite() && std::isfinite(start.time_s),
          "the start is not finite: correct it");
  require(std::isfinite(end_time_s) && end_time_s >= start.time_s,
          "the end time is not finite or before the start: give a later one");
  require(laws.size() == laws_.size(), "the laws are not those of laws()");
  const auto held_set = [this](DirectionSet sticking) -> const HeldSet& {
    auto& found = held_[sticking];
    if (!found) found = std::make_shared<const HeldSet>(make_held_set(machine_, sticking));
    return *found;
  };
  AdaptiveRun run{{machine_, *choice_, laws, held_set, {}, {}, {}, {}, {}, nullptr, 0}, places_, options_, log};
  run.begin(start);
  return run.go_on(end_time_s, decision_, observer);
}

}  // namespace breakaway::hybrid
