// CompiledSize: a machine whose number of coordinates is known only when it is read, in the hands of the integrator
// that was compiled for that number, if there is one.
#pragma once

#include <functional>
#include <optional>
#include <tuple>
#include <vector>

#include "breakaway/hybrid/budget.hpp"
#include "breakaway/hybrid/stick_set.hpp"
#include "breakaway/hybrid/types.hpp"

namespace breakaway::hybrid {

// Integrator: EventDriven<N> for some N.
template <class... Integrator>
class CompiledSize {
 public:
  using State = MachineState<Eigen::Dynamic>;

  CompiledSize(const LinearMachine<>& machine, const EarlyDecision<Eigen::Dynamic>& decision) {
    (make<Integrator>(machine, decision), ...);
  }

  // Says whether there is an integrator for the machine and this start.
  bool takes(const State& start) const { return (fits<Integrator>(start) || ...); }

  // These require takes(start); the rest is as in EventDriven.
  Outcome<Eigen::Dynamic> run(const State& start, double end_time_s, std::vector<Event>* log,
                              const Observer<Eigen::Dynamic>& observer, const Budget& budget) const {
    return call(start, [&]<class Sized>(const Sized& integrator) {
      return unsized(integrator.run(sized<Sized::coordinates>(start), end_time_s, log,
                                    with_unsized<Sized::coordinates>(observer), budget));
    });
  }
  Outcome<Eigen::Dynamic> resume(const State& start, DirectionSet& sticking, double end_time_s, std::vector<Event>* log,
                                 const Budget& budget) const {
    return call(start, [&]<class Sized>(const Sized& integrator) {
      return unsized(integrator.resume(sized<Sized::coordinates>(start), sticking, end_time_s, log, budget));
    });
  }

  // The force is finite and of the machine's size.
  void set_force(const Eigen::VectorXd& force_N) {
    const auto set = [&](auto& integrator) {
      if (integrator) integrator->set_force(force_N);
    };
    (set(std::get<std::optional<Integrator>>(integrators_)), ...);
  }

 private:
  template <class Sized>
  void make(const LinearMachine<>& machine, const EarlyDecision<Eigen::Dynamic>& decision) {
    if (machine.coordinates() != Sized::coordinates) return;
    std::get<std::optional<Sized>>(integrators_)
        .emplace(stability::sized<Sized::coordinates, Eigen::Dynamic>(machine),
                 with_unsized<Sized::coordinates>(decision));
  }

  template <class Sized>
  bool fits(const State& start) const {
    return std::get<std::optional<Sized>>(integrators_) && start.q.size() == Sized::coordinates &&
           start.v.size() == Sized::coordinates;
  }

  template <class Run>
  Outcome<Eigen::Dynamic> call(const State& start, const Run& run) const {
    Outcome<Eigen::Dynamic> outcome;
    const auto run_if_fitting = [&]<class Sized>(const std::optional<Sized>& integrator) {
      if (fits<Sized>(start)) outcome = run(*integrator);
    };
    (run_if_fitting(std::get<std::optional<Integrator>>(integrators_)), ...);
    return outcome;
  }

  template <int N>
  static MachineState<N> sized(const State& state) {
    return {state.time_s, state.q, state.v};
  }
  template <int N>
  static Outcome<Eigen::Dynamic> unsized(const Outcome<N>& outcome) {
    const MachineState<N>& end = outcome.end;
    return {outcome.verdict, {end.time_s, end.q, end.v}, outcome.settling_time_s, outcome.steps, outcome.events,
            outcome.work};
  }

  // Returns the function for states whose size is known; none stays none.
  template <int N, class Result>
  static std::function<Result(const MachineState<N>&)> with_unsized(const std::function<Result(const State&)>& any) {
    if (!any) return {};
    return [any](const MachineState<N>& state) { return any({state.time_s, state.q, state.v}); };
  }

  std::tuple<std::optional<Integrator>...> integrators_;
};

}  // namespace breakaway::hybrid
