// What of an STM32F405 starts it, by its registers, written from the reference manual (RM0090, chapters 3.5, 7, 19.4
// and 21): clocks, the timer that measures the crystal, the watchdog. Every access takes ten cycles of the core. It
// fails the test where the manual forbids or warns.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>

namespace breakaway::stm32f405_test {

class ChipModel {
 public:
  // What the board and the silicon are.
  double crystal_Hz = 8e6;        // 0: there is none
  double internal_Hz = 16e6;      // as it truly is
  bool crystal_has_edges = true;  // false: it says that it is ready, and is not
  bool pll_locks = true;
  double watchdog_Hz = 32e3;

  // What was seen.
  bool pll_ran = false;
  bool reset_by_watchdog = false;

  std::uint32_t read(std::uintptr_t address) noexcept {
    pass(10 / core_Hz());
    switch (address) {
      case control:
        return control_ | ready_bits();
      case configuration:
        return (configuration_ & ~0xCU) | used_ << 2;
      case timer_status:
        return (captured_ ? 2U : 0U) | (missed_ ? 0x200U : 0U);
      case timer_capture:
        captured_ = false;
        return capture_;
      case watchdog_status:
        return time_s_ < watchdog_updated_s_ ? 3U : 0U;
      default:
        return values_[address];
    }
  }

  void write(std::uintptr_t address, std::uint32_t value) noexcept {
    pass(10 / core_Hz());
    switch (address) {
      case control:
        return write_control(value);
      case pll:
        EXPECT_EQ(control_ & pll_on, 0U) << "PLLCFGR is written while the PLL is off only";
        break;
      case configuration:
        return write_configuration(value);
      case status:
        if ((value & 1U << 24) != 0) value &= 0x00FF'FFFFU;
        break;
      case timer_base:
        EXPECT_NE(values_[apb2_enable] & 1U << 18, 0U) << "timer 11 has no clock";
        next_capture_s_ = time_s_;
        break;
      case watchdog_key:
        return write_watchdog_key(value);
      case watchdog_prescaler:
      case watchdog_reload:
        EXPECT_TRUE(watchdog_open_) << "0x5555 opens these";
        watchdog_updated_s_ = time_s_ + 5 / watchdog_Hz;
        break;
      default:
        break;
    }
    values_[address] = value;
  }

  // Lets time pass; what waits for it happens.
  void pass(double seconds) noexcept {
    time_s_ += seconds;
    if (crystal_on_s_ >= 0 && crystal_Hz > 0 && time_s_ >= crystal_on_s_ + 2e-3) crystal_ready_ = true;
    count_timer();
    if (watchdog_runs_ && time_s_ >= watchdog_ends_s_) reset_by_watchdog = true;
  }

  double core_Hz() const {
    if (used_ == 0) return internal_Hz;
    return used_ == 1 ? crystal_Hz : pll_Hz() / 2;
  }
  double time_s() const { return time_s_; }
  bool crystal_watched() const { return (control_ & 1U << 19) != 0; }
  bool pll_is_on() const { return (control_ & pll_on) != 0; }
  bool crystal_is_on() const { return (control_ & crystal_on) != 0; }
  std::uint32_t value(std::uintptr_t address) const {
    const auto found = values_.find(address);
    return found == values_.end() ? 0 : found->second;
  }
  // The core runs from the PLL and the crystal, as a bootloader leaves it.
  void run_from_pll() {
    write(control, read(control) | crystal_on | 1U << 18);
    pass(5e-3);
    write(pll, static_cast<std::uint32_t>(crystal_Hz / 1e6) | 168U << 6 | 1U << 22 | 7U << 24);
    write(flash_access, 5);
    write(control, read(control) | pll_on | 1U << 19);
    pass(1e-3);
    write(configuration, 2U | 0b101U << 10 | 1U << 4);
    pll_ran = false;
  }

  static constexpr std::uintptr_t control = 0x40023800, pll = 0x40023804, configuration = 0x40023808,
                                  clock_interrupts = 0x4002380C, apb2_enable = 0x40023844, status = 0x40023874;
  static constexpr std::uintptr_t timer_base = 0x40014800, timer_status = 0x40014810, timer_capture = 0x40014834,
                                  timer_option = 0x40014850;
  static constexpr std::uintptr_t flash_access = 0x40023C00;
  static constexpr std::uintptr_t watchdog_key = 0x40003000, watchdog_prescaler = 0x40003004,
                                  watchdog_reload = 0x40003008, watchdog_status = 0x4000300C;

