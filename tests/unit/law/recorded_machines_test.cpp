// KickCoordinator behaves as it did when it was certified: axes of a machine that slide on friction of their own, with
// samples that are lost, targets that move, drives that weaken and axes that drop out. See recorded_figures.hpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "../../campaign/random_braked_axis.hpp"
#include "../../recorded_figures.hpp"
#include "breakaway/law/coordinator_parameters.hpp"
#include "breakaway/law/kick_coordinator.hpp"

namespace breakaway::law::recorded_machines {
namespace {

using breakaway::testing::Moment;
using breakaway::testing::Slider;
using breakaway::testing::TrueAxis;
using campaign::Random;

constexpr std::size_t most_axes = 3;
using Parameters = CoordinatorParameters<double, most_axes>;

Parameters random_machine(Random& r) {
  Parameters p;
  p.period_s = 1e-3;
  p.count = static_cast<std::uint8_t>(r.between(1, 3.99));
  p.settling_periods = static_cast<std::uint8_t>(r.between(1, 3.99));
  p.still_periods = static_cast<std::uint8_t>(r.between(2, 9));
  p.release_periods = static_cast<std::uint16_t>(r.between(0, 20));
  p.most_kicks = static_cast<std::uint32_t>(r.decades(3, 60));
  for (std::size_t i = 0; i < p.count; ++i) {
    auto& a = p.axes[i];
    a.mass_kg = r.decades(0.5, 5);
    a.lower_N = r.between(1, 3);
    a.upper_N = a.lower_N * r.between(1.1, 2);
    a.sure_N = 1.002 * a.upper_N;
    a.brake_N = r.share() < 0.3 ? 0 : 0.9 * a.lower_N * r.share();
    a.kick_N = r.share() < 0.1 ? 0 : a.upper_N * r.between(1.5, 12);
    a.max_force_N = std::max(a.kick_N, 20.0);
    a.position_gain_N_per_m = a.mass_kg * 400;
    a.velocity_gain_Ns_per_m = a.mass_kg * 36;
    a.gate_m = r.decades(0.004, 0.03);
    a.resolution_m = 1e-6;
    a.tolerance_m = r.decades(2e-6, 1e-4);
    for (std::size_t j = 0; j < p.count; ++j) a.hold_off[j] = i == j ? 0 : r.between(-0.2, 0.2);
  }
  return p;
}

// Of all axes; a force counts as many times as its axis has a number.
struct MachineFigures {
  double kicks = 0, phase = 0, fault = 0, end = 0, kicked = 0, moved = 0;
  double error_m = 0, approach_periods = 0, hold_periods = 0, pulses = 0;
  double force_Ns = 0, lever_Ns2 = 0, square_N2s = 0;

  std::array<double, 13> all() const {
    return {kicks,        phase,  fault,    end,       kicked,    moved, error_m, approach_periods,
            hold_periods, pulses, force_Ns, lever_Ns2, square_N2s};
  }
};

class Machine {
 public:
  Machine(const Parameters& p, Random& r) : p_{p}, coordinator_{p_} {
    for (std::size_t i = 0; i < p_.count; ++i) {
      const auto& a = p_.axes[i];
      const double level_N = r.between(a.lower_N, a.upper_N), start_m = r.between(-1, 1) * r.decades(1e-4, 0.1);
      axes_.emplace_back(
          TrueAxis{a.mass_kg, 1, 0, 0, 0}, [=](const Moment&) { return level_N; }, start_m, 0.0);
    }
  }

  void step(int k, std::size_t left_out, bool lost) {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      if (i == left_out) continue;
      const double reading_m = std::round((axes_[i].position_m() - target_m_[i]) / 1e-6) * 1e-6;
      const auto out = coordinator_.update(i, {reading_m, 0, !(lost && i == 0)});
      note(out, static_cast<double>(i + 1), 1e-3 * k);
      force_N_[i] = out.force_N;
    }
    for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].run(force_N_[i], p_.period_s, 2);
  }
  // Something befalls it.
  void befall(Random& r) {
    const auto axis = static_cast<std::size_t>(r.between(0, p_.count));
    const double event = r.share(), way_m = r.between(-1, 1) * r.decades(1e-5, 0.05);
    if (event < 0.4) {
      target_m_[axis] += way_m;
      coordinator_.shift_target(axis, way_m);
    } else if (event < 0.6) {
      target_m_[axis] += way_m;  // it is pushed
    } else if (event < 0.75) {
      coordinator_.limit_force(axis, r.between(0.5, 2) * p_.axes[axis].upper_N);
    } else {
      coordinator_.reset(axis);
    }
  }
  MachineFigures figures() const {
    MachineFigures f = figures_;
    f.kicks = coordinator_.kicks();
    f.phase = static_cast<double>(coordinator_.phase());
    f.fault = static_cast<double>(coordinator_.fault());
    f.end = static_cast<double>(coordinator_.end());
    f.kicked = static_cast<double>(coordinator_.kicked());
    f.moved = static_cast<double>(coordinator_.moved());
    for (std::size_t i = 0; i < axes_.size(); ++i)
      f.error_m += static_cast<double>(i + 1) * (axes_[i].position_m() - target_m_[i]);
    return f;
  }

 private:
  void note(const ControlOutput<double>& out, double weight, double t_s) {
    figures_.force_Ns += weight * std::fabs(out.force_N) * 1e-3;
    figures_.lever_Ns2 += weight * out.force_N * t_s * 1e-3;
    figures_.square_N2s += weight * out.force_N * out.force_N * 1e-3;
    figures_.approach_periods += out.mode == Mode::approach ? weight : 0;
    figures_.hold_periods += out.mode == Mode::hold ? weight : 0;
    figures_.pulses += out.kicked ? weight + 10 * t_s : 0;
  }

  Parameters p_;
  KickCoordinator<double, most_axes> coordinator_;
  std::vector<Slider> axes_;
  std::array<double, most_axes> target_m_{}, force_N_{};
  MachineFigures figures_;
};

MachineFigures run(std::uint64_t number) {
  Random r{number};
  const Parameters p = random_machine(r);
  Machine machine{p, r};
  const bool loses = r.share() < 0.3, drops_out = r.share() < 0.3;
  for (int k = 0; k < 1500; ++k) {
    if (r.share() < 0.002) machine.befall(r);
    const std::size_t left_out =
        drops_out && r.share() < 0.003 ? static_cast<std::size_t>(r.between(0, p.count)) : most_axes;
    machine.step(k, left_out, loses && r.share() < 0.05);
  }
  return machine.figures();
}

class MachineRun : public ::testing::TestWithParam<std::uint64_t> {};
TEST_P(MachineRun, IsAsItWasCertified) {
  static const recorded::RecordedFigures kept{BREAKAWAY_SOURCE_DIR "/tests/unit/law/recorded_machines.csv", 6};
  constexpr std::uint64_t runs = 8;
  for (std::uint64_t i = 0; i < runs; ++i) {
    const std::uint64_t number = runs * GetParam() + i;
    kept.expect("machine " + std::to_string(number), run(number).all());
  }
}
INSTANTIATE_TEST_SUITE_P(Of, MachineRun, ::testing::Range(std::uint64_t{0}, std::uint64_t{25}));

}  // namespace
}  // namespace breakaway::law::recorded_machines
