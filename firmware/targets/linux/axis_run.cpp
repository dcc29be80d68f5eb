#include "axis_run.hpp"

#include <fmt/format.h>

#include <array>
#include <bitset>
#include <chrono>
#include <cmath>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::linux_node {
namespace {

using namespace std::chrono_literals;

double microseconds(hal::Duration duration) { return std::chrono::duration<double, std::micro>(duration).count(); }

std::string object_text(canopen::ObjectAddress object) {
  return fmt::format("{:04X}h:{:02X}", object.index, object.subindex);
}

// How the set-up stands, with the remedy and, where one is concerned, the object.
std::string setup_text(const cia402::Drive<float>& drive) {
  const cia402::SetupStatus status = drive.setup_status();
  const canopen::ObjectAddress object = drive.setup_object();
  if (status == cia402::SetupStatus::object_refused)
    return fmt::format("{} ({}, {})", to_string(status), object_text(object),
                       canopen::to_string(drive.setup_abort_code()));
  const bool names_object =
      object.index != 0 && (status == cia402::SetupStatus::in_progress || status == cia402::SetupStatus::no_answer ||
                            status == cia402::SetupStatus::protocol_error);
  return names_object ? fmt::format("{} ({})", to_string(status), object_text(object)) : std::string{to_string(status)};
}

}  // namespace

AxisRun::AxisRun(const Configuration& configuration, const Options& options, socketcan::KernelSocket& socket,
                 Telemetry& telemetry)
    : c_{configuration},
      options_{options},
      telemetry_{telemetry},
      socket_port_{socket},
      port_{socket_port_, telemetry},
      loop_{port_, configuration.loop},
      ticker_{configuration.loop.period} {
  const law::AxisController<float> controller{c_.axis.parameters, c_.axis.k3_table};
  const auto added = loop_.add_axis(cia402::Drive<float>{c_.drive, c_.loop, c_.scale()}, controller, c_.limits,
                                    c_.scale().encoder_resolution_m);
  if (added != firmware::AddAxis::added) throw InputError{std::string{to_string(added)}};
  loop_.set_target_counts(0, c_.visits.front().counts);
  loop_.request_enable(0);
}

ExitCode AxisRun::run() {
  ticker_ = Ticker{c_.loop.period};
  set_up();
  move();
  reached_ = rests_on_target();
  last_fault_ = status().fault;
  confirmed_ = stop_and_confirm();
  release_drive();
  const bool good = confirmed_ && last_fault_ == firmware::AxisFault::none && (reached_ || telemetry_.stop);
  return good ? done : failed;
}

void AxisRun::step() {
  now_ = ticker_.wait();
  socket_port_.poll(now_);
  port_.set_time(now_);
  // A reset is for the fault that the operator sees; on a bus that is off it would come too early.
  if (telemetry_.reset.exchange(false) && port_.bus_state() != hal::BusState::bus_off) loop_.reset_fault(0);
  loop_.step(now_);
  const auto& s = status();
  telemetry_.add(StepRecord{.time = now_,
                            .latency = ticker_.last_latency(),
                            .target_counts = c_.visits[visit_].counts,
                            .position_counts = loop_.drive(0).position_counts(),
                            .command_N = s.output.force_N,
                            .reported_N = s.feedback.force_N,
                            .mode = s.output.mode,
                            .drive = s.feedback.state,
                            .fault = s.fault,
                            .fault_code = loop_.supervisor(0).fault_code(),
                            .link_lost = socket_port_.link_lost()});
}

void AxisRun::set_up() {
  const hal::Time begin = ticker_.wait();
  constexpr hal::Duration longest = 20s;  // the mode alone may take ten
  const hal::Duration patience{std::llround(options_.patience_s * 1e9)};
  while (!telemetry_.stop) {
    step();
    heard_ = heard_ || loop_.drive(0).nmt_state().has_value();
    const hal::DriveState state = status().feedback.state;
    if (state == hal::DriveState::unusable) refuse_unusable_drive();
    if (state != hal::DriveState::configuring) break;
    if (!heard_ && now_ - begin > patience) refuse_silent_drive();
    if (now_ - begin > longest) {
      throw InputError{fmt::format("drive {} on {}: the set-up stands still; check the wiring: {}", c_.drive.node_id,
                                   options_.interface, setup_text(loop_.drive(0)))};
    }
  }
  if (options_.reset && status().feedback.state == hal::DriveState::fault) loop_.reset_fault(0);
}

void AxisRun::refuse_unusable_drive() const {
  throw InputError{fmt::format("drive {} on {}: {}", c_.drive.node_id, options_.interface, setup_text(loop_.drive(0)))};
}

void AxisRun::refuse_silent_drive() {
  const std::string alive = nodes_on_bus();
  throw InputError{fmt::format(
      "{}: no drive answers as node {}; {}", options_.interface, c_.drive.node_id,
      alive.empty() ? "nor does any other node: check power, wiring, termination and bit rate"
                    : fmt::format("these nodes do: {}; choose one by --node-id or [drive] node_id", alive))};
}

