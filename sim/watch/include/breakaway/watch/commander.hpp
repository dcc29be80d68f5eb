// Commander: says on the bus what the page's operator wants of a node, as remote_control.hpp has it.
//
// It says nothing until the operator first asks for something, and nothing while another commander speaks. From then on
// it repeats its commands, of the axes that were asked for, several times in LoopConfig::command_timeout:
//
//   enable   the axis is to hold where it stands, as its drive still says: "not enabled" with its position as target,
//            and then "enabled"
//   target   of an enabled axis, within the limits of its file, and of axes that push each other near where they hold
//   stop     "not enabled"
//   reset    "not enabled", and the reset until the node shows no fault, for two seconds at most
//
// Nobody commands from a page that is closed: when the page was not heard for `page_timeout`, all axes are told "not
// enabled", and so they are when the commander ends. Should it be killed, or its cable be cut, the node stops its axes
// by itself, as "commander lost".
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/firmware/remote_control.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/watch/bus_listener.hpp"
#include "breakaway/watch/command.hpp"

namespace breakaway::watch {

class Commander {
 public:
  static constexpr hal::Duration page_timeout = std::chrono::seconds{3};
  static constexpr hal::Duration reset_patience = std::chrono::seconds{2};

  // Both must outlive it. Every axis of the node must have a drive.
  Commander(const config::Node& node, BusListener& listener);

  // Takes what the operator wants. Returns nothing, or why it is not done.
  std::string obey(const Command& command, hal::Time now);

  // The page is there.
  void page_is_seen(hal::Time now) { page_seen_at_ = now; }

  // Returns the commands that are due; to be called once in interval() at least.
  std::vector<hal::CanFrame> due(hal::Time now);

  // Returns "not enabled" for every axis that was ever commanded.
  std::vector<hal::CanFrame> farewell();

  hal::Duration interval() const { return interval_; }

 private:
  struct Axis {
    firmware::MotionCommand said;  // last, or to be said first
    bool wanted = false;           // to be enabled, with the next command
    bool commanded = false;        // anything was ever asked of it
    std::optional<hal::Time> reset_since{};
  };

  std::string enable(std::size_t place, hal::Time now);
  std::string set_target(std::size_t place, double target_m);
  std::string far_problem(std::size_t place, double target_m) const;
  std::string why_deaf(hal::Time now) const;
  void release(Axis& axis);
  void follow_reset(std::size_t place, hal::Time now);

  const config::Node& node_;
  BusListener& listener_;
  std::vector<Axis> axes_;
  hal::Duration interval_;
  hal::Time said_at_{};
  std::optional<hal::Time> page_seen_at_;
};

}  // namespace breakaway::watch
