#include "node_run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::linux_node {

template <class Flashed, class Side>
NodeRun<Flashed, Side>::NodeRun(const Flashed& flashed, const Configuration& configuration, const Options& options,
                                socketcan::KernelSocket& socket, Telemetry& telemetry)
    : Base{flashed, configuration, options, socket, telemetry}, trips_(flashed.count) {
  for (std::size_t place = 0; place < axes_.size(); ++place) visit(place, 0);
}

template <class Flashed, class Side>
ExitCode NodeRun<Flashed, Side>::run() {
  get_ready();
  refuse_far_targets();
  enable();
  telemetry_.ready = !telemetry_.stop;
  move();
  for (std::size_t i = 0; i < axes_.size(); ++i) trips_[i].reached = rests_on_target(i);
  stop();
  bool good = true;
  for (std::size_t i = 0; i < axes_.size(); ++i) good = good && ended_well(i) && (trips_[i].reached || telemetry_.stop);
  return good ? done : failed;
}

// Where an axis stands is known by now, and nothing has moved yet. The drives are released, because they are set up to
// miss this node.
template <class Flashed, class Side>
void NodeRun<Flashed, Side>::refuse_far_targets() {
  if (telemetry_.stop) return;
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    const double from_m = static_cast<double>(status(place).feedback.position_m);
    const double to_m = plan(place).visits.front().counts * plan(place).resolution_m;
    const std::string far = config::way_problem(c_.file, c_.file.axes[place], from_m, to_m);
    if (far.empty()) continue;
    stop();
    throw InputError{fmt::format("axis {} would go to its first target {}", plan(place).name, far)};
  }
}

template <class Flashed, class Side>
void NodeRun<Flashed, Side>::move() {
  const hal::Time begin = now_;
  const hal::Duration duration = duration_of(options_.duration_s);
  while (!telemetry_.stop && (duration == hal::Duration::zero() || now_ - begin < duration)) {
    step();
    for (std::size_t place = 0; place < axes_.size(); ++place) {
      const auto& s = status(place);
      if (s.feedback.state == hal::DriveState::unusable) return;  // it came back as another drive
      if (s.running && !trips_[place].enabled_since) trips_[place].enabled_since = now_;
    }
    c_.timed ? follow_times() : follow_tour();
  }
}

template <class Flashed, class Side>
void NodeRun<Flashed, Side>::visit(std::size_t place, std::size_t visit) {
  trips_[place].visit = visit;
  loop_.set_target_counts(axes_[place].id, plan(place).visits[visit].counts);
}

// Axes that push each other are certified for targets that are given where all of them rest, and near to that: what is
// due before waits.
template <class Flashed, class Side>
void NodeRun<Flashed, Side>::follow_times() {
  if (c_.file.coupling && !all_hold()) return;
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    const Trip& trip = trips_[place];
    const auto& visits = plan(place).visits;
    if (!status(place).running || trip.visit + 1 == visits.size()) continue;
    if (hal::seconds(now_ - *trip.enabled_since) >= visits[trip.visit + 1].after_s) visit(place, trip.visit + 1);
  }
}

// All axes go on together, once all have rested for a while.
template <class Flashed, class Side>
void NodeRun<Flashed, Side>::follow_tour() {
  bool resting = true;
  for (std::size_t place = 0; place < axes_.size(); ++place) resting = resting && rests_on_target(place);
  if (!resting) {
    resting_since_.reset();
    return;
  }
  if (!resting_since_) resting_since_ = now_;
  const std::size_t next = trips_.front().visit + 1;
  if (next == plan(0).visits.size() || hal::seconds(now_ - *resting_since_) < options_.dwell_s) return;
  for (std::size_t place = 0; place < axes_.size(); ++place) visit(place, next);
  resting_since_.reset();
}

template <class Flashed, class Side>
bool NodeRun<Flashed, Side>::holds(std::size_t place) const {
  return status(place).running && status(place).output.mode == law::Mode::hold;
}

template <class Flashed, class Side>
bool NodeRun<Flashed, Side>::all_hold() const {
  for (std::size_t place = 0; place < axes_.size(); ++place)
    if (!holds(place)) return false;
  return true;
}

template <class Flashed, class Side>
bool NodeRun<Flashed, Side>::rests_on_target(std::size_t place) const {
  const double error_m = static_cast<double>(status(place).feedback.position_offset_m);
  return holds(place) && std::abs(error_m) <= plan(place).reached_m;
}

template <class Flashed, class Side>
std::string NodeRun<Flashed, Side>::report() const {
  std::string text;
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    text += fmt::format("{:<11} {}, {:+.3g} m from its target\n", plan(place).name, stop_text(place),
                        static_cast<double>(status(place).feedback.position_offset_m));
    text += last_words(place);
  }
  return text + figures();
}

template class NodeRun<config::AnyNode<float>, CanopenSide>;
template class NodeRun<config::WorkNode<float>, CanopenSide>;
template class NodeRun<config::MachineNode<float>, CanopenSide>;
template class NodeRun<config::AnyNode<float>, OdriveSide>;

}  // namespace breakaway::linux_node
