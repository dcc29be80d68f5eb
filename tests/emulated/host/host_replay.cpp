// Records 5000 steps of each axis in closed loop (float, one sample in 97 lost), makes 20000 hostile ones, and replays
// both here:
//   host_replay FOLDER   writes FOLDER/<scenario>/axis.tape, hostile.tape, axis.results and hostile.results, and
//                        pid.results where the coast is "pd"
// and FOLDER/coordinated/ with the same of eight axes under their coordinator.
// Under callgrind every replayed update leaves its count, labelled <scenario>/<results>/<kind of step>; of the
// coordinator every period of all its axes, by the phase in which it begins.
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "callgrind_count.hpp"
#include "coordinated_replay.hpp"
#include "recording.hpp"
#include "replay.hpp"
#include "write_file.hpp"

namespace breakaway::emulated {
namespace {

constexpr std::size_t steps_to_record = 5000;

template <class Controller>
std::vector<TapeStep> record_tape(const scenario::Scenario& s, const Controller& controller) {
  const auto r = bench::record<float>(s, controller, (steps_to_record + 0.5) * s.node.period_s());
  const auto resolution_m = static_cast<float>(bench::resolution_m(s));
  std::vector<TapeStep> tape;
  for (std::size_t i = 0; i < steps_to_record; ++i) {
    const std::size_t k = r.first_running + i;
    const std::int32_t shift = r.steps[k].target_counts - r.steps[k - 1].target_counts;
    tape.push_back({static_cast<float>(shift) * resolution_m, r.measurements.at(i).position_error_m,
                    r.measurements[i].fresh ? fresh_flag : 0U});
  }
  return tape;
}

// Samples that no axis would give: stops, creeping and leaps at all scales, target changes, losses, what is not a
// number.
std::vector<TapeStep> hostile_tape(const law::AxisParameters<float>& p, std::size_t steps) {
  std::mt19937 random{7};  // NOLINT: the same tape every time
  const auto chance = [&](unsigned one_in) { return random() % one_in == 0; };
  const auto leap = [&] {
    const float size = std::ldexp(1.0F, -static_cast<int>(random() % 24)) * 4 * p.stick_radius_upper_m();
    return chance(2) ? size : -size;
  };
  const std::array<float, 5> oddities{NAN, INFINITY, -INFINITY, 1e-42F, 3e38F};
  std::vector<TapeStep> tape;
  float x = 0, per_step = 0;
  for (std::size_t i = 0; i < steps; ++i) {
    if (chance(30)) x = leap();
    if (chance(12)) per_step = chance(2) ? 0.0F : leap() / 64;
    x += per_step;
    const float counts = std::nearbyint(x / p.encoder_resolution_m);
    TapeStep step{0, counts * p.encoder_resolution_m, chance(40) ? 0U : fresh_flag};
    if (chance(100)) step.shift_m = leap();
    if (chance(500)) step.position_error_m = oddities[random() % oddities.size()];
    if (chance(100)) step.flags |= reset_flag;
    tape.push_back(step);
  }
  return tape;
}

// The kind of a step is known after it only, so a first replay finds the labels.
template <class Controller>
std::vector<StepResult> replay_tape(const std::vector<TapeStep>& tape, const Controller& initial,
                                    const std::string& name) {
  using Sample = law::Measurement<float>;
  Controller controller = initial;
  std::vector<StepResult> results;
  results.reserve(tape.size());
  for (const TapeStep& step : tape)
    results.push_back(replay_step(controller, step, [](Controller& c, const Sample& z) { return c.update(z); }));
  controller = initial;
  bench::start_counting();
  for (std::size_t i = 0; i < tape.size(); ++i) {
    const std::string label = name + "/" + std::to_string(static_cast<int>(results[i].kind));
    replay_step(controller, tape[i], [&](Controller& c, const Sample& z) {
      law::ControlOutput<float> output;
      bench::count(label, [&] { output = c.update(z); });
      return output;
    });
  }
  bench::stop_counting();
  return results;
}

template <class Axis>
void run(const std::string& into, const std::string& name, const scenario::Scenario& s, const Axis& axis) {
  const law::AxisController<float, decltype(axis.kicks)> controller{axis.law, axis.k3_table, axis.kicks};
  const std::string folder = into + "/" + name;
  std::filesystem::create_directories(folder);
  const std::vector<TapeStep> tape = record_tape(s, controller);
  write_file(folder + "/axis.tape", tape);
  const std::vector<TapeStep> hostile = hostile_tape(axis.law, 20000);
  write_file(folder + "/hostile.tape", hostile);
  write_file(folder + "/hostile.results", replay_tape(hostile, controller, name + "/hostile"));
  write_file(folder + "/axis.results", replay_tape(tape, controller, name + "/axis"));
  if (axis.law.coast != law::Coast::pd) return;
  const law::PidController<float> pid{pid_parameters(axis.law)};
  write_file(folder + "/pid.results", replay_tape(tape, pid, name + "/pid"));
}

// The targets replay with what `breakaway design` wrote into a header for them, which must be the same numbers.
void run(const std::string& into, const std::string& name) {
  const scenario::Scenario s = bench::scenario_from_rest(name);
  if (config::is_by_work(s.node))
    run(into, name, s, config::flashed_by_work<float>(s.node).axes[0]);
  else
    run(into, name, s, config::flashed<float>(s.node).axes[0]);
}

}  // namespace
}  // namespace breakaway::emulated

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: host_replay FOLDER\n", stderr);
    return 2;
  }
  try {
    for (const char* name : {"can_axis", "braked_axis", "move_axis", "fine_axis", "presliding_axis", "belt_axis"})
      breakaway::emulated::run(argv[1], name);
    breakaway::emulated::replay_coordinated_tapes(std::string{argv[1]} + "/coordinated");
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "host_replay: %s\n", error.what());
    return 1;
  }
}
