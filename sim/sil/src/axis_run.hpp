// AxisRun: one axis of a scenario on the bus: its mechanism and drive, its targets, and what is noted of it.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/result.hpp"
#include "breakaway/sil/simulated_network.hpp"
#include "excursion_watch.hpp"
#include "judge.hpp"

namespace breakaway::sil {

// What the controller is told that differs from the truth; on a machine, all that it is told of mass and friction.
inline std::string told_of(const config::Axis& axis, const scenario::AxisWorld& world) {
  std::string otherwise = config::told_otherwise(axis);
  if (!world.place) return otherwise;
  return fmt::format("mass_kg {:g}, friction_lower_N {:g}, friction_upper_N {:g} (truly the [machine]){}{}",
                     axis.mass_kg, axis.friction.bounds.lower_N, axis.friction.bounds.upper_N,
                     otherwise.empty() ? "" : ", ", otherwise);
}

template <class Loop>
class AxisRun {
 public:
  using AxisId = typename Loop::AxisId;

  // Everything must outlive it. The axis is the loop's of the same place.
  AxisRun(const scenario::Scenario& s, std::size_t place, AxisMechanism mechanism, SimulatedNetwork& network,
          Loop& loop)
      : axis_{s.node.axes[place]},
        world_{s.worlds[place]},
        mechanism_{std::move(mechanism)},
        drive_{add_drive(network)},
        loop_{loop},
        id_{*loop.axis(place)},
        judge_{*s.run, judged_tolerance_m(s.node, axis_), *mechanism_.axis} {
    result_.name = axis_.name;
    result_.told = told_of(axis_, world_);
    if (world_.encoder_error && world_.encoder_error->noise_m > 0)
      result_.encoder_noise_seed = world_.encoder_error->seed;
    move_target(axis_.controller.target_m);
  }
  AxisRun(const AxisRun&) = delete;
  AxisRun& operator=(const AxisRun&) = delete;

  // The drive is set up, or cannot be.
  bool configured() const { return loop_.status(id_).feedback.state != hal::DriveState::configuring; }
  void enable() { loop_.request_enable(id_); }
  // Its drive moves it when it is enabled first, until it has found its home.
  bool seeks_home() const {
    const config::Homing& homing = axis_.drive->homing;
    return homing.home == cia402::Home::by_drive && !config::begins_at_home(homing);
  }
  hal::Duration patience() const { return loop_.time_to_set_up(id_) + axis_.drive->homing.timeout; }
  bool running() const { return loop_.status(id_).running; }
  bool faulted() const { return loop_.status(id_).fault != firmware::AxisFault::none; }

  // The brake opens for a drive that seeks its home.
  void release_to_seek_home(double time_s) {
    const bool seeking = loop_.status(id_).feedback.state == hal::DriveState::homing;
    if (seeking && seeks_home() && !mechanism_.axis->released()) mechanism_.axis->release(time_s);
  }
  // The brake opens, if it is still closed.
  void release(double time_s) {
    if (!mechanism_.axis->released()) mechanism_.axis->release(time_s);
    watch_.start_move(position_m() - target_m_);
    look();
    note_fault(0);
    if (!running() && result_.faults.empty()) result_.faults.push_back({0, why_not_enabled()});
  }

  void change_target(double time_s) {
    const auto& targets = axis_.controller.targets;
    for (; next_target_ < targets.size() && targets[next_target_].time_s <= time_s; ++next_target_) {
      move_target(targets[next_target_].position_m);
      judge_.start_again(targets[next_target_].time_s);
      watch_.start_move(position_m() - target_m_);
    }
  }

  // After each step; now: of the bus.
  void note(double time_s, hal::Time now, double bus_load, bool trace) {
    const auto& status = loop_.status(id_);
    if (status.running && !status.feedback.fresh) ++periods_without_feedback_;
    note_kick(time_s, status.output.kicked, status.output.mode, static_cast<double>(status.output.force_N));
    note_fault(time_s);
    look();
    if (trace) note_sample(time_s, now, bus_load, status.output.mode);
  }
  void judge(double time_s) { judge_.look(time_s, target_m_, law_is_done()); }

  // Nothing more is to come: it rests on its last target, or it has a fault and stands.
  bool over() const {
    const bool last = next_target_ == axis_.controller.targets.size();
    return (judge_.settled() && last) || (!result_.faults.empty() && mechanism_.axis->state().sticking);
  }
  std::uint64_t periods_without_feedback() const { return periods_without_feedback_; }

  AxisResult finish(hal::Time now) {
    result_.settled = judge_.settled() && result_.faults.empty();
    result_.settling_time_s = judge_.settling_time_s();
    result_.final_error_m = position_m() - target_m_;
    result_.excursions = watch_.figures();
    result_.load_position_m = mechanism_.axis->load_position_m();
    result_.reached = judge_.reached();
    result_.limit_cycle = judge_.limit_cycle(knows_friction);
    result_.max_force_N = drive_.largest_force_N(now);
    return std::move(result_);
  }

 private:
  static constexpr bool knows_friction =
      firmware::KnowsFriction<std::remove_cvref_t<decltype(std::declval<Loop&>().controller(std::declval<AxisId>()))>>;

