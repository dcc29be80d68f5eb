#include "drive_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <span>
#include <utility>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/canopen/sync.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/state.hpp"
#include "breakaway/input/input_error.hpp"
#include "error_text.hpp"

namespace breakaway::linux_node {
namespace {

using namespace std::chrono_literals;
using firmware::AxisFault;

std::string listed(const Nodes& nodes) {
  std::string text;
  for (std::size_t node = 0; node < nodes.size(); ++node)
    if (nodes.test(node)) text += fmt::format("{}{}", text.empty() ? "" : ", ", node);
  return text;
}

double microseconds(hal::Duration duration) { return std::chrono::duration<double, std::micro>(duration).count(); }

}  // namespace

template <class Flashed, class Side>
DriveRun<Flashed, Side>::DriveRun(const Flashed& flashed, const Configuration& configuration, const Options& options,
                                  socketcan::KernelSocket& socket, Telemetry& telemetry)
    : flashed_{flashed},
      c_{configuration},
      options_{options},
      telemetry_{telemetry},
      socket_port_{socket},
      port_{socket_port_, telemetry},
      served_{port_, flashed.loop.network.node_id},
      laws_{flashed},
      loop_{served_, flashed.loop},
      objects_{loop_, flashed},
      ticker_{flashed.loop.network.period} {
  add_axes();
  for (std::size_t place = 0; place < loop_.axes(); ++place) axes_.push_back({.id = *loop_.axis(place)});
}

template <class Flashed, class Side>
void DriveRun<Flashed, Side>::add_axes() {
  if constexpr (Side::is_canopen) {
    firmware::add_axes(loop_, flashed_, laws_);
  } else {
    for (std::size_t i = 0; i < flashed_.count; ++i)
      static_cast<void>(loop_.add_axis(c_.odrives[i], laws_.law_of(i), flashed_.axes[i].limits));
  }
}

// Nobody but us may speak, and every drive is set up.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::get_ready() {
  ticker_ = Ticker{flashed_.loop.network.period};
  refuse_other_master();
  set_up();
}

template <class Flashed, class Side>
std::string DriveRun<Flashed, Side>::named(std::size_t place) const {
  return axes_.size() == 1 ? fmt::format("drive {}", c_.node_id(place))
                           : fmt::format("axis {}: drive {}", plan(place).name, c_.node_id(place));
}

template <class Flashed, class Side>
void DriveRun<Flashed, Side>::poll() {
  now_ = ticker_.wait();
  if (ticker_.in_time()) telemetry_.periods.fetch_add(1, std::memory_order_relaxed);
  socket_port_.poll(now_);
  port_.set_time(now_);
}

template <class Flashed, class Side>
void DriveRun<Flashed, Side>::step() {
  poll();
  if (telemetry_.reset.exchange(false)) reset_faults();
  loop_.command(now_);
  sync();
  answer();
  for (std::size_t place = 0; place < axes_.size(); ++place) note(place);
}

// At its time after the tick, however late this thread woke then.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::sync() {
  const auto due = loop_.sync_due();
  if (!due) return;
  const hal::Time now = *due > now_ ? ticker_.wait_within(*due - now_) : now_;
  port_.set_time(now);
  loop_.sync(now);
}

// Whoever reads our objects by SDO gets one answer a period at most.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::answer() {
  if constexpr (Side::is_canopen) {
    hal::CanFrame frame;
    if (served_.server().next_frame(frame, objects_))
      static_cast<void>(port_.send(frame, now_ + flashed_.loop.network.period));
  }
}

// A reset is for the faults that the operator sees; on a bus that is off it would come too early.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::reset_faults() {
  const bool bus = port_.bus_state() != hal::BusState::bus_off;
  for (Axis& axis : axes_)
    if (loop_.status(axis.id).fault != AxisFault::none) axis.reset_refused = !bus || !loop_.reset_fault(axis.id);
}

template <class Flashed, class Side>
void DriveRun<Flashed, Side>::note(std::size_t place) {
  StepRecord noted = record(place);
  noted.reset_refused = std::exchange(axes_[place].reset_refused, false);
  telemetry_.add(noted);
}

