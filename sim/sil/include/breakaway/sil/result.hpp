// What a scenario gives: figures for people and scripts, and samples for pictures if they were asked for.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/law/control_types.hpp"
#include "breakaway/sil/accuracy.hpp"
#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::sil {

// What to keep beside the figures.
struct RecordingOptions {
  bool trace = false;
  bool frames = false;
  std::function<void(double share)> progress{};  // told the share of duration_s that is behind, often
};

struct KickRecord {
  double time_s = 0;
  double position_m = 0;          // of the axis, not relative to the target
  double error_m = 0;             // position - target
  double velocity_after_m_s = 0;  // after the impulse, or at the end of the pulse
  double impulse_Ns = 0;          // ideal law: k3
  double force_N = 0;             // pulse: total commanded force of its first period
  int periods = 0;                // pulse: its length in control periods
};

struct FaultRecord {
  double time_s = 0;
  std::string name;
};

struct Sample {
  double time_s = 0;
  double position_m = 0;
  double velocity_m_s = 0;
  std::optional<double> load_position_m{};  // where there is a load apart from the motor
  double force_N = 0;                       // by the actuator, impulses excepted
  double friction_level_N = 0;              // of the moving axis; may be NaN at rest, where friction balances the force
  double target_m = 0;
  double bus_load = 0;  // share of the last period that the bus was busy
  law::Mode mode = law::Mode::approach;
};

// Figures of the ideal law only; times that never came are NaN, and so is what is not proved because the law is told
// otherwise, or because a force or a drift acts that it does not know.
struct IdealFigures {
  double t1_s = 0;           // first rest within the maximal stick set
  double t2_s = 0;           // first rest within the minimal stick set
  double y2_m = 0;           // error at t2
  double t_inf_s = 0;        // when the target is reached
  double t_inf_width_s = 0;  // proved uncertainty of t_inf_s
  double bound_s = 0;        // t2 plus (19): no later than this
  std::size_t steps = 0;     // of the integrator
};

// Figures of scenarios with a control loop on the bus.
struct LoopFigures {
  std::uint64_t ticks = 0;
  std::uint64_t missed_ticks = 0;  // periods without fresh feedback once the axis was enabled
  double bus_load = 0;             // mean share of time that the bus was busy
  double sync_off_s = 0;           // by how much any two SYNC were not whole periods apart, at most
};

struct TimedFrame {
  double time_s = 0;
  hal::CanFrame frame;
};

// From time_s on, since the last target change, the axis stayed within tolerance_m to the end; NaN if it did not.
struct Reached {
  double tolerance_m = 0;
  double time_s = 0;
};

// At the ends of the periods; all moves together.
struct Excursions {
  double overshoot_m = 0;     // the furthest past the target, seen from where the move began
  double beyond_m = 0;        // the furthest past the target that a kick led, seen from where it began
  double peak_speed_m_s = 0;  // the largest |velocity|
  double lowest_m = std::numeric_limits<double>::infinity();  // the ends of its way
  double highest_m = -std::numeric_limits<double>::infinity();
};

struct AxisResult {
  std::string name;
  bool settled = false;                   // at rest within the tolerance for the time asked for, and the law holds
  double settling_time_s = 0;             // when that rest began, since the last target change; NaN if never settled
  double final_error_m = 0;               // position - target
  std::optional<double> load_position_m;  // at the end, where there is a load apart from the motor
  std::string told;  // what the controller is told otherwise than it is; see config::told_otherwise
  std::optional<std::uint64_t> encoder_noise_seed;  // where the encoder is noisy
  std::optional<Excursions> excursions;             // scenarios on the bus
  double max_force_N = 0;  // largest |force| of the actuator; NaN for the ideal law, which has impulses
  std::vector<KickRecord> kicks;
  std::vector<FaultRecord> faults;
  std::optional<IdealFigures> ideal;
  std::vector<Reached> reached;  // scenarios on the bus: 1 mm, 0.1 mm, 10 um and the tolerance that is judged
  // Scenarios on the bus: not settled, and set in motion again and again in the last second; where the law kicks, by
  // kicks that lead the axis no nearer to its target than it has been.
  bool limit_cycle = false;
  std::vector<Sample> trace;
};

struct Result {
  double duration_s = 0;  // simulated
  double wall_s = 0;      // taken by the computation
  double work = 0;        // of the motion of all axes, and its share of what it may be: see motion::WorkBudget
  double work_share = 0;
  std::vector<AxisResult> axes;  // as the scenario has them
  std::optional<LoopFigures> loop;
  // Of the machine that all axes stand on, where there is one: at the end, and at the times of the axes' samples.
  std::optional<stability::MachineState<Eigen::Dynamic>> machine_end;
  std::vector<stability::MachineState<Eigen::Dynamic>> machine_trace;
  std::vector<TimedFrame> frames;
  std::optional<Accuracy> accuracy;  // where the scenario asks for one

  bool settled() const { return std::ranges::all_of(axes, &AxisResult::settled); }
};

}  // namespace breakaway::sil
