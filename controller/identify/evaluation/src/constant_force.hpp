// Stretches of a record in which the commanded force is constant, and parabolas through its positions.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "breakaway/evaluation/record.hpp"

namespace breakaway::evaluation {

// Readings first .. last - 1 have this command, and are fresh.
struct Stretch {
  std::size_t first = 0, last = 0;
  double command_N = 0;
};

std::vector<Stretch> stretches_of(const Record& record);

// x = position + speed t + acceleration t^2 / 2, where t counts from the middle of the readings.
struct Parabola {
  double middle = 0;  // reading, as a fraction
  double position_m = 0, speed_m_s = 0, acceleration_m_s2 = 0;
  double error_m_s2 = 0;  // of the acceleration, one standard deviation of readings in whole counts
  double residual_m = 0;  // root mean square of what the readings are off it

  double speed_at(double reading, double period_s) const {
    return speed_m_s + acceleration_m_s2 * (reading - middle) * period_s;
  }
  double position_at(double reading, double period_s) const {
    const double t = (reading - middle) * period_s;
    return position_m + (speed_m_s + acceleration_m_s2 * t / 2) * t;
  }
};

// Least squares through the readings first .. last - 1, of which there are at least four.
Parabola fit(const Record& record, std::size_t first, std::size_t last);

// So many make the standard error of an acceleration this large: it is 7.75 q / (n^2.5 T^2).
double readings_for(double error_m_s2, const Record& record);

// The part of first .. last - 1 in which the axis moves one way: it leaves a count at least every 16 readings, and no
// turn is in it. Empty where first == last.
struct Motion {
  std::size_t first = 0, last = 0;
  int direction = 0;
};
Motion motion_in(const Record& record, std::size_t first, std::size_t last);

}  // namespace breakaway::evaluation