template <class Flashed, class Side>
StepRecord DriveRun<Flashed, Side>::record(std::size_t place) const {
  const auto id = axes_[place].id;
  const auto& s = loop_.status(id);
  StepRecord step{.time = now_,
                  .latency = ticker_.last_latency(),
                  .target_counts = loop_.target_counts(id),
                  .position_counts = drive(place).position_counts(),
                  .command_N = s.output.force_N,
                  .reported_N = s.feedback.force_N,
                  .mode = s.output.mode,
                  .drive = s.feedback.state,
                  .fault = s.fault,
                  .fault_code = loop_.supervisor(id).fault_code(),
                  .axis = static_cast<std::uint8_t>(place),
                  .stop_not_obeyed = s.stop_not_obeyed,
                  .link_lost = socket_port_.link_lost()};
  Side::note(drive(place), step);
  return step;
}

// Another master is heard before we say a word.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::refuse_other_master() {
  const hal::NetworkConfig& network = flashed_.loop.network;
  const hal::Duration patience = std::max<hal::Duration>(3 * network.period, 2 * network.heartbeat_period);
  std::vector<std::uint8_t> nodes;
  for (std::size_t place = 0; place < axes_.size(); ++place) nodes.push_back(c_.node_id(place));
  const hal::Time begin = ticker_.wait();
  do {
    poll();
    for (hal::ReceivedFrame received; port_.receive(received);) {
      const std::string sign = Side::other_master(received.frame, network, nodes);
      if (sign.empty()) continue;
      throw InputError{fmt::format(
          "{}: another master is on the bus ({}); end it, or put its axes into this node's file as [[axis]]",
          options_.interface, sign)};
    }
  } while (now_ - begin < patience && !telemetry_.stop);
}

// One that was found with force, and is stopping, is not set up either.
template <class Flashed, class Side>
bool DriveRun<Flashed, Side>::any_configuring() const {
  return std::ranges::any_of(axes_, [&](const Axis& axis) {
    const hal::DriveState state = loop_.status(axis.id).feedback.state;
    return state == hal::DriveState::configuring || state == hal::DriveState::stopping;
  });
}

// No axis is enabled before all drives are set up: whoever is refused here has moved nothing, nor has its neighbour.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::set_up() {
  // The mode alone may take ten seconds, and every object takes periods.
  const hal::Duration usual = 20s + 1000 * flashed_.loop.network.period;
  HeardTime heard{flashed_.loop.network.period, ticker_.wait()};
  while (!telemetry_.stop) {
    step();
    heard.pass_to(now_);
    for (Axis& axis : axes_) axis.heard = axis.heard || Side::was_heard(loop_.drive(axis.id));
    refuse_unusable_drives();
    if (!any_configuring()) break;
    if (heard.passed() > duration_of(options_.patience_s)) refuse_silent_drives();
    hal::Duration extra{};
    for (const Axis& axis : axes_) extra = std::max(extra, Side::extra_setup_time(loop_.drive(axis.id)));
    if (heard.passed() > usual + extra) refuse_standing_drives();
  }
}

// As soon as its drive is set up.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::enable() {
  if (telemetry_.stop) return;
  for (const Axis& axis : axes_) {
    if (options_.reset && loop_.status(axis.id).fault != AxisFault::none) loop_.reset_fault(axis.id);
    loop_.request_enable(axis.id);
  }
}

template <class Flashed, class Side>
void DriveRun<Flashed, Side>::refuse_unusable_drives() const {
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    if (status(place).feedback.state != hal::DriveState::unusable) continue;
    throw InputError{fmt::format("{} on {}: {}", named(place), options_.interface, Side::why_unusable(drive(place)))};
  }
}

// One that answers only now, when everybody is asked, has come in time.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::refuse_silent_drives() {
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    if (axes_[place].heard) continue;
    const Nodes alive = nodes_on_bus();
    axes_[place].heard = alive.test(c_.node_id(place));
    if (axes_[place].heard) continue;
    const std::string axis = axes_.size() == 1 ? "" : fmt::format(" (axis {})", plan(place).name);
    throw InputError{fmt::format(
        "{}: no drive answers as node {}{}; {}", options_.interface, c_.node_id(place), axis,
        alive.none() ? "nor does any other node: check power, wiring, termination and bit rate"
                     : fmt::format("these nodes do: {}; choose one by --node-id or [drive] node_id", listed(alive)))};
  }
}

