// The controller node of firmware/targets against the world that an image carries, both in this process.
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "breakaway/firmware/control_node.hpp"
#include "node_world.hpp"

namespace breakaway::emulated {

// A CanPort to a world that takes its frames at the end of the step.
class WorldPort {
 public:
  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time) noexcept {
    sent_.push_back(frame);
    return hal::SendResult::queued;
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (next_ == received_.size()) return false;
    received = received_[next_++];
    return true;
  }
  void purge_transmit_queue() noexcept { sent_.clear(); }
  hal::BusState bus_state() const noexcept { return hal::BusState::error_active; }

  void bring_to(NodeWorld& world) {
    for (const hal::CanFrame& frame : std::exchange(sent_, {})) world.take(frame);
    received_.clear();
    next_ = 0;
  }
  void lay_in(const hal::CanFrame& frame, hal::Time at) { received_.push_back({frame, at}); }

 private:
  std::vector<hal::CanFrame> sent_;
  std::vector<hal::ReceivedFrame> received_;
  std::size_t next_ = 0;
};
static_assert(hal::CanPort<WorldPort>);

class WorldRun {
 public:
  explicit WorldRun(std::uint32_t periods)
      : world_{periods, [this](const hal::CanFrame& frame) { port_.lay_in(frame, now_ + period_ / 2); }},
        node_{port_, flashed::node} {
    if (!node_.verdict().ok()) throw std::runtime_error(std::string{to_string(node_.verdict().error)});
    while (world_.periods() < periods) {
      now_ += period_;
      node_.step(now_);
      port_.bring_to(world_);
      world_.pass_period();
    }
  }
  const NodeWorld& world() const { return world_; }

 private:
  const hal::Duration period_ = flashed::node.loop.network.period;
  hal::Time now_{};
  WorldPort port_;
  NodeWorld world_;
  firmware::ControlNode<WorldPort, std::remove_const_t<decltype(flashed::node)>> node_;
};

}  // namespace breakaway::emulated
