// The shapes of friction that the simulation offers. Each maker throws InputError naming the parameter that
// is out of its range. All stay in [0, 1] by construction, whatever they are combined into.
#pragma once

#include <cstdint>
#include <vector>

#include "breakaway/input/input_error.hpp"
#include "breakaway/model/shape.hpp"

namespace breakaway::model::shape {

ShapePtr constant(double value);  // value in [0, 1]

// This shape has one value at rest and one while sliding, both in [0, 1].
ShapePtr static_kinetic(double static_value, double kinetic_value);

// 1 / (1 + |v| / v_s): the velocity term of the example in section V of van de Wouw & Leine for v_s = 2 m/s. v_s > 0.
ShapePtr stribeck(double stribeck_velocity_m_s);

// exp(-(|v| / v_s)^2), v_s > 0.
ShapePtr stribeck_gaussian(double stribeck_velocity_m_s);

// (1 + sin(W t + phase)) / 2, W > 0.
ShapePtr sine_in_time(double angular_frequency_rad_s, double phase_rad = 0);

// (1 + sin(2 pi x / period + phase)) / 2, period > 0.
ShapePtr sine_in_position(double period_m, double phase_rad = 0);

// values[i] between edges_m[i - 1] and edges_m[i]: strictly increasing edges, one value in [0, 1] more than edges.
ShapePtr position_table(std::vector<double> edges_m, std::vector<double> values);

// Piecewise constant in time. A level is uniform in [0, 1], or with probability bound_share one of the two bounds; it
// holds for a dwell time that is log-uniform between the two dwells; both are drawn anew at every stick and every slip.
// The sequence depends on the seed alone, on every platform.
struct RandomDwell {
  std::uint64_t seed = 1;
  double shortest_dwell_s = 1e-3;  // > 0
  double longest_dwell_s = 1.0;    // >= shortest_dwell_s
  double bound_share = 0;          // in [0, 1]
};
ShapePtr random_dwell(const RandomDwell& parameters);

// Combinations. mean: weights >= 0, not all zero, are normalised; one for each part. The friction law of section V is
// mean({0.5, 0.5}, {stribeck(2), sine_in_time(4)}) between 0.25 m g and 0.45 m g.
ShapePtr mean(std::vector<double> weights, std::vector<ShapePtr> parts);
ShapePtr product(std::vector<ShapePtr> parts);
ShapePtr maximum(std::vector<ShapePtr> parts);
ShapePtr minimum(std::vector<ShapePtr> parts);
ShapePtr complement(ShapePtr part);  // 1 - part

}  // namespace breakaway::model::shape
