// Replays axis.tape, of the node's first axis, and hostile.tape through the impulsive law, and axis.tape through a PID
// where the coast is "pd"; and writes what they did to axis.results, hostile.results and pid.results. Between the two
// marks an emulator counts instructions; the first pair of marks has nothing in between.
#include <array>
#include <type_traits>

#include "flashed_node.hpp"
#include "replay.hpp"
#include "semihosting.hpp"

namespace {

using namespace breakaway;
using namespace breakaway::emulated;

}  // namespace

extern "C" {
[[gnu::noinline]] void count_begin() { asm volatile("" ::: "memory"); }
[[gnu::noinline]] void count_end() { asm volatile("" ::: "memory"); }
}

namespace {

enum ExitCode : std::uint32_t { done = 0, no_tape = 1, cannot_write = 2 };

template <class Controller>
ExitCode replay_file(Controller controller, std::string_view tape_name, std::string_view results_name) {
  HostFile tape{tape_name, OpenMode::read_binary};
  HostFile results{results_name, OpenMode::write_binary};
  if (!tape.is_open()) return no_tape;
  if (!results.is_open()) return cannot_write;
  std::array<TapeStep, 16> steps;
  std::array<StepResult, 16> outcomes;
  while (const std::size_t count = tape.read(steps.data(), sizeof steps) / sizeof(TapeStep)) {
    for (std::size_t i = 0; i < count; ++i) {
      outcomes[i] = replay_step(controller, steps[i], [](Controller& c, const law::Measurement<float>& z) {
        count_begin();
        const law::ControlOutput<float> output = c.update(z);
        count_end();
        return output;
      });
    }
    if (!results.write(outcomes.data(), count * sizeof(StepResult))) return cannot_write;
  }
  return done;
}

}  // namespace

void run_image() {
  count_begin();
  count_end();
  const auto& flashed_axis = flashed::node.axes[0];
  using Kicks = std::remove_cvref_t<decltype(flashed_axis.kicks)>;
  const law::AxisController<float, Kicks> axis{flashed_axis.law, flashed_axis.k3_table, flashed_axis.kicks};
  ExitCode code = replay_file(axis, "axis.tape", "axis.results");
  if (code == done) code = replay_file(axis, "hostile.tape", "hostile.results");
  if (code == done && flashed_axis.law.coast == law::Coast::pd) {
    const law::PidController<float> pid{pid_parameters(flashed_axis.law)};
    code = replay_file(pid, "axis.tape", "pid.results");
  }
  exit_emulator(code);
}
