// What an engineer knows of an axis before its experiment, and how the experiment may end.
#pragma once

#include <cstdint>
#include <string_view>

namespace breakaway::identify {

// All lengths are in the units of the encoder's axis, forces by the told transmission. All above 0 but the limits.
template <class Scalar>
struct ExperimentParameters {
  Scalar period_s{};
  Scalar encoder_resolution_m{};  // one count
  Scalar force_step_N{};          // of the drive: one unit of its torque
  Scalar max_force_N{};
  Scalar lowest_m{}, highest_m{};  // of the travel; nothing beyond is ever entered on purpose
  Scalar max_speed_m_s{};
  Scalar duration_s = 60;  // of the whole experiment, at most
  // A load hangs on the motor by a spring, and the encoder is the motor's. There are no pairs then, which no swing has
  // room in; each hop begins by bending the spring one way and back, so slowly that the load holds.
  bool load_on_spring = false;
};

// What the experiment does at present.
enum class Stage : std::uint8_t {
  rest,    // no force: an axis that moves now is driven by something else
  pulses,  // of growing force, until the axis moves either way
  ramps,   // slow, either way, until it breaks away
  pairs,   // it is accelerated and braked by the same force
  sweep,   // from end to end: break away, accelerate, coast down
  over,    // it rests, or is brought to rest
};

enum class Ending : std::uint8_t {
  none,         // it goes on
  complete,     // the travel was swept in both directions
  out_of_time,  // it was not, within duration_s
  asked,        // somebody asked for the end
  no_room,      // the axis began outside its travel, or the travel has less than a thousand counts
  jammed,       // the greatest force does not move the axis
  drifting,     // the axis moves without force
  noisy,        // its readings jump to and fro without force
  not_a_number,
};

constexpr std::string_view to_string(Stage stage) noexcept {
  switch (stage) {
    case Stage::rest:
      return "rest";
    case Stage::pulses:
      return "pulses";
    case Stage::ramps:
      return "ramps";
    case Stage::pairs:
      return "pairs";
    case Stage::sweep:
      return "sweep";
    case Stage::over:
      return "over";
  }
  return "unknown stage";
}

constexpr std::string_view to_string(Ending ending) noexcept {
  switch (ending) {
    case Ending::none:
      return "it goes on";
    case Ending::complete:
      return "complete";
    case Ending::out_of_time:
      return "out of time: part of the travel was not seen in both directions; give it more time or less travel";
    case Ending::asked:
      return "ended as asked";
    case Ending::no_room:
      return "the axis begins outside its travel, or the travel is shorter than a thousand counts: check the limits of "
             "position";
    case Ending::jammed:
      return "the greatest force does not move the axis: check brake and clutch, or allow more force";
    case Ending::drifting:
      return "the axis moves without force: it is pulled by a load that exceeds its friction, which the experiment "
             "cannot hold";
    case Ending::noisy:
      return "readings jump to and fro by more than a count while no force is given, which hides whether the axis "
             "rests: filter the noise of the encoder in the drive, or damp what rings";
    case Ending::not_a_number:
      return "a measurement is not a number: check encoder and bus";
  }
  return "unknown ending";
}

}  // namespace breakaway::identify
