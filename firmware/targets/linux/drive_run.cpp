#include "drive_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bitset>
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

double microseconds(hal::Duration duration) { return std::chrono::duration<double, std::micro>(duration).count(); }

std::string object_text(canopen::ObjectAddress object) {
  return fmt::format("{:04X}h:{:02X}", object.index, object.subindex);
}

// Why the drive is refused, with the remedy.
std::string why_unusable(const cia402::Drive<float>& drive) {
  const cia402::SetupStatus status = drive.setup_status();
  switch (status) {
    case cia402::SetupStatus::object_refused:
      return fmt::format("{} ({}: {})", to_string(status), object_text(drive.setup_object()),
                         canopen::to_string(drive.setup_abort_code()));
    case cia402::SetupStatus::value_not_kept:
      return fmt::format("{} ({})", to_string(status), object_text(drive.setup_object()));
    case cia402::SetupStatus::rated_torque_differs:
    case cia402::SetupStatus::rated_torque_unit:
      return fmt::format("{} (6076h is {})", to_string(status), drive.rating().rated_torque_mNm);
    default:
      return std::string{to_string(status)};
  }
}

}  // namespace

template <class Flashed>
DriveRun<Flashed>::DriveRun(const Flashed& flashed, const Configuration& configuration, const Options& options,
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
  firmware::add_axes(loop_, flashed_, laws_);
  for (std::size_t place = 0; place < loop_.axes(); ++place) axes_.push_back({.id = *loop_.axis(place)});
}

// Nobody but us may speak, and every drive is set up.
template <class Flashed>
void DriveRun<Flashed>::get_ready() {
  ticker_ = Ticker{flashed_.loop.network.period};
  refuse_other_master();
  set_up();
}

template <class Flashed>
std::string DriveRun<Flashed>::named(std::size_t place) const {
  return axes_.size() == 1 ? fmt::format("drive {}", flashed_.axes[place].drive.node_id)
                           : fmt::format("axis {}: drive {}", plan(place).name, flashed_.axes[place].drive.node_id);
}

template <class Flashed>
void DriveRun<Flashed>::poll() {
  now_ = ticker_.wait();
  if (ticker_.in_time()) telemetry_.periods.fetch_add(1, std::memory_order_relaxed);
  socket_port_.poll(now_);
  port_.set_time(now_);
}

template <class Flashed>
void DriveRun<Flashed>::step() {
  poll();
  if (telemetry_.reset.exchange(false)) reset_faults();
  loop_.step(now_);
  answer();
  for (std::size_t place = 0; place < axes_.size(); ++place) note(place);
}

// Whoever reads our objects by SDO gets one answer a period at most.
template <class Flashed>
void DriveRun<Flashed>::answer() {
  hal::CanFrame frame;
  if (served_.server().next_frame(frame, objects_))
    static_cast<void>(port_.send(frame, now_ + flashed_.loop.network.period));
}

// A reset is for the faults that the operator sees; on a bus that is off it would come too early.
template <class Flashed>
void DriveRun<Flashed>::reset_faults() {
  const bool bus = port_.bus_state() != hal::BusState::bus_off;
  for (Axis& axis : axes_)
    if (loop_.status(axis.id).fault != AxisFault::none) axis.reset_refused = !bus || !loop_.reset_fault(axis.id);
}

template <class Flashed>
void DriveRun<Flashed>::note(std::size_t place) {
  Axis& axis = axes_[place];
  const auto& s = loop_.status(axis.id);
  telemetry_.add(StepRecord{.time = now_,
                            .latency = ticker_.last_latency(),
                            .target_counts = loop_.target_counts(axis.id),
                            .position_counts = loop_.drive(axis.id).position_counts(),
                            .command_N = s.output.force_N,
                            .reported_N = s.feedback.force_N,
                            .mode = s.output.mode,
                            .drive = s.feedback.state,
                            .fault = s.fault,
                            .fault_code = loop_.supervisor(axis.id).fault_code(),
                            .error_register = loop_.drive(axis.id).last_emcy().error_register,
                            .statusword = loop_.drive(axis.id).statusword(),
                            .axis = static_cast<std::uint8_t>(place),
                            .stop_not_obeyed = s.stop_not_obeyed,
                            .link_lost = socket_port_.link_lost(),
                            .reset_refused = std::exchange(axis.reset_refused, false)});
}

