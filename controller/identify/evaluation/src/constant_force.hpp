// Stretches of a record in which the commanded force is constant, and parabolas through its positions.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "breakaway/evaluation/record.hpp"

namespace breakaway::evaluation {

// Requires one value.
double median(std::vector<double> values);

// Readings first .. last - 1 have this command, and are fresh.
struct Stretch {
  std::size_t first = 0, last = 0;
  double command_N = 0;
};

std::vector<Stretch> stretches_of(const Record& record);

// x = position + speed t + acceleration t^2 / 2, where t counts from the middle of the readings.
struct Parabola {
  std::size_t first = 0, last = 0;  // through these readings, the last not included
  double middle = 0;                // reading, as a fraction
  double position_m = 0, speed_m_s = 0, acceleration_m_s2 = 0;
  double error_m_s2 = 0;  // of the acceleration, one standard deviation, if the readings are off it by chance
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

// Standard deviation of what a position loses as a whole count.
double rounding_m(const Record& record);

// Standard deviation by which the readings first .. last - 1 scatter from one to the next: at least that of whole
// counts, more where they are taken at uneven times. It does not see what is smooth over four of them.
double scatter_m(const Record& record, std::size_t first, std::size_t last);

// So many make the standard error of an acceleration this large: it is sqrt(720) s / (n^2.5 T^2) for a scatter s.
double readings_for(double error_m_s2, double scatter_m, double period_s);

// The part of first .. last - 1 in which the axis moves one way: it leaves a count at least every 16 readings, and no
// turn is in it. Empty where first == last.
struct Motion {
  std::size_t first = 0, last = 0;
  int direction = 0;
};
Motion motion_in(const Record& record, std::size_t first, std::size_t last);

}  // namespace breakaway::evaluation
