#include "slcan_world.hpp"

#include <fmt/format.h>

#include <bit>
#include <chrono>

namespace breakaway::emulated {
namespace {

constexpr const char* refused = "\a";

}  // namespace

SlcanWorld::SlcanWorld(const scenario::Scenario& s)
    : period_{s.node.loop->period},
      mechanism_{sil::axis_mechanism(s.node.axes[0], s.worlds[0])},
      network_{*s.bus},
      drive_{network_.add_drive(*s.worlds[0].drive, mechanism_.seen_by_drive())} {
  network_.log_to(frames_);
}

std::string SlcanWorld::answer(std::string_view text) {
  std::string answers;
  for (const char c : text) {
    if (c != '\r') {
      command_ += c;
      continue;
    }
    answers += carry_out(command_);
    command_.clear();
  }
  return answers;
}

// What an adapter of the LAWICEL kind does. An empty command is answered as well.
std::string SlcanWorld::carry_out(std::string_view command) {
  if (command.empty()) return "\r";
  switch (command[0]) {
    case 'C':
      open_ = false;
      return "\r";
    case 'S':
      return !open_ && command == "S8" ? "\r" : refused;
    case 'O':
      open_ = true;
      return "\r";
    case 't':
      return open_ ? take_frame(command) : refused;
    case 'F':
      return open_ ? pass_period() : refused;
    default:
      return refused;
  }
}

std::string SlcanWorld::take_frame(std::string_view command) {
  const auto number = [&](std::size_t at, std::size_t digits) {
    return std::stoul(std::string{command.substr(at, digits)}, nullptr, 16);
  };
  hal::CanFrame frame{.id = static_cast<std::uint16_t>(number(1, 3)), .size = static_cast<std::uint8_t>(number(4, 1))};
  if (frame.size > 8 || command.size() != 5 + 2U * frame.size) return refused;
  for (std::size_t i = 0; i < frame.size; ++i) frame.data[i] = static_cast<std::uint8_t>(number(5 + 2 * i, 2));
  const bool sent = network_.controller_port().send(frame, network_.bus().now() + period_) == hal::SendResult::queued;
  told_ += sent ? "z\r" : refused;
  return {};
}

// The brake opens with the period that first finds the drive enabled.
std::string SlcanWorld::pass_period() {
  if (!mechanism_.axis->released() && drive_.state() == cia402::State::operation_enabled)
    mechanism_.axis->release(hal::seconds(network_.bus().now()));
  ++periods_;
  network_.advance_to(hal::Time{period_ * static_cast<std::int64_t>(periods_)});
  positions_m_.push_back(mechanism_.axis->position_m());
  std::string text = std::exchange(told_, {});
  for (hal::ReceivedFrame received; network_.controller_port().receive(received);) text += line(received.frame);
  return text + "F00\r";
}

std::string SlcanWorld::line(const hal::CanFrame& frame) {
  std::string text = fmt::format("t{:03X}{}", frame.id, frame.size);
  for (const std::uint8_t byte : frame.payload()) text += fmt::format("{:02X}", byte);
  return text + "\r";
}

std::uint64_t SlcanWorld::frame_hash() const {
  std::uint64_t hash = 0xCBF29CE484222325U;  // FNV-1a
  const auto mix = [&](std::uint64_t value) { hash = (hash ^ value) * 0x100000001B3U; };
  for (const auto& [time_s, frame] : frames_) {
    mix(std::bit_cast<std::uint64_t>(time_s));
    mix(frame.id);
    for (const std::uint8_t byte : frame.payload()) mix(byte);
  }
  return hash;
}

}  // namespace breakaway::emulated