// Two masters would double the SYNC rate and fight over every drive. One is heard by its SYNC, or by the heartbeat of
// our own node id, before we say a word.
template <class Flashed>
void DriveRun<Flashed>::refuse_other_master() {
  const hal::NetworkConfig& network = flashed_.loop.network;
  const hal::Duration patience = std::max<hal::Duration>(3 * network.period, 2 * network.heartbeat_period);
  const hal::Time begin = ticker_.wait();
  do {
    poll();
    for (hal::ReceivedFrame received; port_.receive(received);) {
      const std::uint16_t id = received.frame.id;
      if (!canopen::is_sync(received.frame) && id != canopen::heartbeat_cob_id(network.node_id)) continue;
      throw InputError{fmt::format(
          "{}: another master is on the bus ({}); end it, or put its axes into this node's file as [[axis]]",
          options_.interface,
          canopen::is_sync(received.frame) ? "it sends SYNC"
                                           : fmt::format("it is node {}, as we are", network.node_id))};
    }
  } while (now_ - begin < patience && !telemetry_.stop);
}

// One that was found with force, and is stopping, is not set up either.
template <class Flashed>
bool DriveRun<Flashed>::any_configuring() const {
  return std::ranges::any_of(axes_, [&](const Axis& axis) {
    const hal::DriveState state = loop_.status(axis.id).feedback.state;
    return state == hal::DriveState::configuring || state == hal::DriveState::stopping;
  });
}

// No axis is enabled before all drives are set up: whoever is refused here has moved nothing, nor has its neighbour.
template <class Flashed>
void DriveRun<Flashed>::set_up() {
  // The mode alone may take ten seconds, and every object takes periods.
  const hal::Duration usual = 20s + 1000 * flashed_.loop.network.period;
  const hal::Time begin = ticker_.wait();
  while (!telemetry_.stop) {
    step();
    for (Axis& axis : axes_) axis.heard = axis.heard || loop_.drive(axis.id).nmt_state().has_value();
    refuse_unusable_drives();
    if (!any_configuring()) break;
    if (now_ - begin > duration_of(options_.patience_s)) refuse_silent_drives();
    hal::Duration extra{};
    for (const Axis& axis : axes_) extra = std::max(extra, loop_.drive(axis.id).extra_setup_time());
    if (now_ - begin > usual + extra) refuse_standing_drives();
  }
}

// As soon as its drive is set up.
template <class Flashed>
void DriveRun<Flashed>::enable() {
  if (telemetry_.stop) return;
  for (const Axis& axis : axes_) {
    if (options_.reset && loop_.status(axis.id).fault != AxisFault::none) loop_.reset_fault(axis.id);
    loop_.request_enable(axis.id);
  }
}

template <class Flashed>
void DriveRun<Flashed>::refuse_unusable_drives() const {
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    if (status(place).feedback.state != hal::DriveState::unusable) continue;
    throw InputError{
        fmt::format("{} on {} {}", named(place), options_.interface, why_unusable(loop_.drive(axes_[place].id)))};
  }
}

template <class Flashed>
void DriveRun<Flashed>::refuse_silent_drives() {
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    if (axes_[place].heard) continue;
    const std::string axis = axes_.size() == 1 ? "" : fmt::format(" (axis {})", plan(place).name);
    const std::string alive = nodes_on_bus();
    throw InputError{fmt::format(
        "{}: no drive answers as node {}{}; {}", options_.interface, flashed_.axes[place].drive.node_id, axis,
        alive.empty() ? "nor does any other node: check power, wiring, termination and bit rate"
                      : fmt::format("these nodes do: {}; choose one by --node-id or [drive] node_id", alive))};
  }
}

