#include "breakaway/sil/run_experiment.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/identify/experiment_law.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/simulated_network.hpp"

namespace breakaway::sil {
namespace {

using identify::ExperimentLaw;

// The guards of the file stay; only a target, and so an error that might grow, there is none.
firmware::AxisLimits<double> limits_of(const config::Axis& axis) {
  firmware::AxisLimits<double> limits = config::axis_limits<double>(axis);
  limits.following_error_m = firmware::AxisLimits<double>::unlimited;
  return limits;
}

scenario::AxisWorld at_rest(scenario::AxisWorld world) {
  world.velocity_m_s = 0;
  return world;
}

class ExperimentOnBus {
 public:
  ExperimentOnBus(const scenario::Scenario& s, const identify::ExperimentParameters<double>& parameters)
      : axis_{s.node.axes.front()},
        period_{s.node.loop->period},
        network_{*s.bus},
        loop_{network_.controller_port(), config::loop_config(s.node)},
        mechanism_{axis_mechanism(axis_, at_rest(s.worlds.front()))},
        experiment_{parameters},
        duration_s_{parameters.duration_s} {
    network_.add_drive(*s.worlds.front().drive, mechanism_.seen_by_drive());
    id_ = loop_.add_axis(config::drive_config<double>(axis_), ExperimentLaw<double>{experiment_}, limits_of(axis_)).id;
    run_.record = {parameters.period_s, parameters.encoder_resolution_m, parameters.force_step_N, {}};
    run_.lowest_m = run_.highest_m = mechanism_.axis->state().position_m;
  }

  ExperimentRun run(const ExperimentProgress& progress) {
    if (commission()) move(progress);
    note_fault();
    run_.ending = experiment_.ending();
    return std::move(run_);
  }

 private:
  using Loop = firmware::ControlLoop<SimulatedNetwork::Port, cia402::Drive<double>, ExperimentLaw<double>, double, 1>;

  void step() {
    network_.begin_period(loop_, now_);
    now_ += period_;
  }
  bool commission() {
    const config::Homing& homing = axis_.drive->homing;
    const hal::Time give_up = hal::Time{} + 2 * loop_.time_to_set_up(*id_) + homing.timeout;
    loop_.request_enable(*id_);
    while (!status().running && status().fault == firmware::AxisFault::none && now_ < give_up) {
      step();
      if (status().feedback.state == hal::DriveState::homing && !config::begins_at_home(homing)) release();
    }
    release();
    return status().running;
  }
  // The brake opens, for a drive that seeks its home earlier.
  void release() {
    if (!mechanism_.axis->released()) mechanism_.axis->release(hal::seconds(network_.bus().now()));
  }
  void move(const ExperimentProgress& progress) {
    note();
    while (status().running && !experiment_.finished()) {
      const double passed_s = static_cast<double>(run_.record.readings.size()) * run_.record.period_s;
      if (progress && !progress(passed_s / duration_s_)) experiment_.request_end();
      step();
      note();
    }
  }
  void note() {
    const auto& feedback = status().feedback;
    run_.record.readings.push_back({feedback.position_m, status().output.force_N, feedback.fresh});
    const AxisState truth = mechanism_.axis->state();
    run_.lowest_m = std::min(run_.lowest_m, truth.position_m);
    run_.highest_m = std::max(run_.highest_m, truth.position_m);
    run_.fastest_m_s = std::max(run_.fastest_m_s, std::abs(truth.velocity_m_s));
  }
  void note_fault() {
    if (status().fault != firmware::AxisFault::none)
      run_.fault = to_string(status().fault);
    else if (!status().running && run_.record.readings.empty())
      run_.fault = "the drive was not enabled in time";
  }
  const firmware::AxisStatus<double>& status() const { return loop_.status(*id_); }

  const config::Axis& axis_;
  hal::Duration period_;
  SimulatedNetwork network_;
  Loop loop_;
  AxisMechanism mechanism_;
  identify::Experiment<double> experiment_;
  double duration_s_;
  std::optional<Loop::AxisId> id_;
  hal::Time now_{};
  ExperimentRun run_;
};

}  // namespace

ExperimentRun run_experiment(const scenario::Scenario& scenario,
                             const identify::ExperimentParameters<double>& parameters,
                             const ExperimentProgress& progress) {
  if (!scenario.worlds.front().drive)
    throw InputError{"[drive] protocol must be \"canopen\" to identify an axis: the experiment speaks no other so far"}
        .in_file(scenario.node.file);
  config::require_fitting_bus(scenario.node);
  return ExperimentOnBus{scenario, parameters}.run(progress);
}

}  // namespace breakaway::sil
