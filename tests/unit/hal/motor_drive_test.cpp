// The example on the first page of a drive's author, and models that break the concept in one thing each.
#include "breakaway/hal/motor_drive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "page_example.hpp"

namespace breakaway::hal {
namespace {

using namespace std::chrono_literals;

// [page]
enum class AmplifierStatus : std::uint8_t { ready };
constexpr std::string_view to_string(AmplifierStatus) noexcept { return "the amplifier is ready"; }

template <class Amplifier>
class AmplifierDrive {
 public:
  AmplifierDrive(Amplifier& amplifier, AxisScale<float> scale) noexcept
      : amplifier_{&amplifier}, scale_{scale}, last_{static_cast<std::uint32_t>(amplifier.counts())} {}
  DriveFeedback<float> feedback() noexcept {
    const std::int32_t counts = amplifier_->counts();
    // Unsigned subtraction wraps as the counter does.
    const auto read = static_cast<std::uint32_t>(counts);
    const auto offset = static_cast<std::int32_t>(read - datum_);
    const auto travel = static_cast<std::int32_t>(read - std::exchange(last_, read));
    return {.state = amplifier_->on() ? DriveState::enabled : DriveState::disabled,
            .position_offset_m = static_cast<float>(offset) * scale_.encoder_resolution_m,
            .position_m = static_cast<float>(counts) * scale_.encoder_resolution_m,
            .travel_m = static_cast<float>(travel) * scale_.encoder_resolution_m,
            .force_N = amplifier_->force_N(),
            .sample_time = amplifier_->time(),
            .fresh = true,
            .ever_valid = true};
  }
  void command(float force_N) noexcept {
    const float asked_N = std::isnan(force_N) ? 0.0F : force_N;
    amplifier_->give_force_N(std::clamp(asked_N, -scale_.max_force_N, scale_.max_force_N));
  }
  void set_datum_counts(std::int32_t counts) noexcept { datum_ = static_cast<std::uint32_t>(counts); }
  void request_enable() noexcept { amplifier_->switch_on(); }
  void request_stop() noexcept { amplifier_->switch_off(); }
  void reset_fault() noexcept {}
  float max_force_N() const noexcept { return scale_.max_force_N; }
  AmplifierStatus setup_status() const noexcept { return AmplifierStatus::ready; }

 private:
  Amplifier* amplifier_;
  AxisScale<float> scale_;
  std::uint32_t last_;
  std::uint32_t datum_ = 0;
};
// [page]

// An amplifier that gives what it is told while it is on, and until the period ends.
struct TestAmplifier {
  std::int32_t position = 0;
  float force = 0;
  bool energised = false;

