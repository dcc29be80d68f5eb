// A drive, a law and a port of the tests' own, so that only the loop is under test.
#pragma once

#include <cstdint>
#include <deque>
#include <string_view>
#include <utility>
#include <vector>

#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/master.hpp"
#include "breakaway/firmware/control_loop.hpp"

namespace breakaway::firmware {
namespace testing {

using namespace std::chrono_literals;

struct FakePort {
  std::vector<hal::CanFrame> sent;
  std::vector<hal::Time> deadlines;  // of every frame since the start
  std::deque<hal::ReceivedFrame> to_receive;
  hal::BusState state = hal::BusState::error_active;
  bool full = false;
  int purges = 0;

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    if (full) return hal::SendResult::queue_full;
    deadlines.push_back(deadline);
    sent.push_back(frame);
    return hal::SendResult::queued;
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (to_receive.empty()) return false;
    received = to_receive.front();
    to_receive.pop_front();
    return true;
  }
  void purge_transmit_queue() noexcept { ++purges; }
  hal::BusState bus_state() const noexcept { return state; }
};

// What the test sees of a drive that the loop owns a copy of.
struct DriveProbe {
  hal::DriveFeedback<float> feedback;
  std::vector<float> commands;
  std::vector<hal::Time> syncs;
  std::int32_t datum = 0;
  int enables = 0, stops = 0, resets = 0, frames = 0;
  bool heartbeat_lost = false;
  canopen::Emcy emcy;
  std::uint16_t new_error = 0;  // of an EMCY message
  bool node_id_conflict = false, reference_lost = false;
  std::int32_t reference = 0;
  bool wants_acyclic = false;
};

enum class FakeStatus : std::uint8_t { ready };
constexpr std::string_view to_string(FakeStatus) noexcept { return "the drive is ready"; }

struct FakeDrive {
  using Master = canopen::Master;
  struct Config {
    DriveProbe* probe = nullptr;
    std::uint8_t node_id = 1;
  };

  DriveProbe* probe;
  std::uint8_t id;
  hal::AxisScale<float> scale;

  FakeDrive(const Config& config, const hal::NetworkConfig&, const hal::AxisScale<float>& s) noexcept
      : probe{config.probe}, id{config.node_id}, scale{s} {}

  hal::DriveFeedback<float> feedback() noexcept { return probe->feedback; }
  void command(float force_N) noexcept { probe->commands.push_back(force_N); }
  void set_datum_counts(std::int32_t counts) noexcept { probe->datum = counts; }
  void request_enable() noexcept { ++probe->enables; }
  void request_stop() noexcept { ++probe->stops; }
  void reset_fault() noexcept { ++probe->resets; }
  float max_force_N() const noexcept { return 50; }
  FakeStatus setup_status() const noexcept { return FakeStatus::ready; }
  void on_frame(const hal::ReceivedFrame&) noexcept { ++probe->frames; }
  void on_sync(hal::Time time) noexcept { probe->syncs.push_back(time); }
  void update(hal::Time) noexcept {}
  bool next_acyclic_frame(hal::CanFrame& frame, hal::Time) noexcept {
    frame.id = canopen::sdo_request_cob_id(id);
    return probe->wants_acyclic;
  }
  bool next_command_frame(hal::CanFrame& frame) noexcept {
    frame.id = canopen::rpdo_cob_id(1, id);
    return true;
  }
  std::uint8_t node_id() const noexcept { return id; }
  float encoder_resolution_m() const noexcept { return scale.encoder_resolution_m; }
  bool heartbeat_lost() const noexcept { return probe->heartbeat_lost; }
  std::uint16_t last_error_code() const noexcept { return probe->emcy.code; }
  std::uint16_t take_emergency() noexcept { return std::exchange(probe->new_error, std::uint16_t{0}); }
  bool node_id_conflict() const noexcept { return probe->node_id_conflict; }
  bool reference_lost() const noexcept { return probe->reference_lost; }
  void set_reference_counts(std::int32_t counts) noexcept { probe->reference = counts; }
};

struct ProportionalLaw {
  float period = 1e-3F;
  float shifted = 0, last_shift = 0, limit_N = 0;
  int resets = 0;
  law::ControlFault fault_ = law::ControlFault::none;
  law::ControlOutput<float> update(const law::Measurement<float>& z) noexcept {
    return {z.fresh ? -10 * z.position_error_m : 0.0F, 0, law::Mode::approach, false};
  }
  void shift_target(float shift_m) noexcept {
    shifted += shift_m;
    last_shift = shift_m;
  }
  void reset() noexcept { ++resets; }
  void limit_force(float force_N) noexcept { limit_N = force_N; }
  float period_s() const noexcept { return period; }
  float encoder_resolution_m() const noexcept { return 1e-6F; }
  float max_force_N() const noexcept { return 50; }
  law::ControlFault fault() const noexcept { return fault_; }
  law::Mode mode() const noexcept { return law::Mode::approach; }
};

using Loop = ControlLoop<FakePort, FakeDrive, ProportionalLaw, float>;

// An axis that runs as soon as it is enabled.
inline AxisLimits<float> moderate_limits() {
  AxisLimits<float> limits;
  limits.speed_m_s = 1;
  return limits;
}

}  // namespace testing
}  // namespace breakaway::firmware
