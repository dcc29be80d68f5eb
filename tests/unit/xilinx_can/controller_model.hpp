// The CAN controller of Zynq UltraScale+ by its registers, written from the manual (UG1085, chapter 20; UG1087), with a
// bus that the test plays: it decides when a frame is sent, comes in, or goes wrong. Refuses, by failing the test, what
// the manual forbids.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <map>
#include <utility>

namespace breakaway::xilinx_can_test {

struct RawFrame {
  std::uint32_t id = 0;
  bool extended = false, remote = false;
  std::uint32_t length = 0;
  std::array<std::uint8_t, 8> data{};
  friend bool operator==(const RawFrame&, const RawFrame&) = default;
};

class ControllerModel {
 public:
  static constexpr std::size_t fifo_frames = 64;

  bool no_clock = false, no_idle_bus = false;
  bool shows_fullness = true, latches_fullness = true;  // SR.TXFLL works, and ISR.TXFLL
  bool instant = false;  // as emulators have it: frames need no time on the bus, and TXFEMP holds while it is empty
  bool filters_fail = false;  // every frame passes
  int resets = 0;

  // Registers

  std::uint32_t read(std::uint32_t offset) noexcept {
    EXPECT_EQ(offset % 4, 0U) << "registers are words";
    switch (offset) {
      case 0x18:
        return status();
      case 0x1C:
        return events_ | arblst;
      case 0x50:
        return take_received();
      case 0x54:
      case 0x58:
      case 0x5C:
        --words_to_read_;
        return received_words_[(offset - 0x50) / 4];
      default:
        return values_[offset];
    }
  }

  void write(std::uint32_t offset, std::uint32_t value) noexcept {
    EXPECT_EQ(offset % 4, 0U) << "registers are words";
    switch (offset) {
      case 0x00:
        return write_reset(value);
      case 0x04:
      case 0x08:
      case 0x0C:
        EXPECT_TRUE(configuring()) << "mode and bit timing are writable in configuration mode only";
        break;
      case 0x24:
        events_ &= ~value;
        if (!receive_.empty()) events_ |= rxnemp;
        if (instant && transmit_.empty()) events_ |= txfemp;
        return;
      case 0x30:
      case 0x34:
      case 0x38:
      case 0x3C:
        return write_transmit_word((offset - 0x30) / 4, value);
      default:
        if (offset >= 0x64 && offset < 0x84) {
          EXPECT_EQ(values_[0x60] >> ((offset - 0x64) / 8) & 1U, 0U) << "a filter in use may not change";
        }
        break;
    }
    values_[offset] = value;
  }

  // The bus

  // The controller sends its oldest frame, and another node acknowledges it.
  RawFrame send_one() {
    EXPECT_FALSE(transmit_.empty());
    EXPECT_TRUE(on_bus()) << "nothing leaves a controller that is off the bus";
    const RawFrame frame = transmit_.front();
    transmit_.pop_front();
    transmit_errors_ = transmit_errors_ > 0 ? transmit_errors_ - 1 : 0;
    events_ |= txok | (transmit_.empty() ? txfemp : 0U);
    return frame;
  }
  // Nobody acknowledges the oldest frame: it stays, and is tried again. An error-passive node counts no more (ISO
  // 11898-1, 12.1.4.2, exception 1).
  void fail_to_send() {
    EXPECT_FALSE(transmit_.empty());
    if (transmit_errors_ < 128) transmit_errors_ += 8;
    events_ |= error;
  }
  // A bit error in the oldest frame.
  void disturb_sending() {
    EXPECT_TRUE(on_bus());
    transmit_errors_ += 8;
    events_ |= error;
    if (transmit_errors_ >= 256) {
      bus_off_ = true;
      events_ |= bsoff;
    }
  }
  // 128 x 11 recessive bits went by: the controller comes back by itself, with what is in its FIFO.
  void recover_by_itself() {
    if (!configuring()) bus_off_ = false, transmit_errors_ = 0;
  }

  // A frame on the bus. True: it passed a filter and found room in the FIFO.
  bool receive(const RawFrame& frame) {
    if (!on_bus() || !(filters_fail || passes_filters(frame))) return false;
    if (receive_.size() == fifo_frames) {
      events_ |= rxoflw;
      return false;
    }
    receive_.push_back(frame);
    events_ |= rxok | rxnemp;
    return true;
  }

  std::size_t waiting() const { return transmit_.size(); }
  bool configuring() const { return (values_.at(0x00) & 2U) == 0; }
  bool underflowed() const { return (events_ & rxuflw) != 0; }