template <class Flashed>
void DriveRun<Flashed>::refuse_standing_drives() const {
  for (std::size_t place = 0; place < axes_.size(); ++place) {
    const hal::DriveState state = status(place).feedback.state;
    const auto& drive = loop_.drive(axes_[place].id);
    if (state == hal::DriveState::stopping)
      throw InputError{fmt::format("{}: {}", named(place), to_string(drive.setup_status()))};
    if (state != hal::DriveState::configuring) continue;
    if (const canopen::Emcy& told = drive.last_emcy(); told.code != 0)
      throw InputError{fmt::format("{}: it does not get ready, and tells why: {}; see its manual", named(place),
                                   error_text(told.code, told.error_register))};
    throw InputError{fmt::format("{}: the set-up stands still at object {} ({}); check the wiring", named(place),
                                 object_text(drive.setup_object()), to_string(drive.setup_status()))};
  }
}

// Reads the device type of every node, which moves nothing.
template <class Flashed>
std::string DriveRun<Flashed>::nodes_on_bus() {
  std::bitset<128> alive;
  hal::ReceivedFrame received;
  const hal::NetworkConfig& network = flashed_.loop.network;
  for (unsigned tick = 1; tick < 250; ++tick) {
    poll();
    while (port_.receive(received)) {
      const std::uint8_t node = canopen::node_id_of(received.frame.id);
      if (received.frame.id == canopen::sdo_response_cob_id(node) ||
          received.frame.id == canopen::heartbeat_cob_id(node))
        alive.set(node);
    }
    if (tick > canopen::max_node_id) continue;
    canopen::SdoClient sdo{static_cast<std::uint8_t>(tick), 1s};
    hal::CanFrame question;
    if (sdo.start_read(cia402::object::device_type, 0) == canopen::SdoStart::started && sdo.next_frame(question, now_))
      static_cast<void>(port_.send(question, now_ + network.period));
  }
  std::string text;
  for (std::size_t node = 1; node < alive.size(); ++node)
    if (alive.test(node) && node != network.node_id) text += fmt::format("{}{}", text.empty() ? "" : ", ", node);
  return text;
}

