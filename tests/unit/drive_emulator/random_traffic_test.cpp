#include <array>
#include <random>

#include "drive_bench.hpp"

namespace breakaway::drive_emulator {
namespace {

// Frames that a confused master could send: the right identifiers, often the right objects, and data at random.
class RandomMaster {
 public:
  explicit RandomMaster(std::uint64_t seed) : random_(seed) {}

  hal::Duration pause() { return microseconds{below(300)}; }

  hal::CanFrame frame() {
    constexpr std::array<std::uint16_t, 12> ids = {0x000, 0x080, 0x605, 0x605, 0x605, 0x605,
                                                   0x605, 0x205, 0x305, 0x405, 0x505, 0x77F};
    hal::CanFrame frame{.id = ids[below(ids.size())], .size = static_cast<std::uint8_t>(below(3) ? 8 : below(9))};
    for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random_());
    if (frame.id == 0x000) frame = nmt();
    if (frame.id == 0x080) frame.size = below(20) ? 0 : 1;
    if (frame.id == 0x605) address(frame);
    return frame;
  }

 private:
  std::size_t below(std::size_t limit) { return random_() % limit; }

  hal::CanFrame nmt() {
    constexpr std::array<std::uint8_t, 4> rare = {0x02, 0x80, 0x81, 0x82};
    return {.id = 0, .size = 2, .data = {below(50) ? std::uint8_t{1} : rare[below(rare.size())], 5}};
  }

  void address(hal::CanFrame& frame) {
    constexpr std::array<std::uint8_t, 13> commands = {0x40, 0x2F, 0x2B, 0x23, 0x21, 0x60, 0x70,
                                                       0x00, 0x10, 0x01, 0x11, 0x80, 0x22};
    constexpr std::array<std::uint16_t, 25> objects = {
        0x1000, 0x1003, 0x1005, 0x1006, 0x1007, 0x1008, 0x1014, 0x1016, 0x1017, 0x1029, 0x1400, 0x1401, 0x1600,
        0x1601, 0x1800, 0x1802, 0x1A00, 0x1A02, 0x6040, 0x6060, 0x6071, 0x6072, 0x605A, 0x60C2, 0x6403};
    const std::uint16_t index = objects[below(objects.size())];
    frame.data[0] = commands[below(commands.size())];
    frame.data[1] = static_cast<std::uint8_t>(index);
    frame.data[2] = static_cast<std::uint8_t>(index >> 8);
    frame.data[3] = static_cast<std::uint8_t>(below(6));
    if (below(2) == 0) return;
    frame.data[4] = static_cast<std::uint8_t>(below(16));  // small numbers, and addresses of objects to map
    frame.data[5] = 0;
    frame.data[6] = below(2) ? 0x71 : 0x41;
    frame.data[7] = 0x60;
  }

  std::mt19937_64 random_;
};

TEST_F(DriveBench, SurvivesRandomTrafficWithinItsForceLimit) {
  EmulatorConfig config = bench_config();
  config.valid_pdos = 4;
  config.current_loop_time_constant_s = 1e-3;
  start(config);
  RandomMaster master{7};
  bool made_torque = false;
  for (int i = 0; i < 100'000; ++i) {
    now += master.pause();
    drive->on_frame(master.frame(), now);
    made_torque = made_torque || force_N() != 0;
    const auto next = drive->next_event();
    ASSERT_TRUE(!next || *next > now) << "left something undone";
    ASSERT_LE(drive->largest_force_N(now), 30.0 * (1 + 1e-12));
    ASSERT_TRUE(force_N() == 0 || drive->state() == cia402::State::operation_enabled);
  }
  EXPECT_TRUE(made_torque);
}

}  // namespace
}  // namespace breakaway::drive_emulator
