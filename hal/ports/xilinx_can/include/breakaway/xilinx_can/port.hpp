// A CanPort on the CAN controller of Zynq UltraScale+ (UG1085, chapter 20), without interrupts: its FIFOs hold 64
// frames in each direction, more than a full bus brings in 3 ms, and the loop polls more often than that.
//
// The transmit FIFO keeps the order of requests, so that an RPDO leaves before its SYNC. It gives no frame back, and
// keeps its frames through bus-off and configuration mode: the only way to forget a frame is to reset the controller.
// The port therefore resets it when a frame is still there at its deadline, on a purge, and on bus-off; with that the
// error counters begin anew, and a frame on the wire is cut off.
//
// start() comes once and may wait; poll(now) comes first in every period, and in between as often as can be.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "breakaway/hal/bit_timing.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/shared_ring.hpp"
#include "breakaway/xilinx_can/registers.hpp"

namespace breakaway::xilinx_can {

// Passes frames whose 11-bit identifier agrees with `id` in the bits of `mask`, data or remote.
struct Filter {
  std::uint16_t mask = 0;
  std::uint16_t id = 0;
};

struct BusSettings {
  hal::BitTiming timing{};
  std::uint32_t bit_rate = 1'000'000;
  // A frame that passes one of them is received; without any, every frame with an 11-bit identifier is.
  std::array<std::optional<Filter>, filters> accepted{};
};

struct Counters {
  std::uint32_t stale = 0;      // frames dropped at their deadline
  std::uint32_t overflows = 0;  // times that the receive FIFO lost frames
  std::uint32_t bus_offs = 0;
};

template <Registers Controller>
class Port {
 public:
  explicit Port(Controller& controller) noexcept : controller_{&controller} {}

  // Sets the controller up and lets it join the bus; it takes part once it has seen 11 recessive bits. Returns false
  // when it does not enter its configuration mode, as without a clock, or does not leave it, for which the bus must be
  // idle. It waits for each for at most `polls` register reads.
  bool start(const BusSettings& settings, std::uint32_t polls) noexcept {
    settings_ = settings;
    recovering_ = false;
    if (!reset_controller(polls)) return false;
    write(reg::srr, bit::srr_cen);
    return await_config(0, polls);
  }

  // Takes received frames in, with `now` as their time; drops what is stale; leads the controller back from bus-off.
  void poll(hal::Time now) noexcept {
    now_ = now;
    if (recovering_) {
      if (now >= rejoin_) rejoin();
      return;
    }
    take_in();
    const std::uint32_t events = read(reg::isr);
    note_transmitted(events);
    if ((events & bit::isr_bsoff) != 0) {
      begin_recovery();
    } else if (pending_ > 0 && now >= deadline_) {
      stale_ += pending_;
      forget_pending();
    }
  }

  // CanPort; see hal/can_port.hpp for what the calls promise.

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    if (!hal::is_sendable(frame)) return hal::SendResult::not_sendable;
    const std::uint32_t events = read(reg::isr);
    if (recovering_ || (events & bit::isr_bsoff) != 0) return hal::SendResult::bus_off;
    note_transmitted(events);
    // The bit in ISR stays until the FIFO was empty, so a full FIFO is emptied before more is put into it.
    if (((events & bit::isr_txfll) != 0 && pending_ > 0) || (read(reg::sr) & bit::sr_txfll) != 0)
      return hal::SendResult::queue_full;
    load(frame);
    deadline_ = pending_ == 0 ? deadline : std::min(deadline_, deadline);
    ++pending_;
    return hal::SendResult::queued;
  }
  bool receive(hal::ReceivedFrame& received) noexcept { return received_.pop(received); }
  void purge_transmit_queue() noexcept {
    if (recovering_) return;
    note_transmitted(read(reg::isr));
    if (pending_ > 0) forget_pending();
  }
  hal::BusState bus_state() const noexcept {
    if (recovering_ || (read(reg::isr) & bit::isr_bsoff) != 0) return hal::BusState::bus_off;
    const std::uint32_t status = read(reg::sr);
    if ((status & bit::sr_estat) == bit::estat_bus_off) return hal::BusState::bus_off;
    if ((status & bit::sr_estat) == bit::estat_passive) return hal::BusState::error_passive;
    return (status & bit::sr_errwrn) != 0 ? hal::BusState::error_warning : hal::BusState::error_active;
  }
  Counters counters() const noexcept { return {stale_, overflows_, bus_offs_}; }

 private:
  static constexpr std::uint32_t frames_of_fifo = 64;
  static constexpr std::uint32_t reset_polls = 1000;  // a reset is done after a few cycles of the controller's clock
  static constexpr std::int64_t bits_to_rejoin = 128 * 11;  // ISO 11898-1, 12.1.4.4: recovery from bus-off

  std::uint32_t read(std::uint32_t offset) const noexcept { return controller_->read(offset); }
  void write(std::uint32_t offset, std::uint32_t value) noexcept { controller_->write(offset, value); }

  bool await_config(std::uint32_t wanted, std::uint32_t polls) const noexcept {
    for (std::uint32_t i = 0; i < polls; ++i) {
      if ((read(reg::sr) & bit::sr_config) == wanted) return true;
    }
    return false;
  }

