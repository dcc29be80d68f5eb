// A bxCAN controller by its registers, written from the reference manual (RM0090, 32.4 to 32.9), with a bus that the
// test plays: it decides when a frame is sent, comes in, or goes wrong. Refuses, by failing the test, what the manual
// forbids.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <map>
#include <vector>

namespace breakaway::bxcan_test {

struct RawFrame {
  std::uint32_t id = 0;
  bool extended = false, remote = false;
  std::uint32_t length = 0;
  std::array<std::uint8_t, 8> data{};
  friend bool operator==(const RawFrame&, const RawFrame&) = default;
};

class ControllerModel {
 public:
  bool stuck = false;  // does not acknowledge a change of mode: no clock, or no idle bus
  std::function<void()> transmit_interrupt;
  int pended = 0;
  bool filters_fail = false;   // every frame passes
  bool frame_on_wire = false;  // the oldest request cannot be aborted any more

  // Registers

  std::uint32_t read(std::uint32_t offset) noexcept {
    EXPECT_EQ(offset % 4, 0U) << "registers are words";
    if (offset == 0x04) return initialising_ ? 0xC01U : 0xC00U;
    if (offset == 0x08) return transmit_status();
    if (offset == 0x0C) return pass_release(), fifo_status();
    if (offset == 0x18) return errors_;
    if (offset >= 0x1B0 && offset < 0x1C0) return fifo_word((offset - 0x1B0) / 4);
    return values_[offset];
  }

  void write(std::uint32_t offset, std::uint32_t value) noexcept {
    EXPECT_EQ(offset % 4, 0U) << "registers are words";
    switch (offset) {
      case 0x00:
        return write_mode(value);
      case 0x08:
        return write_transmit_status(value);
      case 0x0C:
        if ((value & 1U << 5) != 0 && !fifo_.empty()) releasing_ = 3;
        if ((value & 1U << 4) != 0) overrun_ = false;
        return;
      case 0x1C:
        EXPECT_TRUE(initialising_) << "BTR is writable in initialisation mode only";
        break;
      case 0x204:
      case 0x20C:
      case 0x214:
        EXPECT_EQ(values_[0x200] & 1U, 1U) << "filters change in filter initialisation mode only";
        break;
      case 0x240:
      case 0x244:
        EXPECT_TRUE((values_[0x200] & 1U) == 1U || (values_[0x21C] & 1U) == 0U) << "the bank is active";
        break;
      default:
        break;
    }
    EXPECT_FALSE(offset >= 0x1B0 && offset < 0x1D0) << "the receive FIFOs are read only";
    values_[offset] = value;
    for (std::uint32_t m = 0; m < 3; ++m) {
      if (offset == 0x180 + 0x10 * m && (value & 1U) != 0) request(m);
    }
  }

  void pend_transmit_interrupt() noexcept {
    ++pended;
    if (transmit_interrupt) transmit_interrupt();
  }

  // The bus

  // The controller sends its next frame, in the order of request with TXFP, else by identifier.
  RawFrame send_one() {
    EXPECT_FALSE(requested_.empty());
    EXPECT_FALSE(initialising_);
    EXPECT_EQ(errors_ & 4U, 0U) << "nothing leaves a controller that is off the bus";
    auto next = requested_.begin();
    if ((values_[0x00] & 4U) == 0)
      for (auto m = requested_.begin(); m != requested_.end(); ++m)
        if (values_[0x180 + 0x10 * *m] >> 21 < values_[0x180 + 0x10 * *next] >> 21) next = m;
    const std::uint32_t m = *next;
    requested_.erase(next);
    completed_ |= 0x3U << (8 * m);
    const RawFrame frame = mailbox(m);
    if ((values_[0x14] & 1U) != 0 && transmit_interrupt) transmit_interrupt();
    return frame;
  }
  std::size_t requests() const { return requested_.size(); }
  // The transmit interrupt would come again at once.
  bool completion_pending() const { return (completed_ & 0x010101U) != 0; }

  // A frame on the bus. True: it passed the filter and found room in the FIFO.
  bool receive(const RawFrame& frame) {
    if (initialising_ || !(filters_fail || passes_filter(frame))) return false;
    if (fifo_.size() == 3) {
      overrun_ = true;
      fifo_.back() = frame;  // RFLM = 0: the newest overwrites the last
      return false;
    }
    fifo_.push_back(frame);
    return true;
  }
  bool receive_interrupt_pending() const { return !fifo_.empty() && (values_.at(0x14) & 2U) != 0; }

