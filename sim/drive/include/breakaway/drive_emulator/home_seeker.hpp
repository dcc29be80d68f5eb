// HomeSeeker: a drive's own way to its home (CiA 402-2, homing mode), by switches and an index pulse.
//
// A method is a row of legs, each of which goes one way until something is seen. The drive leads the axis by a loop of
// speed that knows nothing of its mass or friction: proportional to the error of speed and to its integral.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::drive_emulator {

class HomeSeeker {
 public:
  static constexpr hal::Duration period = std::chrono::microseconds{500};

  struct Speeds {
    double search_m_s, zero_m_s, acceleration_m_s2;  // > 0
  };

  // Says whether this method (6098h) is one that needs switches or an index pulse, and is played here.
  static bool knows(std::int64_t method);

  // A method that is known, from this place.
  void start(const HomeSwitches& switches, std::int64_t method, const Speeds& speeds, double position_m);
  void end() { seeking_ = false; }
  bool seeking() const { return seeking_; }

  // Returns the force that is wanted for the next period, inside +-most_N.
  double step(double position_m, double most_N);
  // Where the home was when it was passed; nothing before.
  std::optional<double> home_m() const { return home_m_; }
  // It was passed, and the axis stands.
  bool arrived() const { return arrived_; }

 private:
  enum class Until : std::uint8_t { low_limit, no_low_limit, high_limit, no_high_limit, switched, not_switched, index };
  struct Leg {
    int way = 0;  // 0: there is no further one
    Until until = Until::index;
    bool slowly = false;
  };
  // The longest row is to a limit, back over both edges of the home switch, and on to an index pulse.
  using Legs = std::array<Leg, 5>;
  // Where the home switch is on, seen from its edge.
  enum class HomeSwitch : std::uint8_t { above, below, between };

  static HomeSwitch home_switch_of(std::int64_t method);
  Legs legs_of(std::int64_t method, double position_m) const;
  Legs legs_to_limit(int way) const;
  Legs legs_to_edge(std::int64_t method, double position_m) const;
  Legs legs_to_either_edge(std::int64_t method, double position_m) const;
  bool sees(Until until, double position_m) const;
  double wanted_speed_m_s();

  HomeSwitches switches_;
  HomeSwitch home_switch_ = HomeSwitch::above;
  Speeds speeds_{};
  Legs legs_{};
  std::size_t leg_ = 0;
  bool seeking_ = false, arrived_ = false;
  double last_m_ = 0, speed_m_s_ = 0, integral_m_ = 0;
  std::optional<double> home_m_;
};

}  // namespace breakaway::drive_emulator
