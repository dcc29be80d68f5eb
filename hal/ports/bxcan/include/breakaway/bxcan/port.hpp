// A CanPort on a bxCAN controller (STM32F1, F2, F4; RM0090, chapter 32).
//
// Three parties share it without locks: the loop (CanPort and poll) fills one ring and empties the other, the transmit
// interrupt alone touches the mailboxes, and the receive interrupt alone empties the FIFO. All interrupts have one
// priority. The controller sends in the order of request (TXFP), so that an RPDO leaves before its SYNC.
//
// start() comes once and may wait; poll(now) comes first in every period.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "breakaway/bxcan/registers.hpp"
#include "breakaway/hal/bit_timing.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/shared_ring.hpp"

namespace breakaway::bxcan {

struct Counters {
  std::uint32_t stale = 0;      // frames dropped or aborted at their deadline
  std::uint32_t overflows = 0;  // received frames lost, in the FIFO or because the ring was full
  std::uint32_t bus_offs = 0;
};

template <Registers Controller>
class Port {
 public:
  explicit Port(Controller& controller) noexcept : controller_{&controller} {}

  // Sets the controller up and lets it join the bus. Returns false when it did not enter its initialisation mode, which
  // it does within a bit or two when its clock runs, or did not leave it, for which the bus must be idle for 11 bits.
  // It waits for each for at most `polls` register reads.
  bool start(const hal::BitTiming& timing, std::uint32_t polls) noexcept {
    write(reg::mcr, bit::mcr_inrq | bit::mcr_txfp);
    if (!await_inak(bit::msr_inak, polls)) return false;
    write(reg::btr, btr_value(timing));
    accept_base_frames();
    write(reg::ier, bit::ier_tmeie | bit::ier_fmpie0);
    write(reg::mcr, bit::mcr_txfp);
    return await_inak(0, polls);
  }

  // Drops what is stale, and leads the controller back from bus-off: with nothing left to send it passes through its
  // initialisation mode, as the manual wants it, and joins again after 128 x 11 recessive bits.
  void poll(hal::Time now) noexcept {
    now_ = now;
    shared_now_.store(stamp(now), std::memory_order_relaxed);
    if (!off_bus()) {
      was_off_ = false;
    } else if (!was_off_) {
      was_off_ = true;
      ++bus_offs_;
      purge_transmit_queue();
      write(reg::mcr, bit::mcr_inrq | bit::mcr_txfp);
    } else if ((read(reg::msr) & bit::msr_inak) != 0) {
      write(reg::mcr, bit::mcr_txfp);
    }
    controller_->pend_transmit_interrupt();
  }

  // CanPort; see hal/can_port.hpp for what the calls promise.

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    if (!hal::is_sendable(frame)) return hal::SendResult::not_sendable;
    if (off_bus()) return hal::SendResult::bus_off;
    if (!transmit_.push({frame, stamp(std::min(deadline, now_ + farthest_deadline))}))
      return hal::SendResult::queue_full;
    controller_->pend_transmit_interrupt();
    return hal::SendResult::queued;
  }
  bool receive(hal::ReceivedFrame& received) noexcept { return receive_.pop(received); }
  void purge_transmit_queue() noexcept {
    purge_.store(true, std::memory_order_release);
    controller_->pend_transmit_interrupt();
  }
  hal::BusState bus_state() const noexcept {
    const std::uint32_t errors = read(reg::esr);
    if ((errors & bit::esr_boff) != 0) return hal::BusState::bus_off;
    if ((errors & bit::esr_epvf) != 0) return hal::BusState::error_passive;
    return (errors & bit::esr_ewgf) != 0 ? hal::BusState::error_warning : hal::BusState::error_active;
  }
  Counters counters() const noexcept {
    return {stale_.load(std::memory_order_relaxed), overflows_.load(std::memory_order_relaxed), bus_offs_};
  }

  // Interrupts. They must not interrupt each other.

  // The target calls this when a mailbox became empty or pend_transmit_interrupt() asked for it.
  void on_transmit_interrupt() noexcept {
    constexpr std::uint32_t completed = bit::tsr_rqcp0 | bit::tsr_rqcp0 << 8 | bit::tsr_rqcp0 << 16;
    write(reg::tsr, completed);
    const bool purge = purge_.exchange(false, std::memory_order_acq_rel);
    Outgoing outgoing;
    while (purge && transmit_.pop(outgoing)) {
    }
    for (std::uint32_t m = 0; m < mailboxes; ++m) {
      if (!mailbox_empty(m) && (purge || stale(deadlines_[m]))) abort(m, !purge);
    }
    fill_mailboxes();
  }

  // The target calls this when frames wait in the FIFO. now: when the newest came, as exactly as the target knows.
  void on_receive_interrupt(hal::Time now) noexcept {
    for (int n = 0; n < most_frames && (read(reg::rf0r) & bit::rf0r_fmp0) != 0; ++n) {
      if (const auto frame = read_frame(); frame && !receive_.push({*frame, now})) count(overflows_);
      release_fifo();
    }
    if ((read(reg::rf0r) & bit::rf0r_fovr0) == 0) return;
    write(reg::rf0r, bit::rf0r_fovr0 | bit::rf0r_full0);
    count(overflows_);
  }

 private:
  struct Outgoing {
    hal::CanFrame frame;
    std::uint32_t deadline = 0;
  };
  static constexpr std::uint32_t mailboxes = 3;
  // One interrupt takes in no more: that is more than the FIFO holds, and ends when a broken FIFO never empties.
  static constexpr int most_frames = 16;
  static constexpr hal::Duration farthest_deadline = std::chrono::seconds{1000};