template <class Flashed, class Side>
void DriveRun<Flashed, Side>::refuse_standing_drives() const {
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    const hal::DriveState state = status(place).feedback.state;
    if (state == hal::DriveState::stopping)
      throw InputError{fmt::format("{}: {}", named(place), to_string(drive(place).setup_status()))};
    if (state == hal::DriveState::configuring)
      throw InputError{fmt::format("{}: {}", named(place), Side::why_standing(drive(place)))};
  }
}

// Reads the device type of a node, which moves nothing. An ODrive tells by its heartbeat that it is there.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::ask_node(std::uint8_t node) {
  if constexpr (Side::is_canopen) {
    canopen::SdoClient sdo{node, 1s};
    hal::CanFrame question;
    if (sdo.start_read(cia402::object::device_type, 0) == canopen::SdoStart::started && sdo.next_frame(question, now_))
      static_cast<void>(port_.send(question, now_ + flashed_.loop.network.period));
  }
}

template <class Flashed, class Side>
Nodes DriveRun<Flashed, Side>::nodes_on_bus() {
  Nodes alive;
  hal::ReceivedFrame received;
  const hal::NetworkConfig& network = flashed_.loop.network;
  const hal::Time begin = now_;
  for (unsigned tick = 1; tick < 250 || now_ - begin < 500ms; ++tick) {
    poll();
    while (port_.receive(received))
      if (const auto node = Side::heard_node(received.frame); node && *node != network.node_id) alive.set(*node);
    if (tick <= canopen::max_node_id) ask_node(static_cast<std::uint8_t>(tick));
  }
  return alive;
}

// Disabled, as every drive says itself.
template <class Flashed, class Side>
bool DriveRun<Flashed, Side>::stops_are_confirmed() {
  for (Axis& axis : axes_) {
    const auto& feedback = loop_.status(axis.id).feedback;
    const bool holds_force = feedback.state == hal::DriveState::enabled ||
                             feedback.state == hal::DriveState::enabling ||
                             feedback.state == hal::DriveState::stopping || feedback.state == hal::DriveState::homing;
    // One that fell silent is waited for as `configuring`, too.
    const bool told = (feedback.state == hal::DriveState::configuring && !loop_.drive(axis.id).heartbeat_lost()) ||
                      now_ - feedback.sample_time < 3 * flashed_.loop.network.period;
    axis.confirmed = !holds_force && told && port_.bus_state() != hal::BusState::bus_off;
  }
  return std::ranges::all_of(axes_, &Axis::confirmed);
}

// Quick stop, then disabled.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::stop_and_confirm() {
  // A drive may take a second for its quick stop; one that does not obey is forced to it by every means there is.
  constexpr hal::Duration patience = 1500ms + cia402::ForcedStop::round_time;
  for (const Axis& axis : axes_) loop_.request_stop(axis.id);
  for (HeardTime heard{flashed_.loop.network.period, now_}; heard.passed() < patience; heard.pass_to(now_)) {
    step();
    if (stops_are_confirmed()) return;
  }
}

// The drives shall not take the end of our heartbeats for a failure. One that was not seen without force shall: it is
// the last that can stop it.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::release_drives() {
  for (std::size_t place = 0; place < axes_.size(); ++place)
    if (axes_[place].heard && axes_[place].confirmed) release(place);
}

// The torque limit that was lowered for this axis is not left to whoever uses the drive next. An ODrive that is idle
// has nothing to be given back.
template <class Flashed, class Side>
void DriveRun<Flashed, Side>::release(std::size_t place) {
  if constexpr (Side::is_canopen) {
    const hal::Duration period = flashed_.loop.network.period;
    const std::uint8_t node_id = c_.node_id(place);
    const cia402::DriveRating& rating = drive(place).rating();
    canopen::SdoClient sdo{node_id, 50ms};
    if (port_.send(canopen::nmt_frame(canopen::NmtCommand::enter_pre_operational, node_id), now_ + period) !=
        hal::SendResult::queued)
      return;
    if (rating.found_max_torque_per_mille > rating.max_torque_per_mille)
      write(sdo, {cia402::object::max_torque, 0, 2, rating.found_max_torque_per_mille});
    write(sdo, {cia402::object::consumer_heartbeat, 1, 4, 0});
  }
}

