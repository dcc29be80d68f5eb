#include "listen.hpp"

#include <fmt/format.h>

#include <bitset>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/overheard.hpp"
#include "breakaway/odrive/messages.hpp"
#include "breakaway/odrive/turns_scale.hpp"
#include "clock.hpp"
#include "odrive_side.hpp"
#include "outlet.hpp"
#include "realtime.hpp"

namespace breakaway::linux_node {
namespace {

// What the drive of an axis says of itself, frame by frame.
class HeardDrive {
 public:
  HeardDrive(const Configuration& c, std::size_t place) : c_{c}, place_{place} {}

  // A sample, if the frame brings one.
  std::optional<StepRecord> take(const hal::ReceivedFrame& received) {
    StepRecord step{.time = received.time, .axis = static_cast<std::uint8_t>(place_), .controlled = false};
    if (!(c_.speaks_odrive() ? of_odrive(received.frame, step) : of_canopen(received.frame, step))) return {};
    step.target_counts = step.position_counts;
    return step;
  }

 private:
  // By its first TPDO.
  bool of_canopen(const hal::CanFrame& frame, StepRecord& step) const {
    const auto& drive = c_.drive(place_);
    const auto told = cia402::overheard_feedback(frame, drive.node_id, drive.invert_direction);
    if (!told) return false;
    step.position_counts = told->position_counts;
    step.reported_N = c_.axes[place_].force_per_per_mille_N * static_cast<float>(told->torque_per_mille);
    step.drive = told->state;
    return true;
  }

  // By its estimate; state and torque are those that it told before.
  bool of_odrive(const hal::CanFrame& frame, StepRecord& step) {
    const auto& drive = c_.odrives[place_];
    if (odrive::node_id_of(frame.id) != drive.node_id) return false;
    const int sign = drive.invert_direction ? -1 : 1;
    if (const auto heartbeat = odrive::as_heartbeat(frame)) state_ = state_of(*heartbeat);
    if (const auto torques = odrive::as_torques(frame))
      force_N_ = static_cast<float>(sign) * torques->second * drive.force_per_torque_N_per_Nm;
    const auto estimates = odrive::as_estimates(frame);
    if (!estimates) return false;
    const auto counts = odrive::TurnsScale{drive.counts_per_turn}.counts(estimates->first);
    if (!counts) return false;
    step.position_counts = sign * *counts;
    step.reported_N = force_N_;
    step.drive = state_;
    return true;
  }

  static hal::DriveState state_of(const odrive::Heartbeat& told) {
    using hal::DriveState;
    if (told.state == odrive::AxisState::closed_loop_control) return DriveState::enabled;
    if (told.state != odrive::AxisState::idle) return DriveState::configuring;
    return told.errors != 0 ? DriveState::fault : DriveState::disabled;
  }

  const Configuration& c_;
  std::size_t place_;
  float force_N_ = 0;
  hal::DriveState state_ = hal::DriveState::configuring;
};

// Who was there, for an operator who waits for samples in vain.
class Heard {
 public:
  explicit Heard(bool odrives) : odrives_{odrives} {}

  void add(const hal::CanFrame& frame) {
    ++frames_;
    if (odrives_) {
      if (const auto node = OdriveSide::heard_node(frame)) nodes_.set(*node);
    } else if (canopen::function_code_of(frame.id) == canopen::heartbeat_function_code) {
      nodes_.set(frame.id - canopen::heartbeat_function_code);
    }
  }

  std::string sentence() const {
    if (frames_ == 0)
      return "no frame was heard: check power, wiring and bit rate; a drive that nobody has set up may be silent, too";
    std::string nodes;
    for (std::size_t id = odrives_ ? 0 : 1; id < nodes_.size(); ++id)
      if (nodes_[id]) nodes += fmt::format("{}{}", nodes.empty() ? "" : ", ", id);
    return fmt::format(
        "{} frames were heard, none of them a sample of a drive of this file; heartbeats are of {}. A drive sends "
        "samples once {}",
        frames_, nodes.empty() ? "nobody" : "node " + nodes,
        odrives_ ? "it is set to, or is asked for them" : "a master has set it up and sends SYNC");
  }

 private:
  bool odrives_;
  std::size_t frames_ = 0;
  std::bitset<128> nodes_;
};

}  // namespace

ExitCode listen(const Configuration& configuration, const Options& options, socketcan::KernelSocket& socket,
                Telemetry& telemetry) {
  socketcan::Port<socketcan::KernelSocket> port{socket};
  Ticker ticker{configuration.loop().network.period};
  const hal::Time begin = monotonic_now();
  const hal::Duration duration{std::llround(options.duration_s * 1e9)};
  bool any = false;
  Heard others{configuration.speaks_odrive()};
  std::vector<HeardDrive> drives;
  for (std::size_t place = 0; place < configuration.axes.size(); ++place) drives.emplace_back(configuration, place);
  telemetry.ready = true;
  for (hal::Time now = begin; !telemetry.stop && (duration == hal::Duration::zero() || now - begin < duration);) {
    now = ticker.wait();
    if (ticker.in_time()) telemetry.periods.fetch_add(1, std::memory_order_relaxed);
    port.poll(now);
    for (hal::ReceivedFrame received; port.receive(received);) {
      telemetry.add(FrameRecord{received.time, received.frame});
      others.add(received.frame);
      for (HeardDrive& drive : drives) {
        const auto record = drive.take(received);
        if (!record) continue;
        telemetry.add(*record);
        any = true;
      }
    }
  }
  telemetry.stopping = true;
  if (!any) say(fmt::format("{}: {}", options.interface, others.sentence()));
  return any ? done : failed;
}

}  // namespace breakaway::linux_node
