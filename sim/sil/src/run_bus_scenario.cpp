#include "breakaway/sil/run_bus_scenario.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <string_view>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/cia402/drive.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/law/pid_controller.hpp"
#include "breakaway/scenario/axis_config.hpp"
#include "breakaway/scenario/axis_design.hpp"
#include "breakaway/sil/braked_slide.hpp"
#include "breakaway/sil/simulated_network.hpp"

namespace breakaway::sil {
namespace {

template <class Real>
law::K3Table<Real> k3_table(const law::AxisParameters<Real>& p, const std::string& file) try {
  return design::build_k3_table<Real>({p.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N},
                                      p.stick_radius_upper_m())
      .table;
} catch (const InputError& error) {
  throw error.in_file(file);
}

template <class Real>
law::PidController<Real> pid_controller(const scenario::Scenario& s) {
  law::PidParameters<Real> p;
  p.proportional_N_per_m = static_cast<Real>(s.controller.pid->proportional_N_per_m);
  p.integral_N_per_ms = static_cast<Real>(s.controller.pid->integral_N_per_ms);
  p.derivative_Ns_per_m = static_cast<Real>(s.controller.pid->derivative_Ns_per_m);
  p.max_force_N = static_cast<Real>(s.controller.max_force_N);
  p.max_approach_speed_m_s = static_cast<Real>(s.controller.max_approach_speed_m_s);
  p.encoder_resolution_m = static_cast<Real>(s.drive->encoder_resolution_m);
  p.friction_lower_N = static_cast<Real>(s.friction.lower_N);
  p.period_s = static_cast<Real>(s.loop->period_s);
  return law::PidController<Real>{p};
}

// Watches the true plant, not what the drive says of it.
class Judge {
 public:
  Judge(const scenario::Run& run, const motion::Slide& slide)
      : run_{run}, slide_{slide}, reached_{{1e-3, 0}, {1e-4, 0}, {1e-5, 0}, {run.settle_tolerance_m, 0}} {}

  void look(double time_s, double target_m) {
    error_m_ = slide_.state().position_m - target_m;
    for (Reached& level : reached_) {
      if (!within(level.tolerance_m)) level.time_s = nan;
      if (within(level.tolerance_m) && std::isnan(level.time_s)) level.time_s = time_s;
    }
    const bool there = within(run_.settle_tolerance_m) && slide_.sticking();
    if (!there) since_s_ = nan;
    if (there && std::isnan(since_s_)) since_s_ = time_s;
    settled_ = there && time_s - since_s_ >= run_.settle_time_s;
    if (time_s < run_.duration_s - 1) slips_before_last_second_ = slide_.counters().slips;
  }
  // The target moved: times are counted from here.
  void start_again(double time_s) {
    since_s_ = nan;
    target_since_s_ = time_s;
  }

  bool settled() const { return settled_; }
  double settling_time_s() const { return settled_ ? since_s_ - target_since_s_ : nan; }
  double error_m() const { return error_m_; }
  bool limit_cycle() const { return !settled_ && slide_.counters().slips - slips_before_last_second_ >= 2; }
  const std::vector<Reached>& reached() const { return reached_; }

 private:
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  bool within(double tolerance_m) const { return std::abs(error_m_) <= tolerance_m; }

