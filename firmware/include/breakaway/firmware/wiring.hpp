// Wiring: which pins and peripherals of a processor the node's board uses; each target looks at its own. Pins and
// alternate functions are those of the STM32F405's data sheet (table 9) in all packages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace breakaway::firmware {

// Sixteen times the port, from A on, and the number; or no pin.
enum class Pin : std::uint8_t { none = 0xFF };

// port: 'A' to 'G'; number: 0 to 15.
constexpr Pin pin(char port, unsigned number) noexcept {
  return static_cast<Pin>(static_cast<unsigned>(port - 'A') << 4 | number);
}
constexpr unsigned port_of(Pin p) noexcept { return static_cast<unsigned>(p) >> 4; }
constexpr unsigned number_of(Pin p) noexcept { return static_cast<unsigned>(p) & 15U; }

struct Wiring {
  std::uint8_t rpu_can_controller = 0;  // of the Zynq UltraScale+: 0 or 1. All below are of the STM32F405.
  std::uint8_t can_controller = 1;      // 1 or 2
  Pin can_receive = pin('B', 8), can_transmit = pin('B', 9);
  Pin can_standby = Pin::none;  // of the transceiver
  bool can_awake = false;       // the level of that pin at which it takes part in the bus
  std::uint32_t serial_baud = 1'000'000;
  Pin serial_receive = pin('A', 10), serial_transmit = pin('A', 9);  // of USART1
};

namespace internal {

inline constexpr Pin can1_receive[] = {pin('A', 11), pin('B', 8), pin('D', 0)};
inline constexpr Pin can1_transmit[] = {pin('A', 12), pin('B', 9), pin('D', 1)};
inline constexpr Pin can2_receive[] = {pin('B', 5), pin('B', 12)};
inline constexpr Pin can2_transmit[] = {pin('B', 6), pin('B', 13)};
inline constexpr Pin usart1_receive[] = {pin('A', 10), pin('B', 7)};
inline constexpr Pin usart1_transmit[] = {pin('A', 9), pin('B', 6)};

constexpr bool is_one_of(Pin p, std::span<const Pin> pins) noexcept {
  for (const Pin each : pins)
    if (each == p) return true;
  return false;
}

}  // namespace internal

// Returns the pins that can have this function. controller: 1 or 2.
constexpr std::span<const Pin> can_receive_pins(unsigned controller) noexcept {
  return controller == 1 ? std::span<const Pin>{internal::can1_receive} : internal::can2_receive;
}
constexpr std::span<const Pin> can_transmit_pins(unsigned controller) noexcept {
  return controller == 1 ? std::span<const Pin>{internal::can1_transmit} : internal::can2_transmit;
}
constexpr std::span<const Pin> serial_receive_pins() noexcept { return internal::usart1_receive; }
constexpr std::span<const Pin> serial_transmit_pins() noexcept { return internal::usart1_transmit; }

// One that nothing else needs: not the bus', nor the debugger's.
constexpr bool may_be_standby(Pin p, const Wiring& w) noexcept {
  if (p == Pin::none) return true;
  return port_of(p) <= 6 && p != pin('A', 13) && p != pin('A', 14) && p != w.can_receive && p != w.can_transmit;
}

inline constexpr std::uint32_t least_serial_baud = 9'600, most_serial_baud = 5'250'000;

// Returns whether every pin can have its function, and none has two.
constexpr bool is_possible(const Wiring& w) noexcept {
  using internal::is_one_of;
  return w.rpu_can_controller <= 1 && (w.can_controller == 1 || w.can_controller == 2) &&
         is_one_of(w.can_receive, can_receive_pins(w.can_controller)) &&
         is_one_of(w.can_transmit, can_transmit_pins(w.can_controller)) && may_be_standby(w.can_standby, w) &&
         w.serial_baud >= least_serial_baud && w.serial_baud <= most_serial_baud &&
         is_one_of(w.serial_receive, serial_receive_pins()) && is_one_of(w.serial_transmit, serial_transmit_pins());
}

}  // namespace breakaway::firmware
