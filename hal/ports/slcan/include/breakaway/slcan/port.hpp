// A CanPort over a serial adapter that speaks slcan.
//
//   each period: poll(now); receive(...); send(...); flush(now)
//
// The port opens the adapter, and opens it again whenever it stopped answering: until then bus_state() is bus_off,
// sends are refused and what waited is forgotten. flush() asks for the status flags once a period, so that an adapter
// which vanished is noticed. All calls are for the loop's thread; none is safe in an interrupt.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "breakaway/hal/can_port.hpp"
#include "breakaway/slcan/codec.hpp"

namespace breakaway::slcan {

// The formatter would tear the requirements and their comments apart.
// clang-format off

// ByteStream: the serial line. Neither call waits for the other end; write() may take as long as its bytes take to leave.
template <class S>
concept ByteStream = requires(S& stream, char& character, std::span<const char> text) {
  // Moves the oldest received byte to `character`; false when there is none.
  { stream.read(character) } noexcept -> std::same_as<bool>;
  // Hands all bytes over and returns true, or none of them and false. Bytes that were handed over leave by themselves
  // within a fraction of a period.
  { stream.write(text) } noexcept -> std::same_as<bool>;
};

// clang-format on

struct Counters {
  std::uint32_t stale = 0;      // frames dropped at their deadline
  std::uint32_t overflows = 0;  // frames that a queue had no room for, here or in the adapter
  std::uint32_t malformed = 0;  // lines that made no sense
  std::uint32_t openings = 0;   // times that the adapter was opened
};

template <ByteStream Stream>
class Port {
 public:
  // The adapter must answer within this time, or it counts as gone. One lost byte must not make it so: in 20 periods of
  // 1 ms it is asked 20 times.
  static constexpr hal::Duration answer_timeout = std::chrono::milliseconds{20};
  // An adapter that was closed has said by then whatever it still had to say.
  static constexpr hal::Duration settle_time = std::chrono::milliseconds{10};

  // The adapter is never opened at a bit rate that bit_rate_digit does not know.
  Port(Stream& stream, std::uint32_t bit_rate) noexcept : stream_{&stream}, rate_digit_{bit_rate_digit(bit_rate)} {}

  // Takes in what came. Frames get the time `now`, because the serial line tells no better.
  void poll(hal::Time now) noexcept {
    char character = 0;
    for (std::size_t i = 0; i < most_characters && stream_->read(character); ++i) {
      if (const auto message = decoder_.take(character)) on_message(*message, now);
    }
    if (state_ == State::closing && now - asked_at_ >= settle_time) ask_rate(now);
    if (awaits_answer() && now - asked_at_ > answer_timeout) give_up();
  }

  // Hands over what waits and is not stale, then asks for the flags; opens an adapter that is closed.
  void flush(hal::Time now) noexcept {
    if (state_ == State::closed && rate_digit_) ask(State::closing, "\r\r\rC\r", now);
    if (state_ != State::open) return;
    for (; !transmit_.empty(); transmit_.pop()) {
      const Queued& next = transmit_.front();
      if (next.deadline < now) {
        ++counters_.stale;
      } else if (!stream_->write(EncodedFrame{next.frame}.text())) {
        break;
      }
    }
    // A line that takes nothing any more goes unanswered as well.
    static_cast<void>(stream_->write(std::span{"F\r", 2}));
    if (awaits_status_) return;
    awaits_status_ = true;
    asked_at_ = now;
  }

  // CanPort; see hal/can_port.hpp for what the calls promise.

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    if (!hal::is_sendable(frame)) return hal::SendResult::not_sendable;
    if (state_ != State::open) return hal::SendResult::bus_off;
    if (transmit_.push({frame, deadline})) return hal::SendResult::queued;
    ++counters_.overflows;
    return hal::SendResult::queue_full;
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (receive_.empty()) return false;
    received = receive_.front();
    receive_.pop();
    return true;
  }
  void purge_transmit_queue() noexcept { transmit_.clear(); }
  hal::BusState bus_state() const noexcept {
    if (state_ != State::open) return hal::BusState::bus_off;
    if ((flags_ & status_flag::error_passive) != 0) return hal::BusState::error_passive;
    if ((flags_ & (status_flag::error_warning | status_flag::bus_error)) != 0) return hal::BusState::error_warning;
    return hal::BusState::error_active;
  }

  bool awaits_answer() const noexcept {
    return state_ == State::rating || state_ == State::opening || (state_ == State::open && awaits_status_);
  }
  const Counters& counters() const noexcept { return counters_; }

 private:
  enum class State : std::uint8_t {
    closed,
    closing,  // C was sent, and what comes is passed over until settle_time is over
    rating,   // S was sent
    opening,  // O was sent
    open,
  };
  struct Queued {
    hal::CanFrame frame;
    hal::Time deadline{};
  };
  template <class Item, std::size_t Capacity>
  class Queue {
   public:
    bool empty() const noexcept { return size_ == 0; }
    bool push(const Item& item) noexcept {
      if (size_ == Capacity) return false;
      items_[(first_ + size_++) % Capacity] = item;
      return true;
    }
    const Item& front() const noexcept { return items_[first_]; }
    void pop() noexcept {
      first_ = (first_ + 1) % Capacity;
      --size_;
    }
    void clear() noexcept { size_ = 0; }

   private:
    std::array<Item, Capacity> items_{};
    std::size_t first_ = 0, size_ = 0;
  };

  // One poll takes in no more. A line of 3 Mbaud brings less in a millisecond; the rest waits in the stream.
  static constexpr std::size_t most_characters = 512;

  void on_message(const Message& message, hal::Time now) noexcept {
    using Kind = Message::Kind;
    if (message.kind == Kind::malformed) ++counters_.malformed;
    switch (state_) {
      case State::closed:
      case State::closing:
        return;
      case State::rating:
        if (message.kind == Kind::done) ask(State::opening, "O\r", now);
        if (message.kind == Kind::refused) give_up();
        return;
      case State::opening:
        if (message.kind == Kind::done) open();
        if (message.kind == Kind::refused) give_up();
        return;
      case State::open:
        break;
    }
    if (message.kind == Kind::refused) ++counters_.overflows;
    if (message.kind == Kind::frame && !receive_.push({message.frame, now})) ++counters_.overflows;
    if (message.kind != Kind::status) return;
    flags_ = message.status;
    awaits_status_ = false;
  }

  void ask_rate(hal::Time now) noexcept {
    const std::array<char, 4> command{'S', *rate_digit_, carriage_return, '\0'};
    ask(State::rating, command.data(), now);
  }

  // A stream that has no room for a command does not move, which the answer's time-out will show.
  void ask(State next, const char* command, hal::Time now) noexcept {
    const std::string_view text{command};
    static_cast<void>(stream_->write({text.data(), text.size()}));
    state_ = next;
    asked_at_ = now;
  }

  void open() noexcept {
    state_ = State::open;
    flags_ = 0;
    awaits_status_ = false;
    ++counters_.openings;
  }

  void give_up() noexcept {
    state_ = State::closed;
    transmit_.clear();
    decoder_.reset();
  }

  Stream* stream_;
  std::optional<char> rate_digit_;
  Decoder decoder_;
  Queue<hal::ReceivedFrame, 32> receive_;
  Queue<Queued, 16> transmit_;
  hal::Time asked_at_{};
  Counters counters_;
  State state_ = State::closed;
  std::uint8_t flags_ = 0;
  bool awaits_status_ = false;
};

}  // namespace breakaway::slcan