 private:
  static constexpr std::uint32_t crystal_on = 1U << 16, pll_on = 1U << 24;

  double pll_Hz() const { return crystal_Hz / (value(pll) & 63U) * (value(pll) >> 6 & 511U); }

  std::uint32_t ready_bits() const {
    return 2U | (crystal_ready_ ? 1U << 17 : 0U) | (pll_is_on() && pll_locks ? 1U << 25 : 0U);
  }

  void write_control(std::uint32_t value) {
    // What runs the core stays on.
    if (used_ == 2) value |= pll_on | crystal_on;
    if (used_ == 1) value |= crystal_on;
    if ((control_ & crystal_on) != 0 && (value & crystal_on) != 0) value |= control_ & 1U << 18;
    if ((value & pll_on) != 0 && (control_ & pll_on) == 0) start_pll();
    if ((value & crystal_on) == 0) {
      crystal_on_s_ = -1;
      crystal_ready_ = false;
    } else if (crystal_on_s_ < 0) {
      crystal_on_s_ = time_s_;
    }
    control_ = value & ~(2U | 1U << 17 | 1U << 25);
  }

  void start_pll() {
    pll_ran = true;
    EXPECT_TRUE(crystal_ready_) << "the PLL has no input";
    const double input_Hz = crystal_Hz / (value(pll) & 63U);
    EXPECT_TRUE(input_Hz > 0.83e6 && input_Hz < 2.1e6) << input_Hz << " Hz into the PLL";
    EXPECT_TRUE(pll_Hz() > 100e6 && pll_Hz() < 432e6) << "the PLL runs at " << pll_Hz() << " Hz";
  }

  void write_configuration(std::uint32_t value) {
    const std::uint32_t wanted = value & 3U;
    if (wanted == 2) {
      EXPECT_GE(values_[flash_access] & 15U, 5U) << "the flash is too slow for this clock";
    }
    const bool ready = wanted == 0 || (wanted == 1 && crystal_ready_) || (wanted == 2 && pll_is_on() && pll_locks);
    if (ready) used_ = wanted;
    configuration_ = value;
  }

  // Captures every eighth edge of the divided crystal in cycles of the internal oscillator.
  void count_timer() {
    const bool runs = (value(timer_base) & 1U) != 0 && value(timer_option) == 2 && (value(0x40014820) & 1U) != 0 &&
                      (value(0x40014818) & 3U) == 1;
    const std::uint32_t divider = configuration_ >> 16 & 31U;
    if (!runs || !crystal_ready_ || !crystal_has_edges || divider < 2) return;
    const double between_s = divider * (1U << (value(0x40014818) >> 2 & 3U)) / crystal_Hz;
    while (time_s_ >= next_capture_s_) {
      missed_ = missed_ || captured_;
      captured_ = true;
      capture_ = static_cast<std::uint16_t>(std::fmod(next_capture_s_ * internal_Hz, 65536.0));
      next_capture_s_ += between_s;
    }
  }

  void write_watchdog_key(std::uint32_t key) {
    watchdog_open_ = key == 0x5555;
    if (key == 0xCCCC) watchdog_runs_ = true;
    if (key != 0xAAAA && key != 0xCCCC) return;
    const auto reload = values_.contains(watchdog_reload) ? values_[watchdog_reload] & 0xFFFU : 0xFFFU;
    watchdog_ends_s_ = time_s_ + (reload + 1) * (4U << (values_[watchdog_prescaler] & 7U)) / watchdog_Hz;
  }

  std::map<std::uintptr_t, std::uint32_t> values_;
  std::uint32_t control_ = 0x81, configuration_ = 0, used_ = 0;
  double time_s_ = 0, crystal_on_s_ = -1, next_capture_s_ = 0;
  bool crystal_ready_ = false, captured_ = false, missed_ = false;
  std::uint16_t capture_ = 0;
  bool watchdog_open_ = false, watchdog_runs_ = false;
  double watchdog_ends_s_ = 0, watchdog_updated_s_ = 0;
};

}  // namespace breakaway::stm32f405_test
