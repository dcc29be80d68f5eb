// MotorDrive: what the control loop needs of a drive. This is the page to read before writing one.
//
// Roles. A drive object is the controller's picture of one drive and its axis: it turns the drive's units (encoder
// counts, per mille of a rated torque, a state machine) into metres, newtons and hal::DriveState, and back. Drive units
// exist only inside. Positive force pushes towards positive position.
//
// Positions are offsets from a datum, which the loop moves to the target: the drive subtracts whole encoder counts
// before it converts to metres, so a float near the target is exact to the count however far from zero the axis stands.
//
// Life cycle. The loop keeps its own copy of the drive. It is `configuring` until its own set-up is done, then
// `disabled`; request_enable() leads it to `enabled`, from where it follows command(); request_stop(), a fault or the
// drive itself leads it out again. Once a period the loop calls feedback(), then command() if the axis may be given
// force. A drive on a bus has more to do in a period, with the frames that come and go: firmware::BusDrive says what.
//
// All calls have in common that they never block, allocate, throw or wait for a lock, and that their work is bounded.
// They are made in the thread of the loop only, and the drive does not call back. Requests are wishes: the call returns
// at once, and the drive's state machine carries them out in the periods that follow.
//
// A minimal drive, for an encoder that is read at once and an amplifier that gives force at once, for a period a call:
//
//   enum class AmplifierStatus : std::uint8_t { ready };
//   constexpr std::string_view to_string(AmplifierStatus) noexcept { return "the amplifier is ready"; }
//
//   template <class Amplifier>
//   class AmplifierDrive {
//    public:
//     AmplifierDrive(Amplifier& amplifier, AxisScale<float> scale) noexcept
//         : amplifier_{&amplifier}, scale_{scale}, last_{static_cast<std::uint32_t>(amplifier.counts())} {}
//     DriveFeedback<float> feedback() noexcept {
//       const std::int32_t counts = amplifier_->counts();
//       // Unsigned subtraction wraps as the counter does.
//       const auto read = static_cast<std::uint32_t>(counts);
//       const auto offset = static_cast<std::int32_t>(read - datum_);
//       const auto travel = static_cast<std::int32_t>(read - std::exchange(last_, read));
//       return {.state = amplifier_->on() ? DriveState::enabled : DriveState::disabled,
//               .position_offset_m = static_cast<float>(offset) * scale_.encoder_resolution_m,
//               .position_m = static_cast<float>(counts) * scale_.encoder_resolution_m,
//               .travel_m = static_cast<float>(travel) * scale_.encoder_resolution_m,
//               .force_N = amplifier_->force_N(),
//               .sample_time = amplifier_->time(),
//               .fresh = true,
//               .ever_valid = true};
//     }
//     void command(float force_N) noexcept {
//       const float asked_N = std::isnan(force_N) ? 0.0F : force_N;
//       amplifier_->give_force_N(std::clamp(asked_N, -scale_.max_force_N, scale_.max_force_N));
//     }
//     void set_datum_counts(std::int32_t counts) noexcept { datum_ = static_cast<std::uint32_t>(counts); }
//     void request_enable() noexcept { amplifier_->switch_on(); }
//     void request_stop() noexcept { amplifier_->switch_off(); }
//     void reset_fault() noexcept {}
//     float max_force_N() const noexcept { return scale_.max_force_N; }
//     AmplifierStatus setup_status() const noexcept { return AmplifierStatus::ready; }
//
//    private:
//     Amplifier* amplifier_;
//     AxisScale<float> scale_;
//     std::uint32_t last_;
//     std::uint32_t datum_ = 0;
//   };
//
// cia402::Drive is the real one.
#pragma once

#include <concepts>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

// An axis' controller and its drive have to agree on its scale. Both figures must be finite and above 0.
template <class Scalar>
struct AxisScale {
  Scalar encoder_resolution_m{};  // metres of travel a count
  Scalar max_force_N{};           // the axis' own limit; the drive's counts besides
};

enum class DriveState : std::uint8_t {
  configuring,  // is being set up, or waited for; no force
  disabled,     // is set up but not energised; no force
  enabling,     // is on its way to enabled; no force
  enabled,      // follows command()
  stopping,     // a quick stop or a fault reaction is going on
  fault,        // stopped by itself, and stays so until reset_fault()
  unusable,     // is the wrong device or refuses its configuration; setup_status() says why
  homing,       // finds its zero by itself, with force of its own
};