  const scenario::Run& run_;
  const motion::Slide& slide_;
  std::vector<Reached> reached_;
  double since_s_ = nan;
  double target_since_s_ = 0;
  double error_m_ = nan;
  std::uint64_t slips_before_last_second_ = 0;
  bool settled_ = false;
};

template <class Real, class Controller>
class BusScene {
 public:
  BusScene(const scenario::Scenario& s, const RecordingOptions& recording, const Controller& controller)
      : s_{s},
        recording_{recording},
        period_{scenario::nanoseconds(s.loop->period_s)},
        mechanism_{{s.plant.mass_kg, s.friction.law, {0.0, s.plant.position_m, s.plant.velocity_m_s}}},
        network_{*s.bus},
        drive_{network_.add_drive(*s.drive, mechanism_)},
        loop_{network_.controller_port(), scenario::network_config(s)},
        judge_{*s.run, mechanism_.slide()} {
    if (recording.frames) network_.log_to(result_.frames);
    const hal::AxisScale<Real> scale = scenario::axis_scale<Real>(s);
    const cia402::Drive<Real> drive{scenario::drive_config<Real>(s), scenario::network_config(s), scale};
    const auto added = loop_.add_axis(drive, controller, scenario::axis_limits<Real>(s), scale.encoder_resolution_m);
    if (added != firmware::AddAxis::added) throw InputError(std::string{to_string(added)});
    move_target(s.controller.target_m);
    loop_.request_enable(0);
  }

  Result run() {
    if (commission()) move();
    finish();
    return std::move(result_);
  }

 private:
  using Loop = firmware::ControlLoop<SimulatedNetwork::Port, cia402::Drive<Real>, Controller, Real, 1>;

  void step() {
    network_.advance_to(now_);
    loop_.step(now_);
    now_ += period_;
  }

  // Sets the drive up over the bus until the axis runs; the brake is released with the first command.
  bool commission() {
    constexpr hal::Time give_up{std::chrono::seconds{10}};
    while (!loop_.status(0).running && now_ < give_up) {
      step();
      if (loop_.status(0).fault != firmware::AxisFault::none) break;
    }
    release_ = now_ - period_;
    mechanism_.release(hal::seconds(network_.bus().now()));
    busy_before_ = busy_at_release_ = network_.bus().counters().busy_time;
    if (!loop_.status(0).running) note_fault(0);
    if (!loop_.status(0).running && result_.faults.empty())
      result_.faults.push_back({0, "drive was not enabled within 10 s"});
    return loop_.status(0).running;
  }

  void move() {
    const double duration_s = s_.run->duration_s;
    note(0);
    for (double time_s = 0; time_s < duration_s;) {
      time_s = hal::seconds(now_ - release_);
      change_target(time_s);
      step();
      note(time_s);
      judge_.look(time_s, target_m_);
      const bool more_to_come = next_target_ < s_.controller.targets.size();
      if (judge_.settled() && s_.run->stop_when_settled && !more_to_come) break;
      if (faulted_ && mechanism_.slide().sticking()) break;
    }
  }

  void change_target(double time_s) {
    const auto& targets = s_.controller.targets;
    for (; next_target_ < targets.size() && targets[next_target_].time_s <= time_s; ++next_target_) {
      move_target(targets[next_target_].position_m);
      judge_.start_again(targets[next_target_].time_s);
    }
  }

  void move_target(double target_m) {
    target_m_ = target_m;
    loop_.set_target_counts(0, static_cast<std::int32_t>(std::llround(target_m / s_.drive->encoder_resolution_m)));
  }

  void note(double time_s) {
    const auto& status = loop_.status(0);
    if (status.running && !status.feedback.fresh) ++periods_without_feedback_;
    note_kick(time_s, status.output);
    note_fault(time_s);
    if (recording_.trace) note_sample(time_s, status.output.mode);
  }

  void note_kick(double time_s, const law::ControlOutput<Real>& output) {
    if (velocity_pending_ && --velocity_pending_ == 0) {
      result_.kicks.back().velocity_after_m_s = mechanism_.velocity_at_segment_start_m_s();
    }
    if (output.kicked) {
      const double position_m = mechanism_.position_m();
      result_.kicks.push_back({time_s, position_m, position_m - target_m_, 0, 0, output.force_N, 0});
    }
    if (output.mode != law::Mode::kick) return;
    ++result_.kicks.back().periods;
    velocity_pending_ = 2;  // the pulse ends with the SYNC of the next step, which has passed one step later
  }

