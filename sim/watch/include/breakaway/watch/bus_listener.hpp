// BusListener: what frames on the bus tell of the axes of a node, to somebody who sends nothing.
//
// The drives' PDOs tell position, force and state, in every period. A node that another one commands (ControlNode)
// tells mode and fault of its axes in its status frames, and its commander's commands tell the targets; breakaway-node,
// which commands itself, sends neither, so that of its axes there is only what the drives say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/firmware/remote_control.hpp"
#include "breakaway/hal/bus_load.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/watch/sample.hpp"

namespace breakaway::watch {

class BusListener {
 public:
  // Every axis of the node must have a drive.
  explicit BusListener(const config::Node& node);

  // Takes a frame, of anybody. Returns a sample where it is an axis' position.
  std::optional<Sample> on_frame(const hal::ReceivedFrame& received);

  // The names of the axes as they stand in samples: empty where there is one only.
  std::vector<std::string> axes() const;

  // Where the axis stands, once its drive was heard.
  std::optional<std::int32_t> position_counts(std::size_t place) const { return axes_[place].position_counts; }

  // When its drive was last heard to say so; nothing: never.
  std::optional<hal::Time> heard_drive_at(std::size_t place) const { return axes_[place].heard_at; }

  // When the node last told of itself; nothing: never.
  std::optional<hal::Time> heard_node_at() const { return heard_node_at_; }

  // When somebody last commanded the node; nothing: never.
  std::optional<hal::Time> heard_commander_at() const { return heard_commander_at_; }

  // What we command ourselves is not heard: it is said here.
  void note_target(std::size_t place, std::int32_t counts);

  // As its status frame had it last.
  bool holds(std::size_t place) const { return axes_[place].told.mode == law::Mode::hold; }
  std::optional<firmware::AxisFault> fault(std::size_t place) const { return axes_[place].told.fault; }

 private:
  struct Axis {
    Sample told;  // what is known of it until now
    std::optional<std::int32_t> position_counts;
    std::optional<hal::Time> heard_at;
    std::uint8_t drive_id = 0;
    bool invert = false;
    double resolution_m = 0, force_quantum_N = 0;
  };

  void take_status(const firmware::MotionStatus& status);

  std::vector<Axis> axes_;
  std::uint8_t node_id_;
  hal::BusLoad bus_load_;
  std::optional<hal::Time> heard_node_at_, heard_commander_at_;
};

}  // namespace breakaway::watch
