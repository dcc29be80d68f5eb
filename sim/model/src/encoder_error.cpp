#include "breakaway/model/encoder_error.hpp"

#include <cmath>
#include <numbers>

#include "require.hpp"

namespace breakaway::model {

void require_valid(const EncoderErrorParameters& parameters) {
  require_not_negative("noise_m", parameters.noise_m);
  require_valid(parameters.interpolation);
}

EncoderError::EncoderError(const EncoderErrorParameters& parameters)
    : parameters_{parameters}, random_{parameters.seed} {
  require_valid(parameters);
}

double EncoderError::read_m(double position_m) {
  double read_m = position_m;
  if (parameters_.interpolation.amplitude != 0) read_m += parameters_.interpolation.at(position_m);
  if (parameters_.noise_m != 0) read_m += parameters_.noise_m * normal();
  return read_m;
}

// After Box and Muller, because the standard library's distribution differs from platform to platform.
double EncoderError::normal() {
  const auto uniform = [this] { return (static_cast<double>(random_() >> 11U) + 0.5) * 0x1p-53; };
  const double radius = std::sqrt(-2 * std::log(uniform()));
  return radius * std::cos(2 * std::numbers::pi * uniform());
}

}  // namespace breakaway::model
