// Registers of one bxCAN controller: offsets and bits (RM0090, 32.9).
#pragma once

#include <concepts>
#include <cstdint>

#include "breakaway/hal/bit_timing.hpp"

namespace breakaway::bxcan {

// Registers: how the port reaches the controller, by offset from its base address. On target these are volatile
// accesses, in tests a model of the controller. The formatter would tear the requirements and their comments apart.
// clang-format off

template <class R>
concept Registers = requires(R& registers, std::uint32_t offset, std::uint32_t value) {
  { registers.read(offset) } noexcept -> std::same_as<std::uint32_t>;
  { registers.write(offset, value) } noexcept -> std::same_as<void>;
  // Has on_transmit_interrupt() called soon. Only the target knows how.
  { registers.pend_transmit_interrupt() } noexcept -> std::same_as<void>;
};

// clang-format on

namespace reg {

inline constexpr std::uint32_t mcr = 0x00, msr = 0x04, tsr = 0x08, rf0r = 0x0C, ier = 0x14, esr = 0x18, btr = 0x1C;
inline constexpr std::uint32_t mailbox = 0x180, mailbox_stride = 0x10;  // three to transmit: TIR, TDTR, TDLR, TDHR
inline constexpr std::uint32_t fifo0 = 0x1B0;                           // RIR, RDTR, RDLR, RDHR
inline constexpr std::uint32_t fmr = 0x200, fm1r = 0x204, fs1r = 0x20C, ffa1r = 0x214, fa1r = 0x21C, f0r1 = 0x240;

}  // namespace reg

namespace bit {

inline constexpr std::uint32_t mcr_inrq = 1U << 0, mcr_sleep = 1U << 1, mcr_txfp = 1U << 2;
inline constexpr std::uint32_t msr_inak = 1U << 0;
// These are for mailbox 0. For mailbox m they are shifted by 8 m, and TME by m.
inline constexpr std::uint32_t tsr_rqcp0 = 1U << 0, tsr_abrq0 = 1U << 7, tsr_tme0 = 1U << 26;
inline constexpr std::uint32_t rf0r_fmp0 = 0b11, rf0r_full0 = 1U << 3, rf0r_fovr0 = 1U << 4, rf0r_rfom0 = 1U << 5;
inline constexpr std::uint32_t ier_tmeie = 1U << 0, ier_fmpie0 = 1U << 1;
inline constexpr std::uint32_t esr_ewgf = 1U << 0, esr_epvf = 1U << 1, esr_boff = 1U << 2;
inline constexpr std::uint32_t tir_txrq = 1U << 0, rir_rtr = 1U << 1, rir_ide = 1U << 2;
inline constexpr std::uint32_t fmr_finit = 1U << 0;

}  // namespace bit

inline constexpr std::uint32_t largest_prescaler = 1024;

// Lays a timing out for the register BTR (RM0090, 32.7.7).
constexpr std::uint32_t btr_value(const hal::BitTiming& timing) noexcept {
  return (timing.segment2 - 1) << 20 | (timing.segment1 - 1) << 16 | (timing.prescaler - 1);
}

}  // namespace breakaway::bxcan