template <class Flashed, class Side>
void DriveRun<Flashed, Side>::write(canopen::SdoClient& sdo, canopen::ObjectWrite object) {
  std::array<std::uint8_t, 4> bytes{};
  canopen::store_little_endian(bytes, object.value);
  bool over =
      sdo.start_write(object.index, object.subindex, std::span{bytes}.first(object.size)) != canopen::SdoStart::started;
  for (HeardTime heard{flashed_.loop.network.period, now_}; !over && heard.passed() < 200ms; heard.pass_to(now_)) {
    poll();
    for (hal::ReceivedFrame received; port_.receive(received);) sdo.on_frame(received.frame);
    over = sdo.poll(now_) != canopen::SdoResult::busy;
    hal::CanFrame frame;
    if (!over && sdo.next_frame(frame, now_)) static_cast<void>(port_.send(frame, now_ + flashed_.loop.network.period));
  }
}

template <class Flashed, class Side>
std::string DriveRun<Flashed, Side>::fault_text(std::size_t place) const {
  const AxisFault fault = axes_[place].last_fault;
  const StepRecord now = record(place);
  std::string text;
  if (fault != AxisFault::none) text += fmt::format(", fault: {}", to_string(fault));
  if (fault == AxisFault::enable_timed_out) text += fmt::format(" ({})", why_disabled(now));
  if (now.fault_code != 0) text += fmt::format(" ({})", error_text(now));
  if (now.stop_not_obeyed && fault != AxisFault::stop_not_obeyed)
    text += fmt::format(", {}", to_string(AxisFault::stop_not_obeyed));
  return text;
}

template <class Flashed, class Side>
std::string DriveRun<Flashed, Side>::last_words(std::size_t place) const {
  return Side::last_words(drive(place), plan(place));
}

template <class Flashed, class Side>
std::string DriveRun<Flashed, Side>::stop_text(std::size_t place) const {
  if (axes_[place].confirmed) return "stopped" + fault_text(place);
  return fmt::format(
      "NOT CONFIRMED as stopped: the drive was told to by {} and was not seen without force; switch its power off{}",
      Side::stop_means, fault_text(place));
}

template <class Flashed, class Side>
bool DriveRun<Flashed, Side>::ended_well(std::size_t place) const {
  const Axis& axis = axes_[place];
  return axis.confirmed && axis.last_fault == AxisFault::none && !loop_.status(axis.id).stop_not_obeyed;
}

template <class Flashed, class Side>
void DriveRun<Flashed, Side>::stop() {
  telemetry_.stopping = true;
  for (Axis& axis : axes_) axis.last_fault = loop_.status(axis.id).fault;
  stop_and_confirm();
  release_drives();
}

template <class Flashed, class Side>
std::string DriveRun<Flashed, Side>::figures() const {
  const Latency& l = ticker_.latency();
  const socketcan::Counters n = socket_port_.counters();
  return fmt::format(
      "timing      {} ticks, {} missed, wake-up latency {:.1f} / {:.1f} / {:.1f} us (min / mean / max)\n"
      "bus         {} bus-off, {} link losses, {} frames stale, {} refused, {} lost, {} jams; {} records "
      "lost\n",
      l.wakes, l.missed, microseconds(l.shortest), microseconds(l.mean()), microseconds(l.longest), n.bus_offs,
      n.link_losses, n.stale, n.refused, n.overflows, n.jams,
      telemetry_.lost + telemetry_.csv_unwritten + telemetry_.candump_unwritten);
}

template class DriveRun<config::AnyNode<float>, CanopenSide>;
template class DriveRun<config::WorkNode<float>, CanopenSide>;
template class DriveRun<config::MachineNode<float>, CanopenSide>;
template class DriveRun<ExperimentNode, CanopenSide>;
template class DriveRun<config::AnyNode<float>, OdriveSide>;
template class DriveRun<ExperimentNode, OdriveSide>;

}  // namespace breakaway::linux_node