  void set_errors(std::uint32_t flags) { errors_ = flags; }
  bool initialising() const { return initialising_; }
  // 128 x 11 recessive bits went by. Only a controller that was led through its initialisation mode joins again.
  void recover() {
    if (led_through_initialisation_ && !initialising_) errors_ = 0;
    led_through_initialisation_ = false;
  }

 private:
  void write_mode(std::uint32_t value) {
    values_[0x00] = value;
    if (stuck) return;
    const bool was = initialising_;
    initialising_ = (value & 1U) != 0;
    if (was && !initialising_ && (errors_ & 4U) != 0) led_through_initialisation_ = true;
  }
  std::uint32_t transmit_status() const {
    std::uint32_t status = completed_;
    for (std::uint32_t m = 0; m < 3; ++m) {
      if (std::find(requested_.begin(), requested_.end(), m) == requested_.end()) status |= 1U << (26 + m);
    }
    if (requested_.size() > 1) status |= 1U << (29 + requested_.back());  // LOW: the last of those that wait
    return status;
  }
  void write_transmit_status(std::uint32_t value) {
    for (std::uint32_t m = 0; m < 3; ++m) {
      if ((value >> (8 * m) & 1U) != 0) completed_ &= ~(0xFU << (8 * m));
      const bool leaves = frame_on_wire && !requested_.empty() && requested_.front() == m;
      if ((value >> (8 * m) & 0x80U) != 0 && !leaves) std::erase(requested_, m);
    }
  }
  void request(std::uint32_t m) {
    EXPECT_EQ(std::count(requested_.begin(), requested_.end(), m), 0) << "mailbox " << m << " was not empty";
    requested_.push_back(m);
  }
  RawFrame mailbox(std::uint32_t m) {
    const std::uint32_t base = 0x180 + 0x10 * m, header = values_[base];
    RawFrame frame{header >> 21, (header & 4U) != 0, (header & 2U) != 0, values_[base + 4] & 0xFU, {}};
    for (std::uint32_t i = 0; i < frame.length && !frame.remote; ++i)
      frame.data[i] = static_cast<std::uint8_t>(values_[base + (i < 4 ? 8 : 12)] >> (8 * (i % 4)));
    return frame;
  }
  std::uint32_t fifo_status() const {
    return static_cast<std::uint32_t>(fifo_.size()) | (fifo_.size() == 3 ? 8U : 0U) | (overrun_ ? 16U : 0U) |
           (releasing_ > 0 ? 32U : 0U);
  }
  // A release takes a few cycles, in which the old frame still shows.
  void pass_release() {
    if (releasing_ > 0 && --releasing_ == 0) fifo_.pop_front();
  }
  std::uint32_t fifo_word(std::uint32_t word) const {
    if (fifo_.empty()) return 0xDEADBEE0;
    const RawFrame& f = fifo_.front();
    // Bit 0 is reserved, and a time stamp and the number of the filter stand above the length.
    if (word == 0) return (f.extended ? f.id << 3 | 4U : f.id << 21) | (f.remote ? 2U : 0U) | 1U;
    if (word == 1) return f.length | 0xABCD'0100U;
    std::uint32_t value = 0;
    for (std::uint32_t i = 4; i-- > 0;) value = value << 8 | f.data[4 * (word - 2) + i];
    return value;
  }
  bool passes_filter(const RawFrame& f) {
    if ((values_[0x200] & 1U) != 0 || (values_[0x21C] & 1U) == 0) return false;
    EXPECT_EQ(values_[0x204] & 1U, 0U);
    EXPECT_EQ(values_[0x20C] & 1U, 1U);
    const std::uint32_t bits = (f.extended ? f.id << 3 | 4U : f.id << 21) | (f.remote ? 2U : 0U);
    return ((bits ^ values_[0x240]) & values_[0x244]) == 0;
  }

  std::map<std::uint32_t, std::uint32_t> values_{{0x00, 0x00010002}, {0x14, 0}, {0x200, 0x2A1C0E01}};
  std::vector<std::uint32_t> requested_;  // mailboxes, in order of request
  std::deque<RawFrame> fifo_;
  std::uint32_t completed_ = 0, errors_ = 0;
  int releasing_ = 0;  // reads until the release of the FIFO's first frame is done
  bool initialising_ = false, overrun_ = false, led_through_initialisation_ = false;
};

}  // namespace breakaway::bxcan_test
