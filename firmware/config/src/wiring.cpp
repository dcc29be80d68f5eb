#include "wiring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace breakaway::config {
namespace {

using firmware::Pin;
using firmware::Wiring;

// "PB8", as the data sheet writes it.
std::optional<Pin> pin_named(std::string_view name) {
  if (name.size() < 3 || name.size() > 4 || name[0] != 'P' || name[1] < 'A' || name[1] > 'G') return {};
  unsigned number = 0;
  const auto [rest, error] = std::from_chars(name.data() + 2, name.data() + name.size(), number);
  if (error != std::errc{} || rest != name.data() + name.size() || number > 15) return {};
  return firmware::pin(name[1], number);
}

std::string listed(std::span<const Pin> pins) {
  std::string names;
  for (const Pin p : pins) names += (names.empty() ? "" : ", ") + pin_text(p);
  return names;
}

Key pin_key(std::string_view name, Pin& to) {
  return optional(name, {"a pin as \"PB8\", of the ports A to G",
                         [&to](const Entry& entry) {
                           const auto named = pin_named(entry.node.value_exact<std::string_view>().value_or(""));
                           if (named) to = *named;
                           return named.has_value();
                         },
                         {.type = Form::Type::text, .pattern = "^P[A-G]([0-9]|1[0-5])$"}});
}

void require_one_of(const Section& section, std::string_view key, Pin given, std::span<const Pin> able,
                    const std::string& function) {
  if (std::ranges::find(able, given) != able.end()) return;
  section.fail(key, fmt::format("is {}, which cannot be {}; these can: {}", pin_text(given), function, listed(able)));
}

void check_standby(const Section& section, const Wiring& w) {
  if (w.can_standby == Pin::none && section.has("can_awake"))
    section.fail("can_awake", "says the level of a pin that is not there; add can_standby");
  if (!may_be_standby(w.can_standby, w))
    section.fail("can_standby",
                 fmt::format("is {}, which the bus or the debugger needs; choose another", pin_text(w.can_standby)));
}

void check(const Section& section, const Wiring& w) {
  const unsigned controller = w.can_controller;
  const std::string can = fmt::format("of CAN{}", controller);
  require_one_of(section, "can_receive", w.can_receive, firmware::can_receive_pins(controller),
                 "the receiving pin " + can);
  require_one_of(section, "can_transmit", w.can_transmit, firmware::can_transmit_pins(controller),
                 "the sending pin " + can);
  require_one_of(section, "serial_receive", w.serial_receive, firmware::serial_receive_pins(),
                 "the receiving pin of USART1");
  require_one_of(section, "serial_transmit", w.serial_transmit, firmware::serial_transmit_pins(),
                 "the sending pin of USART1");
  check_standby(section, w);
}

void read_stm32f405(const Section& section, Wiring& w) {
  section.read({
      optional("can", integer([&](std::int64_t n) { w.can_controller = static_cast<std::uint8_t>(n); }, 1, 2)),
      pin_key("can_receive", w.can_receive),
      pin_key("can_transmit", w.can_transmit),
      pin_key("can_standby", w.can_standby),
      optional("can_awake", choice(w.can_awake, {{"low", false}, {"high", true}})),
      optional("serial_baud", integer([&](std::int64_t n) { w.serial_baud = static_cast<std::uint32_t>(n); },
                                      firmware::least_serial_baud, firmware::most_serial_baud)),
      pin_key("serial_receive", w.serial_receive),
      pin_key("serial_transmit", w.serial_transmit),
  });
  // The pins of the other controller, where the file names none.
  if (w.can_controller == 2 && !section.has("can_receive")) w.can_receive = firmware::can_receive_pins(2).front();
  if (w.can_controller == 2 && !section.has("can_transmit")) w.can_transmit = firmware::can_transmit_pins(2).front();
  check(section, w);
}

void read_zynqmp_r5(const Section& section, Wiring& w) {
  section.read(
      {optional("can", integer([&](std::int64_t n) { w.rpu_can_controller = static_cast<std::uint8_t>(n); }, 0, 1))});
}

}  // namespace

std::string pin_text(Pin p) {
  return p == Pin::none ? "none" : fmt::format("P{}{}", static_cast<char>('A' + port_of(p)), number_of(p));
}

Wiring read_wiring(const Section& target) {
  Wiring w;
  target.read({optional("stm32f405", table([&](const Section& board) { read_stm32f405(board, w); })),
               optional("zynqmp_r5", table([&](const Section& board) { read_zynqmp_r5(board, w); }))});
  return w;
}

}  // namespace breakaway::config
