// A closed-loop run of the flashed loop against the drive emulator and the plant, recorded so that every part of it can
// be run again alone on the very input that it had.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "axis_under_test.hpp"
#include "breakaway/cia402/drive.hpp"
#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/motion/slide.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "tape_port.hpp"
#include "tour.hpp"

namespace breakaway::bench {

template <class Real, class Controller>
using Loop = firmware::ControlLoop<TapePort, cia402::Drive<Real>, Controller, Real, 8>;

// A loop of all axes of the scenario, each under a copy of the controller.
template <class Real, class Controller>
Loop<Real, Controller> make_loop(TapePort& port, const scenario::Scenario& s, const Controller& controller) {
  Loop<Real, Controller> loop{port, config::loop_config(s.node)};
  for (const config::Axis& axis : s.node.axes) {
    const auto added = loop.add_axis(config::drive_config<Real>(axis), controller, config::axis_limits<Real>(axis));
    if (!added.id) throw std::runtime_error(std::string{to_string(added.error)});
    loop.request_enable(*added.id);
  }
  return loop;
}

// The samples of every 97th step are lost: a prime, so that the losses fall into all modes.
inline constexpr std::size_t loss_interval = 97;

struct ForceSegment {
  double until_s;
  model::AppliedForce force;
};

struct RecordedStep {
  std::vector<hal::ReceivedFrame> received;  // that wait when the step starts
  std::vector<hal::CanFrame> sent;
  std::vector<ForceSegment> forces;  // on the first axis' plant since the step before
  std::int32_t target_counts = 0;
  bool running = false;  // all axes
};

template <class Real>
struct Recording {
  hal::Duration period{};
  std::vector<RecordedStep> steps;
  std::size_t first_running = 0;
  std::vector<law::Measurement<Real>> measurements;  // of the first axis, from first_running on

  hal::Time time(std::size_t step) const { return hal::Time{period * static_cast<std::int64_t>(step)}; }
};

// The plant as a drive's mechanism; notes the forces on it while a list for them is set.
class Axis final : public drive_emulator::Mechanism {
 public:
  // The first axis of the scenario; all are alike.
  explicit Axis(const scenario::Scenario& s)
      : slide_{s.node.axes[0].mass_kg, s.worlds[0].friction, {0, s.worlds[0].position_m, s.worlds[0].velocity_m_s}} {}
  void advance_to(double time_s, const model::AppliedForce& force) override {
    slide_.advance_to(time_s, force);
    if (notes_ != nullptr) notes_->push_back({time_s, force});
  }
  double position_m() const override { return slide_.state().position_m; }
  void note_forces(std::vector<ForceSegment>* notes) { notes_ = notes; }

 private:
  motion::Slide slide_;
  std::vector<ForceSegment>* notes_ = nullptr;
};

// A plant that is more than rigid, released from its brake, or none. It notes no forces.
inline std::unique_ptr<sil::BrakedMechanism> compliant_axis(const scenario::Scenario& s) {
  if (s.worlds[0].plant.rigid()) return nullptr;
  auto axis = sil::axis_mechanism(s.node.axes[0], s.worlds[0]).axis;
  axis->release(0);
  return axis;
}

// One axis' drive emulator and plant. Frames reach it and leave it at once: there is no bus in between.
class EmulatedAxis {
 public:
  EmulatedAxis(const scenario::Scenario& s, std::size_t place)
      : axis_{s},
        compliant_{compliant_axis(s)},
        drive_{*s.worlds[place].drive, mechanism(), [this](const hal::CanFrame& frame, hal::Time at) {
                 outbox_.push_back({frame, at});
               }} {
    drive_.power_on(hal::Time{});
  }

  // Brings the axis to `now`, hands it the frames that were sent at the time of the step before, and takes its answers.
  void pass_period(const std::vector<hal::CanFrame>& frames, hal::Time before, hal::Time now) {
    for (const hal::CanFrame& frame : frames) drive_.on_frame(frame, before);
    while (const auto next = drive_.next_event()) {
      if (*next > now) break;
      drive_.advance_to(*next);
    }
    drive_.advance_to(now);
  }
  std::vector<hal::ReceivedFrame>& outbox() { return outbox_; }
  Axis& axis() { return axis_; }

 private:
  drive_emulator::Mechanism& mechanism() {
    return compliant_ ? static_cast<drive_emulator::Mechanism&>(*compliant_) : axis_;
  }

  Axis axis_;
  std::unique_ptr<sil::BrakedMechanism> compliant_;
  std::vector<hal::ReceivedFrame> outbox_;
  drive_emulator::DriveEmulator drive_;
};

// Until the tour ends; its time starts when all axes run. Throws std::runtime_error when they do not.
template <class Real, class Controller>
Recording<Real> record(const scenario::Scenario& s, const Controller& controller, double duration_s = tour_s) {
  TapePort port;
  auto loop = make_loop<Real>(port, s, controller);
  std::vector<std::unique_ptr<EmulatedAxis>> plants;
  for (std::size_t i = 0; i < s.axes(); ++i) plants.push_back(std::make_unique<EmulatedAxis>(s, i));

  const double period_s = s.node.period_s();
  Recording<Real> r{s.node.loop->period, {}, 0, {}};
  const auto ticks = static_cast<std::size_t>(duration_s / period_s);
  for (std::size_t k = 0; r.first_running == 0 || k < r.first_running + ticks; ++k) {
    RecordedStep& step = r.steps.emplace_back();
    plants[0]->axis().note_forces(&step.forces);
    for (auto& plant : plants) {
      plant->pass_period(k > 0 ? r.steps[k - 1].sent : std::vector<hal::CanFrame>{}, r.time(k > 0 ? k - 1 : 0),
                         r.time(k));
      for (const hal::ReceivedFrame& frame : plant->outbox()) step.received.push_back(frame);
      plant->outbox().clear();
    }
    const bool lost = r.first_running > 0 && k % loss_interval == 0;
    if (lost) step.received.clear();
    const double time_s = r.first_running > 0 ? static_cast<double>(k - r.first_running) * period_s : 0;
    step.target_counts = target_counts(time_s, resolution_m(s));
    run_step(loop, port, r, k);
    step.sent.assign(port.sent().begin(), port.sent().end());
    step.running = true;
    for (std::size_t i = 0; i < loop.axes(); ++i) step.running = step.running && loop.status(*loop.axis(i)).running;
    if (step.running && r.first_running == 0) r.first_running = k;
    if (r.first_running > 0) {
      if (!step.running) throw std::runtime_error("an axis stopped during the recording");
      const auto& feedback = loop.status(*loop.axis(0)).feedback;
      r.measurements.push_back({feedback.position_offset_m, Real{0}, feedback.fresh});
    }
    if (k > 10'000 && r.first_running == 0) throw std::runtime_error("the axes do not run");
  }
  return r;
}

// Everything of step k that is not the step itself, then the step.
template <class Real, class AnyLoop>
void prepare_step(AnyLoop& loop, TapePort& port, const Recording<Real>& r, std::size_t k) {
  const std::int32_t target = r.steps[k].target_counts;
  if (k > 0 && target != r.steps[k - 1].target_counts) {
    for (std::size_t i = 0; i < loop.axes(); ++i) loop.set_target_counts(*loop.axis(i), target);
  }
  port.lay_in(r.steps[k].received);
}
template <class Real, class AnyLoop>
void run_step(AnyLoop& loop, TapePort& port, const Recording<Real>& r, std::size_t k) {
  prepare_step(loop, port, r, k);
  loop.step(r.time(k));
}

}  // namespace breakaway::bench