  drive_emulator::EmulatedDrive& add_drive(SimulatedNetwork& network) {
    if (world_.odrive) return network.add_drive(*world_.odrive, mechanism_.seen_by_drive());
    return network.add_drive(*world_.drive, mechanism_.seen_by_drive());
  }

  // A law that does not know its friction cannot tell, and the time that it rests has to do.
  bool law_is_done() const {
    if constexpr (knows_friction) return loop_.status(id_).output.mode == law::Mode::hold;
    return true;
  }

  double position_m() const { return mechanism_.axis->state().position_m; }

  void look() {
    const AxisState axis = mechanism_.axis->state();
    watch_.look(axis.position_m, axis.position_m - target_m_, axis.velocity_m_s);
  }

  void move_target(double target_m) {
    target_m_ = target_m;
    loop_.set_target_counts(id_, static_cast<std::int32_t>(std::llround(target_m / axis_.drive->encoder_resolution_m)));
  }

  void note_kick(double time_s, bool kicked, law::Mode mode, double force_N) {
    if (velocity_pending_ && --velocity_pending_ == 0) {
      result_.kicks.back().velocity_after_m_s = mechanism_.axis->velocity_at_segment_start_m_s();
    }
    if (kicked) {
      result_.kicks.push_back({time_s, position_m(), position_m() - target_m_, 0, 0, force_N, 0});
      watch_.start_kick(position_m() - target_m_);
    }
    if (mode != law::Mode::kick) return;
    ++result_.kicks.back().periods;
    velocity_pending_ = 2;  // the pulse ends with the SYNC of the next step, which has passed one step later
  }

  void note_fault(double time_s) {
    const firmware::AxisFault fault = loop_.status(id_).fault;
    if (fault == firmware::AxisFault::none) return;
    const std::uint16_t code = loop_.supervisor(id_).fault_code();
    if (result_.faults.empty())
      result_.faults.push_back({time_s, fault_text(fault, code)});
    else if (noted_code_ == 0 && code != 0)  // it is read after its fault was seen
      result_.faults.front().name = fault_text(fault, code);
    noted_code_ = code;
  }

  // Nothing is enabled before the drives of all axes are set up.
  std::string why_not_enabled() const {
    if (configured()) return "not enabled: the drive of another axis was not set up in time";
    const auto& drive = loop_.drive(id_);
    const auto status = drive.setup_status();
    using Status = std::remove_cv_t<decltype(status)>;
    std::string text = "drive was not set up in time";
    bool says_more = true;
    if constexpr (requires { Status::in_progress; }) says_more = status != Status::in_progress;
    if (says_more) text += fmt::format(": {}", to_string(status));
    if constexpr (requires { drive.setup_object(); }) {
      const auto object = drive.setup_object();
      if (object.index != 0) text += fmt::format(" (at object {:04X}h:{:02X})", object.index, object.subindex);
    }
    return text + code_text(drive.last_error_code());
  }

  std::string code_text(std::uint16_t code) const {
    if (code == 0) return {};
    if constexpr (requires { loop_.drive(id_).fault_text(code); })
      return fmt::format(" (error code {:04X}h: {})", code, loop_.drive(id_).fault_text(code));
    else
      return fmt::format(" (error code {:04X}h)", code);
  }

  std::string fault_text(firmware::AxisFault fault, std::uint16_t code) const {
    std::string name = std::string{to_string(fault)} + code_text(code);
    if (fault == firmware::AxisFault::drive_unusable)
      name += fmt::format(": {}", to_string(loop_.drive(id_).setup_status()));
    if constexpr (requires { loop_.controller(id_).seen_friction_N(); }) {
      if (fault == firmware::AxisFault::axis_not_as_told)
        name += fmt::format(": a kick showed friction of about {:.3g} N, told are {:g} to {:g} N",
                            static_cast<double>(loop_.controller(id_).seen_friction_N()), axis_.friction.bounds.lower_N,
                            axis_.friction.bounds.upper_N);
    }
    return name;
  }

  void note_sample(double time_s, hal::Time now, double bus_load, law::Mode mode) {
    const BrakedMechanism& axis = *mechanism_.axis;
    const AxisState state = axis.state();
    Sample sample;
    sample.time_s = time_s;
    sample.position_m = state.position_m;
    sample.velocity_m_s = state.velocity_m_s;
    sample.load_position_m = axis.load_position_m();
    sample.force_N = axis.on_axis_N(drive_.force().at_N(hal::seconds(now), 0, 0));
    sample.friction_level_N = axis.friction_level_N();
    sample.target_m = target_m_;
    sample.bus_load = bus_load;
    sample.mode = mode;
    result_.trace.push_back(sample);
  }

  const config::Axis& axis_;
  const scenario::AxisWorld& world_;
  AxisMechanism mechanism_;
  drive_emulator::EmulatedDrive& drive_;
  Loop& loop_;
  AxisId id_;
  Judge judge_;
  ExcursionWatch watch_;
  AxisResult result_;
  double target_m_ = 0;
  std::size_t next_target_ = 0;
  std::uint64_t periods_without_feedback_ = 0;
  int velocity_pending_ = 0;
  std::uint16_t noted_code_ = 0;  // with the fault in result_
};

}  // namespace breakaway::sil
