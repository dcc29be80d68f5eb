#include "breakaway/watch/commander.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "breakaway/config/axis_parameters.hpp"

namespace breakaway::watch {
namespace {

// What was heard longer ago than this is past.
constexpr hal::Duration recent = std::chrono::seconds{1};

bool is_recent(const std::optional<hal::Time>& at, hal::Time now) { return at && now - *at <= recent; }

// Two commands in one period of the node would be one to it.
hal::Duration interval_of(const config::Loop& loop) {
  constexpr hal::Duration longest = std::chrono::milliseconds{100};
  return std::max(3 * loop.period, std::min(loop.command_timeout / 5, longest));
}

}  // namespace

Commander::Commander(const config::Node& node, BusListener& listener)
    : node_{node}, listener_{listener}, axes_(node.axes.size()), interval_{interval_of(*node.loop)} {
  for (std::size_t place = 0; place < axes_.size(); ++place) axes_[place].said.axis = static_cast<std::uint8_t>(place);
}

std::string Commander::obey(const Command& command, hal::Time now) {
  if (command.axis >= axes_.size()) return fmt::format("this node has {} axes", axes_.size());
  Axis& axis = axes_[command.axis];
  // A stop of what we command is never refused.
  if (command.action == Action::stop && axis.commanded) {
    release(axis);
    return {};
  }
  if (std::string deaf = why_deaf(now); !deaf.empty()) return deaf;
  const auto position = listener_.position_counts(command.axis);
  if (!position) return "its drive was not heard yet: is it on, and does the node set it up?";
  if (!axis.commanded) axis.said.target_counts = *position;
  page_is_seen(now);
  switch (command.action) {
    case Action::enable:
      return enable(command.axis, now);
    case Action::target:
      return set_target(command.axis, command.target_m);
    case Action::reset:
      release(axis);
      axis.commanded = true;
      axis.reset_since = now;
      return {};
    case Action::stop:
      break;
  }
  release(axis);
  axis.commanded = true;
  return {};
}

std::string Commander::why_deaf(hal::Time now) const {
  if (is_recent(listener_.heard_commander_at(), now))
    return "another commander speaks on the bus; end it before this one begins";
  if (!is_recent(listener_.heard_node_at(), now))
    return fmt::format(
        "no status of node {} is heard: is it running, does [loop] node_id say its number, and is it one "
        "that others command (an image; not breakaway-node)?",
        node_.loop->node_id);
  return {};
}

std::string Commander::enable(std::size_t place, hal::Time now) {
  Axis& axis = axes_[place];
  if (const auto fault = listener_.fault(place); fault && *fault != firmware::AxisFault::none)
    return fmt::format("it has the fault \"{}\"; reset it first", to_string(*fault));
  if (axis.said.enable || axis.wanted) return "it is enabled already";
  if (!is_recent(listener_.heard_drive_at(place), now))
    return "its drive is not heard any more, and where the axis stands is not known: is it on, and does the node set "
           "it up?";
  axis.said.target_counts = *listener_.position_counts(place);
  axis.reset_since.reset();
  axis.said.reset_fault = false;
  axis.commanded = axis.wanted = true;
  return {};
}

std::string Commander::set_target(std::size_t place, double target_m) {
  Axis& axis = axes_[place];
  if (!axis.said.enable && !axis.wanted) return "it is not enabled; enable it first";
  if (std::string problem = config::target_problem(target_m, node_.axes[place]); !problem.empty())
    return fmt::format("the target {} m {}", target_m, problem);
  if (std::string far = far_problem(place, target_m); !far.empty()) return far;
  axis.said.target_counts =
      static_cast<std::int32_t>(std::round(target_m / node_.axes[place].drive->encoder_resolution_m));
  return {};
}

// A machine of several axes is certified for targets that are given at rest.
std::string Commander::far_problem(std::size_t place, double target_m) const {
  if (!node_.coupling) return {};
  if (!listener_.holds(place))
    return "it does not hold yet, where its machine is certified for targets that are given at rest; wait for it";
  const config::Axis& axis = node_.axes[place];
  const double from_m = *listener_.position_counts(place) * axis.drive->encoder_resolution_m;
  const std::string far = config::way_problem(node_, axis, from_m, target_m);
  return far.empty() ? far : "it would go " + far;
}

void Commander::release(Axis& axis) {
  axis.wanted = axis.said.enable = false;
  axis.said.reset_fault = false;
  axis.reset_since.reset();
}

// The reset acts on its rising edge: the command before it says none.
void Commander::follow_reset(std::size_t place, hal::Time now) {
  Axis& axis = axes_[place];
  if (!axis.reset_since) return;
  const bool done = axis.said.reset_fault && listener_.fault(place) == firmware::AxisFault::none;
  if (done || now - *axis.reset_since > reset_patience) axis.reset_since.reset();
}

std::vector<hal::CanFrame> Commander::due(hal::Time now) {
  if (now - said_at_ < interval_) return {};
  said_at_ = now;
  const bool page = page_seen_at_ && now - *page_seen_at_ <= page_timeout;
  std::vector<hal::CanFrame> frames;
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    Axis& axis = axes_[place];
    if (!axis.commanded) continue;
    if (!page) release(axis);
    follow_reset(place, now);
    frames.push_back(firmware::encode_command(axis.said, node_.loop->node_id));
    listener_.note_target(place, axis.said.target_counts);
    // What is said next.
    axis.said.enable = axis.wanted;
    axis.said.reset_fault = axis.reset_since.has_value();
  }
  return frames;
}

std::vector<hal::CanFrame> Commander::farewell() {
  std::vector<hal::CanFrame> frames;
  for (Axis& axis : axes_) {
    if (!axis.commanded) continue;
    release(axis);
    frames.push_back(firmware::encode_command(axis.said, node_.loop->node_id));
  }
  return frames;
}

}  // namespace breakaway::watch