  void note_fault(double time_s) {
    const firmware::AxisFault fault = loop_.status(0).fault;
    if (fault == firmware::AxisFault::none || faulted_) return;
    faulted_ = true;
    std::string name{to_string(fault)};
    if (const auto code = loop_.supervisor(0).fault_code(); code != 0)
      name += fmt::format(" (error code {:04X}h)", code);
    if (fault == firmware::AxisFault::drive_unusable) name += fmt::format(": {}", why_unusable());
    result_.faults.push_back({time_s, name});
  }

  std::string_view why_unusable() const {
    const cia402::Drive<Real>& drive = loop_.drive(0);
    const bool invalid = drive.setup_status() == cia402::SetupStatus::config_invalid;
    return invalid ? to_string(drive.config_error()) : to_string(drive.setup_status());
  }

  void note_sample(double time_s, law::Mode mode) {
    const motion::Slide& slide = mechanism_.slide();
    const hal::Duration busy = network_.bus().counters().busy_time;
    Sample sample;
    sample.time_s = time_s;
    sample.position_m = slide.state().position_m;
    sample.velocity_m_s = slide.state().velocity_m_s;
    sample.force_N = drive_.force().at_N(hal::seconds(now_ - period_), 0, 0);
    sample.friction_level_N = slide.sticking() ? std::nan("") : std::fabs(slide.friction_force_N());
    sample.target_m = target_m_;
    sample.bus_load = hal::seconds(busy - busy_before_) / hal::seconds(period_);
    sample.mode = mode;
    busy_before_ = busy;
    result_.trace.push_back(sample);
  }

  void finish() {
    const double simulated_s = hal::seconds(now_ - period_ - release_);
    result_.duration_s = simulated_s;
    result_.settled = judge_.settled() && !faulted_;
    result_.settling_time_s = judge_.settling_time_s();
    result_.final_error_m = mechanism_.position_m() - target_m_;
    result_.reached = judge_.reached();
    result_.limit_cycle = judge_.limit_cycle();
    result_.max_force_N = drive_.largest_force_N(now_ - period_);
    LoopFigures figures;
    figures.ticks = loop_.statistics().ticks();
    figures.missed_ticks = loop_.statistics().missed_ticks() + periods_without_feedback_;
    figures.bus_load =
        simulated_s > 0 ? hal::seconds(network_.bus().counters().busy_time - busy_at_release_) / simulated_s : 0;
    result_.loop = figures;
  }

  const scenario::Scenario& s_;
  RecordingOptions recording_;
  hal::Duration period_;
  Result result_;
  BrakedSlide mechanism_;
  SimulatedNetwork network_;
  drive_emulator::DriveEmulator& drive_;
  Loop loop_;
  Judge judge_;
  hal::Time now_{};
  hal::Time release_{};
  hal::Duration busy_before_{0};
  hal::Duration busy_at_release_{0};
  double target_m_ = 0;
  std::size_t next_target_ = 0;
  std::uint64_t periods_without_feedback_ = 0;
  int velocity_pending_ = 0;
  bool faulted_ = false;
};

template <class Real>
Result run_with(const scenario::Scenario& s, const RecordingOptions& recording) {
  if (s.controller.pid) return BusScene<Real, law::PidController<Real>>{s, recording, pid_controller<Real>(s)}.run();
  const auto parameters = scenario::axis_parameters<Real>(s);
  if (const auto error = validate(parameters); error != law::ParameterError::none)
    throw InputError(
        fmt::format("{}: in {}: {}", s.file, std::is_same_v<Real, float> ? "float" : "double", to_string(error)));
  const auto table = k3_table(parameters, s.file);
  return BusScene<Real, law::AxisController<Real>>{s, recording, {parameters, table}}.run();
}

}  // namespace

Result run_bus_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording) {
  scenario::require_fitting_bus(scenario);
  const auto start = std::chrono::steady_clock::now();
  Result result = scenario.controller.scalar == scenario::ScalarType::float64 ? run_with<double>(scenario, recording)
                                                                              : run_with<float>(scenario, recording);
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace breakaway::sil