// Reads the device type of every other node, which moves nothing.
std::string AxisRun::nodes_on_bus() {
  std::bitset<128> alive;
  hal::ReceivedFrame received;
  for (unsigned tick = 1; tick < 250; ++tick) {
    now_ = ticker_.wait();
    socket_port_.poll(now_);
    port_.set_time(now_);
    while (port_.receive(received)) {
      const std::uint16_t function = canopen::function_code_of(received.frame.id);
      if (function == canopen::sdo_response_function_code || function == canopen::heartbeat_function_code)
        alive.set(canopen::node_id_of(received.frame.id));
    }
    if (tick > canopen::max_node_id) continue;
    const hal::CanFrame question{
        .id = canopen::sdo_request_cob_id(static_cast<std::uint8_t>(tick)), .size = 8, .data = {0x40, 0x00, 0x10}};
    static_cast<void>(port_.send(question, now_ + c_.loop.period));
  }
  std::string text;
  for (std::size_t node = 1; node < alive.size(); ++node)
    if (alive.test(node) && node != c_.loop.node_id) text += fmt::format("{}{}", text.empty() ? "" : ", ", node);
  return text;
}

void AxisRun::move() {
  const hal::Time begin = now_;
  const hal::Duration duration{std::llround(options_.duration_s * 1e9)};
  while (!telemetry_.stop && (duration == hal::Duration::zero() || now_ - begin < duration)) {
    step();
    if (status().feedback.state == hal::DriveState::unusable) return;  // it came back as another drive
    if (!status().running) continue;
    if (!enabled_since_) enabled_since_ = now_;
    follow_visits(hal::seconds(now_ - *enabled_since_));
  }
}

void AxisRun::follow_visits(double moving_s) {
  if (!rests_on_target()) {
    resting_since_.reset();
  } else if (!resting_since_) {
    resting_since_ = now_;
  }
  if (visit_ + 1 == c_.visits.size()) return;
  const bool next = c_.timed ? moving_s >= c_.visits[visit_ + 1].after_s
                             : resting_since_ && hal::seconds(now_ - *resting_since_) >= options_.dwell_s;
  if (!next) return;
  loop_.set_target_counts(0, c_.visits[++visit_].counts);
  resting_since_.reset();
}

bool AxisRun::rests_on_target() const {
  const auto& s = status();
  const double error_m = static_cast<double>(s.feedback.position_offset_m);
  // Half a count for the decimal tolerance in float.
  const double margin_m = 0.5 * static_cast<double>(c_.scale().encoder_resolution_m);
  return s.running && s.output.mode == law::Mode::hold && std::abs(error_m) <= c_.tolerance_m + margin_m;
}

// Quick stop, then disabled, seen in the drive's own statusword.
bool AxisRun::stop_and_confirm() {
  constexpr hal::Duration patience = 1500ms;  // a drive may take a second for its quick stop
  loop_.request_stop(0);
  for (const hal::Time begin = now_; now_ - begin < patience;) {
    step();
    const auto& feedback = status().feedback;
    const bool holds_force = feedback.state == hal::DriveState::enabled ||
                             feedback.state == hal::DriveState::enabling || feedback.state == hal::DriveState::stopping;
    const bool told =
        feedback.state == hal::DriveState::configuring || now_ - feedback.sample_time < 3 * c_.loop.period;
    if (!holds_force && told && port_.bus_state() != hal::BusState::bus_off) return true;
  }
  return false;
}

// The drive shall not take the end of our heartbeats for a failure.
void AxisRun::release_drive() {
  if (!heard_) return;
  canopen::SdoClient sdo{c_.drive.node_id, c_.drive.sdo_timeout};
  constexpr std::array<std::uint8_t, 4> none{};
  const hal::CanFrame command = canopen::nmt_frame(canopen::NmtCommand::enter_pre_operational, c_.drive.node_id);
  bool left = port_.send(command, now_ + c_.loop.period) != hal::SendResult::queued ||
              sdo.start_write(cia402::object::consumer_heartbeat, 1, none) != canopen::SdoStart::started;
  for (const hal::Time begin = now_; !left && now_ - begin < 200ms;) {
    now_ = ticker_.wait();
    socket_port_.poll(now_);
    port_.set_time(now_);
    for (hal::ReceivedFrame received; port_.receive(received);) sdo.on_frame(received.frame);
    left = sdo.poll(now_) != canopen::SdoResult::busy;
    hal::CanFrame frame;
    if (!left && sdo.next_frame(frame, now_)) static_cast<void>(port_.send(frame, now_ + c_.loop.period));
  }
}

std::string AxisRun::report() const {
  const Latency& l = ticker_.latency();
  const socketcan::Counters n = socket_port_.counters();
  const double error_m = static_cast<double>(status().feedback.position_offset_m);
  return fmt::format(
      "axis        {}{}, {:+.3g} m from its target\n"
      "timing      {} ticks, {} missed, wake-up latency {:.1f} / {:.1f} / {:.1f} us (min / mean / max)\n"
      "bus         {} bus-off, {} link losses, {} frames stale, {} refused, {} lost, {} jams; {} records lost\n",
      confirmed_ ? "stopped" : "NOT CONFIRMED as stopped: the drive takes its torque off at its own deadline",
      last_fault_ == firmware::AxisFault::none ? std::string{} : fmt::format(", fault: {}", to_string(last_fault_)),
      error_m, l.wakes, l.missed, microseconds(l.shortest), microseconds(l.mean()), microseconds(l.longest), n.bus_offs,
      n.link_losses, n.stale, n.refused, n.overflows, n.jams, telemetry_.lost.load());
}

}  // namespace breakaway::linux_node