  // Leaves the controller in configuration mode, with empty FIFOs and its registers set.
  bool reset_controller(std::uint32_t polls) noexcept {
    write(reg::srr, bit::srr_srst);
    pending_ = 0;
    if (!await_config(bit::sr_config, polls)) return false;
    write(reg::msr, 0);
    write(reg::ier, 0);
    write(reg::brpr, brpr_value(settings_.timing));
    write(reg::btr, btr_value(settings_.timing));
    set_filters();
    write(reg::icr, bit::isr_all);
    return true;
  }

  // A filter may change only while it is not in use. Without one in use the controller would pass extended frames too.
  void set_filters() noexcept {
    constexpr Filter every{};
    std::uint32_t used = 0;
    write(reg::afr, 0);
    for (std::uint32_t i = 0; i < filters; ++i) {
      if (!settings_.accepted[i]) continue;
      set_filter(i, *settings_.accepted[i]);
      used |= 1U << i;
    }
    if (used == 0) set_filter(0, every);
    write(reg::afr, used == 0 ? 1U : used);
  }
  void set_filter(std::uint32_t i, const Filter& filter) noexcept {
    write(reg::afmr1 + i * reg::filter_stride, static_cast<std::uint32_t>(filter.mask) << 21 | bit::id_ide);
    write(reg::afir1 + i * reg::filter_stride, static_cast<std::uint32_t>(filter.id) << 21);
  }

  void begin_recovery() noexcept {
    ++bus_offs_;
    recovering_ = true;
    rejoin_ = now_ + hal::Duration{bits_to_rejoin * 1'000'000'000 / settings_.bit_rate};
    static_cast<void>(reset_controller(reset_polls));
  }
  // A controller that does not even reset is tried again at the next poll, and is off the bus until then.
  void rejoin() noexcept {
    recovering_ = !reset_controller(reset_polls);
    if (!recovering_) write(reg::srr, bit::srr_cen);
  }
  // Frames that came meanwhile are taken in first: the reset would lose them.
  void forget_pending() noexcept {
    take_in();
    rejoin_ = now_;
    rejoin();
  }

  // The bit says that the transmit FIFO was empty since the last frame was put into it: load() clears it.
  void note_transmitted(std::uint32_t events) noexcept {
    if ((events & bit::isr_txfemp) == 0) return;
    pending_ = 0;
    if ((events & bit::isr_txfll) != 0) write(reg::icr, bit::isr_txfll);
  }
  // TXFEMP is cleared after the frame went in, and long before it can have left: the shortest takes 44 bits.
  void load(const hal::CanFrame& frame) noexcept {
    write(reg::tx_fifo, static_cast<std::uint32_t>(frame.id) << 21 | (frame.remote ? bit::id_rtr_of_base : 0U));
    write(reg::tx_fifo + 0x4, static_cast<std::uint32_t>(frame.size) << 28);
    write(reg::tx_fifo + 0x8, word(frame, 0));
    write(reg::tx_fifo + 0xC, word(frame, 4));
    write(reg::icr, bit::isr_txfemp);
  }
  static std::uint32_t word(const hal::CanFrame& frame, std::size_t first) noexcept {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | frame.data[first + i];
    return value;
  }

  void take_in() noexcept {
    for (std::uint32_t n = 0; n < frames_of_fifo && (read(reg::isr) & bit::isr_rxnemp) != 0; ++n) {
      if (const auto frame = read_frame(); frame && !received_.push({*frame, now_})) ++overflows_;
      write(reg::icr, bit::isr_rxnemp);
    }
    if ((read(reg::isr) & bit::isr_rxoflw) == 0) return;
    write(reg::icr, bit::isr_rxoflw);
    ++overflows_;
  }
  // All four words are read, whatever the length: so the manual wants it.
  std::optional<hal::CanFrame> read_frame() noexcept {
    const std::uint32_t header = read(reg::rx_fifo), length = read(reg::rx_fifo + 0x4) >> 28;
    const std::array<std::uint32_t, 2> words{read(reg::rx_fifo + 0x8), read(reg::rx_fifo + 0xC)};
    if ((header & bit::id_ide) != 0) return {};
    hal::CanFrame frame{.id = static_cast<std::uint16_t>(header >> 21),
                        .size = static_cast<std::uint8_t>(std::min<std::uint32_t>(length, 8)),
                        .remote = (header & bit::id_rtr_of_base) != 0,
                        .data = {}};
    for (std::size_t i = 0; i < frame.size && !frame.remote; ++i)
      frame.data[i] = static_cast<std::uint8_t>(words[i / 4] >> (24 - 8 * (i % 4)));
    return frame;
  }

  Controller* controller_;
  BusSettings settings_{};
  hal::SharedRing<hal::ReceivedFrame, frames_of_fifo> received_;
  hal::Time now_{}, deadline_{}, rejoin_{};
  std::uint32_t pending_ = 0;  // frames that may still be in the transmit FIFO; deadline_ is their earliest
  std::uint32_t stale_ = 0, overflows_ = 0, bus_offs_ = 0;
  bool recovering_ = false;
};

}  // namespace breakaway::xilinx_can
