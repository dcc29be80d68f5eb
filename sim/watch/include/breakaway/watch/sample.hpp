// What is known of one axis in one period, whatever told of it.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/law/control_types.hpp"

namespace breakaway::watch {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// NaN and an empty optional: not known.
struct Sample {
  std::string axis;  // its name; empty where there is one only
  double time_s = unknown;
  double target_m = unknown;
  double position_m = unknown;
  double command_N = unknown;
  double reported_N = unknown;
  double latency_us = unknown;
  double bus_load = unknown;  // 0 to 1
  std::optional<law::Mode> mode{};
  std::optional<hal::DriveState> drive{};
  std::optional<firmware::AxisFault> fault{};
  std::uint16_t fault_code = 0;  // of the drive, as its EMCY has it
  bool stop_not_obeyed = false, link_lost = false;
};

// The enumerator with this number, if there is one that has a name.
template <class Enum>
std::optional<Enum> enumerator(std::int64_t number) {
  if (number < 0 || number > 255 || to_string(static_cast<Enum>(number)).starts_with("unknown")) return {};
  return static_cast<Enum>(number);
}

// The enumerator with this name.
template <class Enum>
std::optional<Enum> enumerator(std::string_view name) {
  for (std::int64_t number = 0; const auto found = enumerator<Enum>(number); ++number)
    if (to_string(*found) == name) return found;
  return {};
}

}  // namespace breakaway::watch