  // Counts time in units of 1024 ns, cut to what an interrupt reads at once. Stamps compare rightly over 36 minutes.
  static constexpr std::uint32_t stamp(hal::Time time) noexcept {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(time.time_since_epoch().count()) >> 10);
  }
  bool stale(std::uint32_t deadline) const noexcept {
    const std::uint32_t late = shared_now_.load(std::memory_order_relaxed) - deadline;
    return late < 0x8000'0000U;
  }

  std::uint32_t read(std::uint32_t offset) const noexcept { return controller_->read(offset); }
  void write(std::uint32_t offset, std::uint32_t value) noexcept { controller_->write(offset, value); }
  static void count(std::atomic<std::uint32_t>& counter) noexcept { counter.fetch_add(1, std::memory_order_relaxed); }

  bool await_inak(std::uint32_t wanted, std::uint32_t polls) const noexcept {
    for (std::uint32_t i = 0; i < polls; ++i) {
      if ((read(reg::msr) & bit::msr_inak) == wanted) return true;
    }
    return false;
  }
  bool off_bus() const noexcept { return (read(reg::esr) & bit::esr_boff) != 0; }

  // Filter bank 0 passes every frame with an 11-bit identifier to FIFO 0.
  void accept_base_frames() noexcept {
    constexpr std::uint32_t bank0 = 1, ide = 1U << 2;
    write(reg::fmr, read(reg::fmr) | bit::fmr_finit);
    write(reg::fa1r, read(reg::fa1r) & ~bank0);
    write(reg::fm1r, read(reg::fm1r) & ~bank0);  // the bank holds an identifier and a mask
    write(reg::fs1r, read(reg::fs1r) | bank0);   // of 32 bits each
    write(reg::ffa1r, read(reg::ffa1r) & ~bank0);
    write(reg::f0r1, 0);
    write(reg::f0r1 + 4, ide);
    write(reg::fa1r, read(reg::fa1r) | bank0);
    write(reg::fmr, read(reg::fmr) & ~bit::fmr_finit);
  }

  bool mailbox_empty(std::uint32_t m) const noexcept { return (read(reg::tsr) & bit::tsr_tme0 << m) != 0; }

  // Asks for the mailbox back. The controller finishes a frame that is on the wire already.
  void abort(std::uint32_t m, bool because_stale) noexcept {
    if (because_stale && !aborted_[m]) count(stale_);
    aborted_[m] = true;
    write(reg::tsr, bit::tsr_abrq0 << (8 * m));
  }

  void fill_mailboxes() noexcept {
    Outgoing outgoing;
    for (std::uint32_t m = 0; m < mailboxes && !off_bus(); ++m) {
      if (!mailbox_empty(m)) continue;
      do {
        if (!transmit_.pop(outgoing)) return;
        if (stale(outgoing.deadline)) count(stale_);
      } while (stale(outgoing.deadline));
      fill(m, outgoing);
    }
  }

  void fill(std::uint32_t m, const Outgoing& outgoing) noexcept {
    const std::uint32_t base = reg::mailbox + reg::mailbox_stride * m;
    const hal::CanFrame& frame = outgoing.frame;
    deadlines_[m] = outgoing.deadline;
    aborted_[m] = false;
    write(base + 0x4, frame.size);
    write(base + 0x8, word(frame, 0));
    write(base + 0xC, word(frame, 4));
    write(base, static_cast<std::uint32_t>(frame.id) << 21 | (frame.remote ? bit::rir_rtr : 0U) | bit::tir_txrq);
  }

  static std::uint32_t word(const hal::CanFrame& frame, std::size_t first) noexcept {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | frame.data[first + i];
    return value;
  }

  std::optional<hal::CanFrame> read_frame() const noexcept {
    const std::uint32_t header = read(reg::fifo0), length = read(reg::fifo0 + 4) & 0xFU;
    if ((header & bit::rir_ide) != 0) return {};
    hal::CanFrame frame{.id = static_cast<std::uint16_t>(header >> 21),
                        .size = static_cast<std::uint8_t>(length > 8 ? 8 : length),
                        .remote = (header & bit::rir_rtr) != 0,
                        .data = {}};
    for (std::size_t i = 0; i < frame.size && !frame.remote; ++i)
      frame.data[i] = static_cast<std::uint8_t>(read(reg::fifo0 + (i < 4 ? 0x8 : 0xC)) >> (8 * (i % 4)));
    return frame;
  }

  // The next frame shows a few bus cycles after the release, when the hardware takes the request back.
  void release_fifo() noexcept {
    constexpr int polls = 16;
    write(reg::rf0r, bit::rf0r_rfom0);
    for (int i = 0; i < polls && (read(reg::rf0r) & bit::rf0r_rfom0) != 0; ++i) {
    }
  }

  Controller* controller_;
  hal::SharedRing<Outgoing, 16> transmit_;
  hal::SharedRing<hal::ReceivedFrame, 32> receive_;
  std::atomic<std::uint32_t> shared_now_{0}, stale_{0}, overflows_{0};
  std::atomic<bool> purge_{false};
  std::array<std::uint32_t, mailboxes> deadlines_{};  // this and aborted_ are the transmit interrupt's own
  std::array<bool, mailboxes> aborted_{};
  hal::Time now_{};
  std::uint32_t bus_offs_ = 0;
  bool was_off_ = false;
};

}  // namespace breakaway::bxcan