constexpr std::string_view to_string(DriveState state) noexcept {
  switch (state) {
    case DriveState::configuring:
      return "configuring";
    case DriveState::disabled:
      return "disabled";
    case DriveState::enabling:
      return "enabling";
    case DriveState::enabled:
      return "enabled";
    case DriveState::stopping:
      return "stopping";
    case DriveState::fault:
      return "fault";
    case DriveState::unusable:
      return "unusable";
    case DriveState::homing:
      return "homing";
  }
  return "unknown state";
}

template <class Scalar>
struct DriveFeedback {
  DriveState state = DriveState::configuring;
  Scalar position_offset_m{};  // position minus datum
  Scalar position_m{};  // position from the drive's zero, rounded to Scalar: for limits and display, not for control
  Scalar travel_m{};    // since the last fresh sample, exact to the count across the end of the counter's range
  Scalar force_N{};     // what the drive reports that it produces
  Time sample_time{};   // when the position was taken, as exactly as is known
  bool fresh = false;   // a new position came since the last call
  bool ever_valid = false;       // a position came since power-up
  bool stop_not_obeyed = false;  // was to stop, and was not seen without force within the time that a stop takes
  bool homing_failed = false;    // looked for its zero and did not find it; until reset_fault()
  bool faulty = false;           // stopped by itself for a fault, or is about to
  std::uint16_t fault_code = 0;  // while state is fault: the error code of 603Fh or EMCY
  Scalar force_step_N{};         // between two forces that the drive can report; 0: finer than matters
};

// The formatter would tear the requirements and their comments apart.
// clang-format off

// ExplainedEnum: an enum whose every value has a sentence. It is what a call that can fail returns.
template <class E>
concept ExplainedEnum = std::is_enum_v<E> && requires(E value) {
  { to_string(value) } noexcept -> std::same_as<std::string_view>;
};

template <class D, class Scalar>
concept MotorDrive = requires(D& drive, const D& constant, Scalar force_N, std::int32_t counts) {
  // Returns the newest sample and the state as of now, and clears `fresh`: a sample is fresh once. Until a first one
  // came, ever_valid is false and the positions mean nothing.
  // The feedback is a copy and the caller's. Never blocks; for the loop's thread.
  { drive.feedback() } noexcept -> std::same_as<DriveFeedback<Scalar>>;

  // Sets the force for the next period: clamped to +-max_force_N(), and zero for what is not a number. It acts once:
  // a period without a call means zero force. A drive that is not `enabled` ignores it.
  // Never blocks; for the loop's thread.
  { drive.command(force_N) } noexcept -> std::same_as<void>;

  // Sets the encoder count that position_offset_m is measured from, from the next feedback() on. Any count will do, and
  // the offset is right across the end of the counter's range.
  // Never blocks; for the loop's thread.
  { drive.set_datum_counts(counts) } noexcept -> std::same_as<void>;

  // Asks for force. A drive that is in fault, is unusable or disobeys a stop ignores it; a wish that was granted ends
  // when the drive stops by itself, so that nothing is energised again without a new request.
  // Returns at once and never blocks; for the loop's thread.
  { drive.request_enable() } noexcept -> std::same_as<void>;

  // Asks for a stop, and for the force to be taken off after it. It cannot fail, counts in any state and takes back an
  // earlier request_enable(); from this call on the force that is sent is zero. A drive on a bus goes on until the stop
  // is seen to be obeyed, and says meanwhile that it is not (stop_not_obeyed).
  // Returns at once and never blocks; for the loop's thread.
  { drive.request_stop() } noexcept -> std::same_as<void>;

  // Acknowledges a fault, the loop's own included: the drive may be set up anew and be `configuring` meanwhile. A drive
  // that is enabled ignores it; one whose cause is still there stays in fault.
  // Returns at once and never blocks; for the loop's thread.
  { drive.reset_fault() } noexcept -> std::same_as<void>;

  // Returns the largest force that can be commanded: the axis' own limit or the drive's, whichever is lower. It may
  // change while the drive is being set up.
  // Changes nothing and never blocks; for the loop's thread.
  { constant.max_force_N() } noexcept -> std::same_as<Scalar>;

  // Returns how the set-up stands, as an enum of the drive's own; to_string(setup_status()) is a sentence that names
  // what is wrong and what to do about it.
  // Changes nothing and never blocks; for the loop's thread, and for main() before the first step.
  { constant.setup_status() } noexcept -> ExplainedEnum;
};

// clang-format on

}  // namespace breakaway::hal
