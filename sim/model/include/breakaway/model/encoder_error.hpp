// EncoderError: what an encoder reads beside the truth: noise, and the error of the interpolation between its lines.
#pragma once

#include <cstdint>
#include <random>

#include "breakaway/input/input_error.hpp"
#include "breakaway/model/position_sine.hpp"

namespace breakaway::model {

struct EncoderErrorParameters {
  double noise_m = 0;  // root mean square of the noise, normally distributed, independent in each reading; >= 0
  PositionSine interpolation{};  // amplitude in m, >= 0; its period is that of the encoder's lines
  std::uint64_t seed = 1;        // of the noise
};

// Throws InputError naming the member that is out of its range or not finite.
void require_valid(const EncoderErrorParameters& parameters);

class EncoderError {
 public:
  // Throws InputError as require_valid().
  explicit EncoderError(const EncoderErrorParameters& parameters);

  // Returns what is read at this position. Each call draws its own noise; the sequence depends on the seed alone.
  double read_m(double position_m);

 private:
  double normal();

  EncoderErrorParameters parameters_;
  std::mt19937_64 random_;
};

}  // namespace breakaway::model
