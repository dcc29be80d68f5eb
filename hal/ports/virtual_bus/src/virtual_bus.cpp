#include "breakaway/virtual_bus/virtual_bus.hpp"

#include <algorithm>

#include "breakaway/hal/wire_length.hpp"

namespace breakaway::virtual_bus {
namespace {

// The lower value wins. Of two frames with one identifier that is the data frame's: its remote transmission request bit
// is dominant.
unsigned arbitration_field(const hal::CanFrame& frame) noexcept { return frame.id * 2U + (frame.remote ? 1U : 0U); }

}  // namespace

VirtualBus::VirtualBus(const VirtualBusConfig& config)
    : config_{config}, deliveries_{config.in_flight_capacity}, random_state_{config.seed} {}

VirtualBus::Port& VirtualBus::add_port() {
  ports_.push_back(std::make_unique<Port>(*this, config_));
  return *ports_.back();
}

void VirtualBus::set_tap(Tap tap, void* context) noexcept {
  tap_ = tap;
  tap_context_ = context;
}

void VirtualBus::advance_to(hal::Time time) noexcept {
  if (time < now_) return;
  for (;;) {
    const bool idle = !on_wire_ && idle_from_ <= now_;
    if (idle && start_next_frame()) continue;
    const hal::Time event = next_event();
    if (event > time) break;
    now_ = event;
    if (on_wire_ && frame_end_ <= now_) finish_frame();
    deliver_due();
  }
  now_ = time;
}

hal::Time VirtualBus::next_event() const noexcept {
  const bool frames_wait =
      std::any_of(ports_.begin(), ports_.end(), [](const auto& port) { return !port->transmit_.empty(); });
  hal::Time event = hal::Time::max();
  if (on_wire_)
    event = frame_end_;
  else if (frames_wait)
    event = std::max(now_, idle_from_);
  return deliveries_.empty() ? event : std::min(event, deliveries_.front().received.time);
}

bool VirtualBus::start_next_frame() noexcept {
  Port* winner = nullptr;
  for (const auto& port : ports_) {
    port->drop_stale(now_);
    if (port->transmit_.empty()) continue;
    if (winner == nullptr ||
        arbitration_field(port->transmit_.front().frame) < arbitration_field(winner->transmit_.front().frame))
      winner = port.get();
  }
  if (winner == nullptr) return false;

  frame_ = winner->transmit_.front().frame;
  winner->transmit_.pop();
  sender_ = winner;
  const unsigned bits = hal::wire_bits(frame_);
  frame_start_ = now_;
  frame_end_ = now_ + hal::wire_time(bits - hal::intermission_bits, config_.bit_rate);
  idle_from_ = now_ + hal::wire_time(bits, config_.bit_rate);
  on_wire_ = true;
  return true;
}

void VirtualBus::finish_frame() noexcept {
  on_wire_ = false;
  ++counters_.frames;
  counters_.busy_time += idle_from_ - frame_start_;
  if (tap_ != nullptr) tap_(tap_context_, frame_, frame_start_, frame_end_);
  if (random_unit() < config_.loss_probability) {
    ++counters_.lost;
    return;
  }
  last_delivery_ = std::max(last_delivery_, frame_end_ + random_delay());
  if (!deliveries_.push({.received = {.frame = frame_, .time = last_delivery_}, .sender = sender_}))
    ++counters_.overflows;
}

void VirtualBus::deliver_due() noexcept {
  while (!deliveries_.empty() && deliveries_.front().received.time <= now_) {
    const Delivery delivery = deliveries_.front();
    deliveries_.pop();
    for (const auto& port : ports_)
      if (port.get() != delivery.sender) port->deliver(delivery.received);
  }
}

// SplitMix64: small, and the same on every platform, which the standard library's distributions are not.
double VirtualBus::random_unit() noexcept {
  random_state_ += 0x9E3779B97F4A7C15U;
  std::uint64_t bits = random_state_;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBU;
  bits ^= bits >> 31;
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

hal::Duration VirtualBus::random_delay() noexcept {
  const auto span = static_cast<double>((config_.max_delay - config_.min_delay).count());
  if (span <= 0) return config_.min_delay;
  return config_.min_delay + hal::Duration{static_cast<std::int64_t>(random_unit() * span)};
}

VirtualBus::Port::Port(VirtualBus& bus, const VirtualBusConfig& config)
    : bus_{bus}, transmit_{config.transmit_capacity}, receive_{config.receive_capacity} {}

hal::SendResult VirtualBus::Port::send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
  if (!hal::is_sendable(frame)) return hal::SendResult::not_sendable;
  if (state_ == hal::BusState::bus_off) return hal::SendResult::bus_off;
  if (transmit_.push({.frame = frame, .deadline = deadline})) return hal::SendResult::queued;
  ++bus_.counters_.overflows;
  return hal::SendResult::queue_full;
}

bool VirtualBus::Port::receive(hal::ReceivedFrame& received) noexcept {
  if (receive_.empty()) return false;
  received = receive_.front();
  receive_.pop();
  return true;
}

void VirtualBus::Port::set_listener(Listener listener, void* context) noexcept {
  listener_ = listener;
  listener_context_ = context;
}

void VirtualBus::Port::set_bus_state(hal::BusState state) noexcept {
  state_ = state;
  if (state == hal::BusState::bus_off) transmit_.clear();
}

void VirtualBus::Port::drop_stale(hal::Time now) noexcept {
  while (!transmit_.empty() && transmit_.front().deadline < now) {
    transmit_.pop();
    ++bus_.counters_.stale;
  }
}

void VirtualBus::Port::deliver(const hal::ReceivedFrame& received) noexcept {
  if (state_ == hal::BusState::bus_off) return;
  if (listener_ != nullptr)
    listener_(listener_context_, received);
  else if (!receive_.push(received))
    ++bus_.counters_.overflows;
}

}  // namespace breakaway::virtual_bus
