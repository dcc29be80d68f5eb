#include "coordinated_replay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <random>
#include <vector>

#include "callgrind_count.hpp"
#include "eight_axes.hpp"
#include "write_file.hpp"

namespace breakaway::emulated {
namespace {

// A mass with a friction of its own: what is counted is the work of the coordinator, whatever its axes do.
struct Mass {
  double mass_kg, friction_N;
  double position_m = 0, velocity_m_s = 0;

  void move(double force_N, double period_s) {
    constexpr int steps = 50;
    const double h = period_s / steps;
    for (int n = 0; n < steps; ++n) {
      const double pushed_m_s = velocity_m_s + force_N / mass_kg * h, most_m_s = friction_N / mass_kg * h;
      velocity_m_s = pushed_m_s > 0 ? std::max(pushed_m_s - most_m_s, 0.0) : std::min(pushed_m_s + most_m_s, 0.0);
      position_m += velocity_m_s * h;
    }
  }
};

// A prime, so that the losses fall into all phases.
constexpr std::size_t loss_interval = 97, target_interval = 4000;

float rounded(double position_m, float count_m) {
  return std::nearbyint(static_cast<float>(position_m) / count_m) * count_m;
}

std::vector<TapeStep> coordinated_tape(std::size_t periods) {
  constexpr EightAxes p = eight_axes();
  EightAxesCoordinator coordinator{p};
  std::vector<Mass> masses;
  for (std::size_t i = 0; i < coordinated_axes; ++i)
    masses.push_back({p.axes[i].mass_kg, 2.6 + 0.25 * static_cast<double>(i), i % 2 == 0 ? 0.03 : -0.028});
  std::vector<TapeStep> tape;
  for (std::size_t k = 0; k < periods; ++k) {
    std::array<double, coordinated_axes> forces_N{};
    for (std::size_t i = 0; i < coordinated_axes; ++i) {
      const bool moves_on = k > 0 && k % target_interval == 0;
      const float shift_m = moves_on ? (k / target_interval % 2 == 0 ? 0.03F : -0.025F) : 0.0F;
      masses[i].position_m -= shift_m;
      tape.push_back({shift_m, rounded(masses[i].position_m, p.axes[i].resolution_m),
                      k % loss_interval == loss_interval - 1 ? 0U : fresh_flag});
      const auto ask = [](EightAxesCoordinator& c, std::size_t axis, const law::Measurement<float>& z) {
        return c.update(axis, z);
      };
      forces_N[i] = replay_coordinated(coordinator, i, tape.back(), ask, [] {}).force_N;
    }
    for (std::size_t i = 0; i < coordinated_axes; ++i) masses[i].move(forces_N[i], p.period_s);
  }
  return tape;
}

// Readings that no machine would give: stillness and leaps at all scales, target changes, losses, axes that are left
// out, what is not a number.
std::vector<TapeStep> hostile_coordinated_tape(std::size_t periods) {
  constexpr EightAxes p = eight_axes();
  std::mt19937 random{8};  // NOLINT: the same tape every time
  const auto chance = [&](unsigned one_in) { return random() % one_in == 0; };
  const auto leap_m = [&](float most_m) {
    const float size_m = std::ldexp(most_m, -static_cast<int>(random() % 20));
    return chance(2) ? size_m : -size_m;
  };
  const std::array<float, 5> oddities{NAN, INFINITY, -INFINITY, 1e-42F, 3e38F};
  std::array<float, coordinated_axes> at_m{};
  std::vector<TapeStep> tape;
  for (std::size_t k = 0; k < periods; ++k) {
    // Mostly still, so that the axes are let go and kicked.
    const bool leaps = chance(120), loses = chance(50);
    for (std::size_t i = 0; i < coordinated_axes; ++i) {
      if (leaps || chance(3000)) at_m[i] = leap_m(chance(30) ? 1.0F : p.axes[i].gate_m);
      TapeStep step{0, rounded(at_m[i], p.axes[i].resolution_m), loses || chance(1000) ? 0U : fresh_flag};
      if (chance(5000)) step.shift_m = leap_m(0.03F);
      if (chance(10000)) step.position_error_m = oddities[random() % oddities.size()];
      if (chance(700)) step.flags |= reset_flag;
      if (chance(10000)) step.flags |= left_out_flag;
      tape.push_back(step);
    }
  }
  return tape;
}

std::vector<CoordinatedResult> replay_eight_axes(const std::vector<TapeStep>& tape, const std::string& name) {
  constexpr EightAxes parameters = eight_axes();
  const auto ask = [](EightAxesCoordinator& c, std::size_t axis, const law::Measurement<float>& z) {
    return c.update(axis, z);
  };
  EightAxesCoordinator coordinator{parameters};
  std::vector<CoordinatedResult> results;
  for (std::size_t i = 0; i < tape.size(); ++i)
    results.push_back(replay_coordinated(coordinator, i % coordinated_axes, tape[i], ask, [] {}));
  EightAxesCoordinator counted{parameters};
  bench::start_counting();
  for (std::size_t k = 0; k < tape.size(); k += coordinated_axes) {
    const std::string label = name + "/" + std::to_string(static_cast<int>(results[k].phase));
    bench::count(label, [&] {
      for (std::size_t i = 0; i < coordinated_axes; ++i) replay_coordinated(counted, i, tape[k + i], ask, [] {});
    });
  }
  bench::stop_counting();
  return results;
}

}  // namespace

void replay_coordinated_tapes(const std::string& folder) {
  std::filesystem::create_directories(folder);
  const std::vector<TapeStep> tape = coordinated_tape(10000), hostile = hostile_coordinated_tape(20000);
  write_file(folder + "/axis.tape", tape);
  write_file(folder + "/hostile.tape", hostile);
  write_file(folder + "/axis.results", replay_eight_axes(tape, "coordinated/axis"));
  write_file(folder + "/hostile.results", replay_eight_axes(hostile, "coordinated/hostile"));
}

}  // namespace breakaway::emulated
