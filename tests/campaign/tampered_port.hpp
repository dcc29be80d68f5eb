// A CanPort whose frames are lost, late, doubled, out of order, exchanged or spoiled between the controller and the
// bus, in either direction, and whose clock may jump.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <utility>

#include "../realtime_guard.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::campaign {

// What happens to the frames of one direction. Shares are of the frames that `concerns` picks, 0 to 1.
struct Tampering {
  std::function<bool(const hal::CanFrame&)> concerns = [](const hal::CanFrame&) { return true; };
  double lost = 0, doubled = 0, spoiled = 0;
  double late = 0;          // share that comes late
  int late_by_periods = 1;  // up to
  bool swapped = false;     // each pair the wrong way round
  bool shuffled = false;    // those of a period in any order
  // Has a frame say something else.
  std::function<void(hal::CanFrame&)> lie{};
};

template <hal::CanPort Port>
class TamperedPort {
 public:
  TamperedPort(Port& port, std::uint64_t seed) : port_{&port}, random_{seed} {}

  Tampering incoming, outgoing;
  hal::Duration clock_ahead{};  // of the controller's clock before the world's

  // To be called once before each step of the controller.
  void begin_period(hal::Time now) {
    now_ = now;
    for (std::deque<Delayed> due = take_due(outgoing_late_); !due.empty(); due.pop_front())
      static_cast<void>(port_->send(due.front().received.frame, now + std::chrono::milliseconds{1}));
    for (const Delayed& delayed : take_due(incoming_late_)) inbox_.push_back(delayed.received);
    const auto first_new = static_cast<std::ptrdiff_t>(inbox_.size());
    for (hal::ReceivedFrame received; port_->receive(received);) take_in(received);
    if (incoming.shuffled) std::shuffle(inbox_.begin() + first_new, inbox_.end(), random_);
  }

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    const testing::RealtimePause not_the_step;
    hal::CanFrame sent = frame;
    const bool concerned = outgoing.concerns(sent);
    if (concerned && happens(outgoing.lost)) return hal::SendResult::queued;
    if (concerned && happens(outgoing.spoiled)) spoil(sent);
    if (concerned && happens(outgoing.late)) {
      outgoing_late_.push_back({{sent, {}}, lateness(outgoing)});
      return hal::SendResult::queued;
    }
    if (concerned && happens(outgoing.doubled)) static_cast<void>(port_->send(sent, deadline - clock_ahead));
    return port_->send(sent, deadline - clock_ahead);
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    const testing::RealtimePause not_the_step;
    if (inbox_.empty()) return false;
    received = inbox_.front();
    received.time += clock_ahead;
    inbox_.pop_front();
    return true;
  }
  void purge_transmit_queue() noexcept { port_->purge_transmit_queue(); }
  hal::BusState bus_state() const noexcept { return port_->bus_state(); }

 private:
  struct Delayed {
    hal::ReceivedFrame received;
    int periods;
  };

  bool happens(double share) { return share > 0 && std::uniform_real_distribution<>{0, 1}(random_) < share; }
  int lateness(const Tampering& t) { return std::uniform_int_distribution<>{1, t.late_by_periods}(random_); }

  // A gateway's error: the bus' own would be found by its checksum.
  void spoil(hal::CanFrame& frame) {
    if (frame.size == 0) return;
    const auto byte = std::uniform_int_distribution<std::size_t>{0, frame.size - 1U}(random_);
    frame.data[byte] = static_cast<std::uint8_t>(frame.data[byte] ^ (1U << (random_() % 8)));
  }

  void take_in(hal::ReceivedFrame received) {
    const bool concerned = incoming.concerns(received.frame);
    if (!concerned) return inbox_.push_back(received);
    if (happens(incoming.lost)) return;
    if (happens(incoming.spoiled)) spoil(received.frame);
    if (incoming.lie) incoming.lie(received.frame);
    if (happens(incoming.late)) return incoming_late_.push_back({received, lateness(incoming)});
    if (incoming.swapped && !kept_back_) {
      kept_back_ = received;
      return;
    }
    inbox_.push_back(received);
    if (happens(incoming.doubled)) inbox_.push_back(received);
    if (const auto earlier = std::exchange(kept_back_, std::nullopt)) inbox_.push_back(*earlier);
  }

  static std::deque<Delayed> take_due(std::deque<Delayed>& late) {
    std::deque<Delayed> due, rest;
    for (Delayed& delayed : late) {
      --delayed.periods;
      (delayed.periods <= 0 ? due : rest).push_back(delayed);
    }
    late = std::move(rest);
    return due;
  }

  Port* port_;
  std::mt19937_64 random_;
  hal::Time now_{};
  std::deque<hal::ReceivedFrame> inbox_;
  std::deque<Delayed> incoming_late_, outgoing_late_;
  std::optional<hal::ReceivedFrame> kept_back_;
};

}  // namespace breakaway::campaign