 private:
  // On a busy bus the arbitration is lost all the time.
  static constexpr std::uint32_t arblst = 1U << 0;
  static constexpr std::uint32_t txok = 1U << 1, txfll = 1U << 2, rxok = 1U << 4, rxuflw = 1U << 5, rxoflw = 1U << 6,
                                 rxnemp = 1U << 7, error = 1U << 8, bsoff = 1U << 9, txfemp = 1U << 14;

  bool on_bus() const { return !configuring() && !bus_off_; }

  std::uint32_t status() const {
    if (no_clock) return 0;
    std::uint32_t value = configuring() || no_idle_bus ? 1U : 1U << 3;
    if (transmit_errors_ >= 96) value |= 1U << 6;
    if (!configuring()) value |= (bus_off_ ? 0b10U : transmit_errors_ >= 128 ? 0b11U : 0b01U) << 7;
    if (shows_fullness && transmit_.size() == fifo_frames) value |= 1U << 10;
    return value;
  }

  void write_reset(std::uint32_t value) {
    if ((value & 1U) != 0) {
      ++resets;
      values_ = {{0x00, 0}, {0x60, 0}};
      transmit_.clear();
      receive_.clear();
      words_written_ = 0;
      events_ = txfemp;
      bus_off_ = false;
    }
    values_[0x00] = value & 2U;
    if (configuring()) transmit_errors_ = 0;
  }
  void write_transmit_word(std::uint32_t word, std::uint32_t value) {
    EXPECT_EQ(word, words_written_) << "the four words in order";
    transmit_words_[word] = value;
    words_written_ = (words_written_ + 1) % 4;
    if (words_written_ != 0) return;
    EXPECT_LT(transmit_.size(), fifo_frames) << "a full FIFO drops the frame";
    if (transmit_.size() == fifo_frames) return;
    transmit_.push_back(decoded(transmit_words_));
    if (transmit_.size() == fifo_frames && latches_fullness) events_ |= txfll;
    if (instant && on_bus()) send_one();
  }
  std::uint32_t take_received() {
    if (receive_.empty()) {
      events_ |= rxuflw;
      return 0xDEADBEEF;
    }
    received_words_ = encoded(receive_.front());
    receive_.pop_front();
    EXPECT_EQ(words_to_read_, 0) << "the frame before was not read to its end";
    words_to_read_ = 3;
    return received_words_[0];
  }

  // The bits of an extended identifier say nothing in a base frame.
  static std::uint32_t identifier(const RawFrame& f) {
    if (f.extended) return f.id >> 18 << 21 | 1U << 20 | 1U << 19 | (f.id & 0x3FFFFU) << 1 | (f.remote ? 1U : 0U);
    return f.id << 21 | (f.remote ? 1U << 20 : 0U) | 0x2'A5A5U;
  }
  static std::array<std::uint32_t, 4> encoded(const RawFrame& f) {
    std::array<std::uint32_t, 4> words{identifier(f), f.length << 28 | 0x1234U, 0, 0};
    for (std::uint32_t i = 0; i < 8; ++i) words[2 + i / 4] |= std::uint32_t{f.data[i]} << (24 - 8 * (i % 4));
    return words;
  }
  static RawFrame decoded(const std::array<std::uint32_t, 4>& words) {
    EXPECT_EQ(words[0] & 0x7'FFFFU, 0U) << "what an extended frame has is zero in a base frame";
    RawFrame frame{words[0] >> 21, (words[0] >> 19 & 1U) != 0, (words[0] >> 20 & 1U) != 0, words[1] >> 28, {}};
    for (std::uint32_t i = 0; i < frame.length && !frame.remote; ++i)
      frame.data[i] = static_cast<std::uint8_t>(words[2 + i / 4] >> (24 - 8 * (i % 4)));
    return frame;
  }
  bool passes_filters(const RawFrame& frame) {
    const std::uint32_t used = values_[0x60];
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t mask = values_[0x64 + 8 * i], id = values_[0x68 + 8 * i];
      if ((used >> i & 1U) != 0 && ((identifier(frame) ^ id) & mask) == 0) return true;
    }
    return used == 0;
  }

  std::map<std::uint32_t, std::uint32_t> values_{{0x00, 0}, {0x60, 0}};
  std::deque<RawFrame> transmit_, receive_;
  std::array<std::uint32_t, 4> transmit_words_{}, received_words_{};
  std::uint32_t words_written_ = 0, events_ = txfemp;
  int words_to_read_ = 0, transmit_errors_ = 0;
  bool bus_off_ = false;
};

}  // namespace breakaway::xilinx_can_test