  std::int32_t counts() const noexcept { return position; }
  float force_N() const noexcept { return force; }
  Time time() const noexcept { return Time{1ms}; }
  bool on() const noexcept { return energised; }
  void give_force_N(float newtons) noexcept { force = energised ? newtons : 0; }
  void end_period() noexcept { force = 0; }
  void switch_on() noexcept { energised = true; }
  void switch_off() noexcept {
    energised = false;
    force = 0;
  }
};

static_assert(MotorDrive<AmplifierDrive<TestAmplifier>, float>);
static_assert(!MotorDrive<AmplifierDrive<TestAmplifier>, double>, "a drive has one scalar type");

// What setup_status() may return.
enum class Mute : std::uint8_t { ready };
enum class Talkative : std::uint8_t { ready };
[[maybe_unused]] const char* to_string(Talkative) noexcept { return "ready"; }
enum class MayThrow : std::uint8_t { ready };
[[maybe_unused]] std::string_view to_string(MayThrow) { return "ready"; }
struct Numbered {
  int code = 0, detail = 0;
};
static_assert(ExplainedEnum<AmplifierStatus>);
static_assert(!ExplainedEnum<Mute> && !ExplainedEnum<Talkative> && !ExplainedEnum<MayThrow>);
static_assert(!ExplainedEnum<Numbered> && !ExplainedEnum<bool> && !ExplainedEnum<int>);

// A drive that breaks the concept in one thing.
using Model = AmplifierDrive<TestAmplifier>;
struct StatusHasNoSentence : Model {
  Mute setup_status() const noexcept { return Mute::ready; }
};
struct StatusIsANumber : Model {
  Numbered setup_status() const noexcept { return {}; }
};
struct StopMayFail : Model {
  bool request_stop() noexcept { return false; }
};
struct CommandMayThrow : Model {
  void command(float) {}
};
struct LimitChangesTheDrive : Model {
  float max_force_N() noexcept { return 1; }
};
static_assert(!MotorDrive<StatusHasNoSentence, float>);
static_assert(!MotorDrive<StatusIsANumber, float>);
static_assert(!MotorDrive<StopMayFail, float>);
static_assert(!MotorDrive<CommandMayThrow, float>);
static_assert(!MotorDrive<LimitChangesTheDrive, float>);

TEST(MotorDrivePage, ShowsTheCodeThatIsTestedHere) {
  test::expect_page_shows_example("hal/include/breakaway/hal/motor_drive.hpp", "tests/unit/hal/motor_drive_test.cpp");
}

TEST(MotorDrivePage, ExampleKeepsWhatThePageSays) {
  TestAmplifier amplifier;
  AmplifierDrive drive{amplifier, {.encoder_resolution_m = 1e-6F, .max_force_N = 50}};
  EXPECT_EQ(drive.feedback().state, DriveState::disabled);
  drive.command(10);
  EXPECT_EQ(amplifier.force, 0) << "not enabled";
  drive.request_enable();
  EXPECT_EQ(drive.feedback().state, DriveState::enabled);
  drive.command(1e9F);
  EXPECT_EQ(amplifier.force, 50);
  drive.command(-1e9F);
  EXPECT_EQ(amplifier.force, -50);
  drive.command(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(amplifier.force, 0);
  drive.command(10);
  amplifier.end_period();
  EXPECT_EQ(drive.feedback().force_N, 0) << "a command acts once";

  amplifier.position = 2'000'003;
  drive.set_datum_counts(2'000'000);
  EXPECT_FLOAT_EQ(drive.feedback().position_offset_m, 3e-6F) << "exact to the count, far from zero";
  EXPECT_FLOAT_EQ(drive.feedback().position_m, 2.000003F);
  amplifier.position = std::numeric_limits<std::int32_t>::min();
  drive.set_datum_counts(std::numeric_limits<std::int32_t>::max());
  EXPECT_FLOAT_EQ(drive.feedback().position_offset_m, 1e-6F) << "across the end of the counter's range";
  EXPECT_EQ(drive.feedback().sample_time, Time{1ms});

  drive.command(10);
  drive.request_stop();
  EXPECT_EQ(amplifier.force, 0);
  EXPECT_EQ(drive.feedback().state, DriveState::disabled);
  EXPECT_EQ(drive.max_force_N(), 50);
  EXPECT_EQ(to_string(drive.setup_status()), "the amplifier is ready");
  const DriveFeedback<float> nothing{};
  EXPECT_FALSE(nothing.fresh || nothing.ever_valid || nothing.stop_not_obeyed || nothing.homing_failed);
}

TEST(DriveState, HasANameEach) {
  const std::pair<DriveState, std::string_view> names[] = {
      {DriveState::configuring, "configuring"}, {DriveState::disabled, "disabled"}, {DriveState::enabling, "enabling"},
      {DriveState::enabled, "enabled"},         {DriveState::stopping, "stopping"}, {DriveState::fault, "fault"},
      {DriveState::unusable, "unusable"},       {DriveState::homing, "homing"}};
  for (const auto& [state, name] : names) EXPECT_EQ(to_string(state), name);
  EXPECT_EQ(to_string(static_cast<DriveState>(99)), "unknown state");
}

}  // namespace
}  // namespace breakaway::hal
