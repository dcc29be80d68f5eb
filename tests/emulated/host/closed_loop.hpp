// One closed-loop run over slcan: targets are commanded over the bus, and the world says what came of it. The
// controller is whoever answers: an image on an emulated machine, or the same node in this process.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "breakaway/firmware/control_node.hpp"
#include "breakaway/slcan/port.hpp"
#include "flashed_node.hpp"
#include "recording.hpp"
#include "slcan_world.hpp"

namespace breakaway::emulated {

// The targets of the recorded tour, from the period on in which the brake opens.
class Commander {
 public:
  explicit Commander(const scenario::Scenario& s) : s_{s} {}

  // Once a period.
  void command(SlcanWorld& world) {
    if (world.periods() < first_command_) return;
    if (world.released()) time_s_ += s_.node.period_s();
    const std::int32_t target = bench::target_counts(time_s_, bench::resolution_m(s_));
    const bool due = world.periods() % said_again_after_ == 0;
    if (told_ && target == last_ && !due) return;
    // "Enable" is an edge, so that it is not said with the first command.
    world.tell(firmware::encode_command({.axis = 0, .enable = told_, .target_counts = target},
                                        flashed::node.loop.network.node_id));
    told_ = true;
    last_ = target;
  }
  bool finished() const { return time_s_ > bench::tour_s + 0.8; }
  double target_m() const { return last_ * bench::resolution_m(s_); }

 private:
  static constexpr std::uint64_t first_command_ = 10;
  static constexpr std::uint64_t said_again_after_ = 100;  // periods; the controller waits for five times as long
  const scenario::Scenario& s_;
  std::int32_t last_ = 0;
  bool told_ = false;
  double time_s_ = 0;
};

// Brings what the controller said to the world, and lets the commander speak once a period.
inline std::string converse(SlcanWorld& world, Commander& commander, std::string_view text) {
  std::string answers;
  for (const char c : text) {
    const std::uint64_t before = world.periods();
    answers += world.answer({&c, 1});
    if (world.periods() != before) commander.command(world);
  }
  return answers;
}

// A ByteStream whose far end is a world in this process.
class LocalStream {
 public:
  LocalStream(SlcanWorld& world, Commander& commander) : world_{world}, commander_{commander} {}
  bool read(char& character) noexcept {
    if (next_ == received_.size()) return false;
    character = received_[next_++];
    return true;
  }
  bool write(std::span<const char> text) noexcept {
    received_ += converse(world_, commander_, {text.data(), text.size()});
    return true;
  }

 private:
  SlcanWorld& world_;
  Commander& commander_;
  std::string received_;
  std::size_t next_ = 0;
};

// The node of firmware/targets in this process, until the tour is over.
inline void run_node_here(SlcanWorld& world, Commander& commander) {
  LocalStream stream{world, commander};
  slcan::Port<LocalStream> port{stream, flashed::node.loop.network.bit_rate};
  firmware::ControlNode node{port, flashed::node};
  if (!node.verdict().ok()) throw std::runtime_error(std::string{to_string(node.verdict().error)});
  const hal::Duration period = flashed::node.loop.network.period;
  for (hal::Time now{period}; !commander.finished() && world.periods() < 100'000; now += period) {
    port.poll(now);
    node.step(now);
    port.flush(now);
  }
}

}  // namespace breakaway::emulated
