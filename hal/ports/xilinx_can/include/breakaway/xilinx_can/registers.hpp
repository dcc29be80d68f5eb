// Registers of the CAN controller of Zynq UltraScale+ (and Zynq-7000): offsets and bits (UG1085, chapter 20; UG1087).
#pragma once

#include <concepts>
#include <cstdint>

#include "breakaway/hal/bit_timing.hpp"

namespace breakaway::xilinx_can {

// Registers: how the port reaches the controller, by offset from its base address. On target these are volatile
// accesses, in tests a model of the controller. A read may have an effect: that of the receive FIFO's identifier takes
// a frame out.

// The formatter would tear the requirements apart.
// clang-format off

template <class R>
concept Registers = requires(R& registers, std::uint32_t offset, std::uint32_t value) {
  { registers.read(offset) } noexcept -> std::same_as<std::uint32_t>;
  { registers.write(offset, value) } noexcept -> std::same_as<void>;
};

// clang-format on

namespace reg {

inline constexpr std::uint32_t srr = 0x00, msr = 0x04, brpr = 0x08, btr = 0x0C, sr = 0x18, isr = 0x1C, ier = 0x20,
                               icr = 0x24;
inline constexpr std::uint32_t tx_fifo = 0x30, rx_fifo = 0x50;  // four words each: identifier, length, data 0-3, 4-7
inline constexpr std::uint32_t afr = 0x60, afmr1 = 0x64, afir1 = 0x68, filter_stride = 8;

}  // namespace reg

namespace bit {

inline constexpr std::uint32_t srr_srst = 1U << 0, srr_cen = 1U << 1;
inline constexpr std::uint32_t sr_config = 1U << 0, sr_errwrn = 1U << 6, sr_txfll = 1U << 10, sr_acfbsy = 1U << 11;
inline constexpr std::uint32_t sr_estat = 0b11U << 7, estat_bus_off = 0b10U << 7, estat_passive = 0b11U << 7;
inline constexpr std::uint32_t isr_txfll = 1U << 2, isr_rxoflw = 1U << 6, isr_rxnemp = 1U << 7, isr_bsoff = 1U << 9,
                               isr_txfemp = 1U << 14, isr_all = 0x7FFF;
inline constexpr std::uint32_t id_rtr_of_base = 1U << 20, id_ide = 1U << 19;

}  // namespace bit

inline constexpr std::uint32_t filters = 4, largest_prescaler = 256;

// Lay a timing out for the registers BRPR and BTR.
constexpr std::uint32_t brpr_value(const hal::BitTiming& timing) noexcept { return timing.prescaler - 1; }
constexpr std::uint32_t btr_value(const hal::BitTiming& timing) noexcept {
  return (timing.segment2 - 1) << 4 | (timing.segment1 - 1);
}

}  // namespace breakaway::xilinx_can
