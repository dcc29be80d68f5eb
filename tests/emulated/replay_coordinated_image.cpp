// Replays axis.tape and hostile.tape, of eight axes, through their coordinator, and writes what it did to axis.results
// and hostile.results.
#include <cstddef>
#include <string_view>

#include "eight_axes.hpp"
#include "replay_files.hpp"

namespace {

using namespace breakaway;
using namespace breakaway::emulated;

constexpr EightAxes parameters = eight_axes();

struct Machine {
  EightAxesCoordinator coordinator{parameters};
  std::size_t next = 0;
};

ReplayExit replay_tape(std::string_view tape_name, std::string_view results_name) {
  return replay_file<CoordinatedResult>(Machine{}, tape_name, results_name, [](Machine& machine, const TapeStep& step) {
    const std::size_t axis = machine.next;
    machine.next = axis + 1 < coordinated_axes ? axis + 1 : 0;
    return replay_coordinated(
        machine.coordinator, axis, step,
        [](EightAxesCoordinator& c, std::size_t i, const law::Measurement<float>& z) {
          count_begin();
          const law::ControlOutput<float> output = c.update(i, z);
          count_end();
          return output;
        },
        [] {
          count_begin();
          count_end();
        });
  });
}

}  // namespace

void run_image() {
  count_begin();
  count_end();
  ReplayExit code = replay_tape("axis.tape", "axis.results");
  if (code == done) code = replay_tape("hostile.tape", "hostile.results");
  exit_emulator(code);
}