// Disabled, seen in every drive's own statusword.
template <class Flashed>
bool DriveRun<Flashed>::stops_are_confirmed() {
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
template <class Flashed>
void DriveRun<Flashed>::stop_and_confirm() {
  // A drive may take a second for its quick stop; one that does not obey is forced to it by every means there is.
  constexpr hal::Duration patience = 1500ms + cia402::ForcedStop::round_time;
  for (const Axis& axis : axes_) loop_.request_stop(axis.id);
  for (const hal::Time begin = now_; now_ - begin < patience;) {
    step();
    if (stops_are_confirmed()) return;
  }
}

// The drives shall not take the end of our heartbeats for a failure. One that was not seen without force shall: it is
// the last that can stop it.
template <class Flashed>
void DriveRun<Flashed>::release_drives() {
  for (std::size_t place = 0; place < axes_.size(); ++place)
    if (axes_[place].heard && axes_[place].confirmed) release(place);
}

// The torque limit that was lowered for this axis is not left to whoever uses the drive next.
template <class Flashed>
void DriveRun<Flashed>::release(std::size_t place) {
  const hal::Duration period = flashed_.loop.network.period;
  const std::uint8_t node_id = flashed_.axes[place].drive.node_id;
  const cia402::DriveRating& rating = loop_.drive(axes_[place].id).rating();
  canopen::SdoClient sdo{node_id, 50ms};
  if (port_.send(canopen::nmt_frame(canopen::NmtCommand::enter_pre_operational, node_id), now_ + period) !=
      hal::SendResult::queued)
    return;
  if (rating.found_max_torque_per_mille > rating.max_torque_per_mille)
    write(sdo, {cia402::object::max_torque, 0, 2, rating.found_max_torque_per_mille});
  write(sdo, {cia402::object::consumer_heartbeat, 1, 4, 0});
}

template <class Flashed>
void DriveRun<Flashed>::write(canopen::SdoClient& sdo, canopen::ObjectWrite object) {
  std::array<std::uint8_t, 4> bytes{};
  canopen::store_little_endian(bytes, object.value);
  bool over =
      sdo.start_write(object.index, object.subindex, std::span{bytes}.first(object.size)) != canopen::SdoStart::started;
  for (const hal::Time begin = now_; !over && now_ - begin < 200ms;) {
    poll();
    for (hal::ReceivedFrame received; port_.receive(received);) sdo.on_frame(received.frame);
    over = sdo.poll(now_) != canopen::SdoResult::busy;
    hal::CanFrame frame;
    if (!over && sdo.next_frame(frame, now_)) static_cast<void>(port_.send(frame, now_ + flashed_.loop.network.period));
  }
}

template <class Flashed>
std::string DriveRun<Flashed>::fault_text(const Axis& axis) const {
  std::string text;
  if (axis.last_fault != AxisFault::none) text += fmt::format(", fault: {}", to_string(axis.last_fault));
  if (const std::uint16_t word = loop_.drive(axis.id).statusword(); axis.last_fault == AxisFault::enable_timed_out)
    text += fmt::format(" (statusword {:04X}h, {})", word, cia402::what_keeps_disabled(word));
  if (const std::uint16_t code = loop_.supervisor(axis.id).fault_code(); code != 0)
    text += fmt::format(" ({})", error_text(code, loop_.drive(axis.id).last_emcy().error_register));
  const auto& s = loop_.status(axis.id);
  if (s.stop_not_obeyed && axis.last_fault != AxisFault::stop_not_obeyed)
    text += fmt::format(", {}", to_string(AxisFault::stop_not_obeyed));
  return text;
}

// A node that is killed cannot put 6072h back, and the next one takes what it finds for the drive's own.
template <class Flashed>
std::string DriveRun<Flashed>::torque_limit_text(std::size_t place) const {
  const cia402::DriveRating& rating = loop_.drive(axes_[place].id).rating();
  const std::uint16_t found = rating.found_max_torque_per_mille;
  if (found == 0 || found > rating.max_torque_per_mille || found >= plan(place).max_torque_per_mille) return {};
  return fmt::format(
      "            torque limit (6072h) was found at {} per mille, and the file says {}: a node that was killed may "
      "have left it so; switch the drive off and on, or write 6072h\n",
      found, plan(place).max_torque_per_mille);
}

template <class Flashed>
std::string DriveRun<Flashed>::stop_text(std::size_t place) const {
  const Axis& axis = axes_[place];
  return (axis.confirmed
              ? "stopped"
              : "NOT CONFIRMED as stopped: the drive was told to by PDO, SDO and NMT and was not seen without "
                "force; switch its power off") +
         fault_text(axis);
}

template <class Flashed>
bool DriveRun<Flashed>::ended_well(std::size_t place) const {
  const Axis& axis = axes_[place];
  return axis.confirmed && axis.last_fault == AxisFault::none && !loop_.status(axis.id).stop_not_obeyed;
}

template <class Flashed>
void DriveRun<Flashed>::stop() {
  telemetry_.stopping = true;
  for (Axis& axis : axes_) axis.last_fault = loop_.status(axis.id).fault;
  stop_and_confirm();
  release_drives();
}

template <class Flashed>
std::string DriveRun<Flashed>::figures() const {
  const Latency& l = ticker_.latency();
  const socketcan::Counters n = socket_port_.counters();
  return fmt::format(
      "timing      {} ticks, {} missed, wake-up latency {:.1f} / {:.1f} / {:.1f} us (min / mean / max)\n"
      "bus         {} bus-off, {} link losses, {} frames stale, {} refused, {} lost, {} jams; {} records "
      "lost\n",
      l.wakes, l.missed, microseconds(l.shortest), microseconds(l.mean()), microseconds(l.longest), n.bus_offs,
      n.link_losses, n.stale, n.refused, n.overflows, n.jams, telemetry_.lost.load());
}

template class DriveRun<config::AnyNode<float>>;
template class DriveRun<config::WorkNode<float>>;
template class DriveRun<config::MachineNode<float>>;
template class DriveRun<ExperimentNode>;

}  // namespace breakaway::linux_node
