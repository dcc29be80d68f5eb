// The plant of an axis as its drive's mechanism: held by a brake until it is released, so that setting the drive up
// over the bus does not count as motion. Scenario time starts at the release.
#pragma once

#include <cstdint>
#include <optional>

#include "breakaway/drive_emulator/mechanism.hpp"

namespace breakaway::sil {

// The direction of the drive and its encoder, seen from the axis.
enum class Mounting { straight, inverted };

// What an axis does, in its own direction.
struct AxisState {
  double position_m = 0;  // where its encoder sits
  double velocity_m_s = 0;
  bool sticking = false;    // at rest, and held there
  std::uint64_t slips = 0;  // times that motion began
};

class BrakedMechanism : public drive_emulator::Mechanism {
 public:
  explicit BrakedMechanism(Mounting mounting) : sign_{mounting == Mounting::inverted ? -1.0 : 1.0} {}
  virtual ~BrakedMechanism() = default;

  virtual void release(double time_s) {
    released_ = true;
    release_s_ = time_s;
  }
  bool released() const { return released_; }

  // In the axis' direction

  // A force that the drive says it makes.
  double on_axis_N(double drive_force_N) const { return sign_ * drive_force_N; }
  double velocity_at_segment_start_m_s() const { return velocity_at_segment_start_m_s_; }
  virtual AxisState state() const = 0;
  virtual double friction_level_N() const = 0;  // NaN at rest, where friction balances the force
  virtual std::optional<double> load_position_m() const { return {}; }  // where there is a load apart

 protected:
  BrakedMechanism(const BrakedMechanism&) = default;
  BrakedMechanism& operator=(const BrakedMechanism&) = default;
  BrakedMechanism(BrakedMechanism&&) = default;
  BrakedMechanism& operator=(BrakedMechanism&&) = default;

  double sign() const { return sign_; }
  bool moves_at(double time_s) const { return released_ && !(time_s < release_s_); }
  double since_release_s(double time_s) const { return time_s - release_s_; }
  // The drive's force as it acts on the axis.
  model::AppliedForce on_axis(const model::AppliedForce& force) const {
    model::AppliedForce on_axis = force;
    on_axis.start_s -= release_s_;
    on_axis.constant_N *= sign_;
    on_axis.transient_N *= sign_;
    return on_axis;
  }
  // To be told before each move under `force`.
  void note_segment(const model::AppliedForce& force, double velocity_m_s) {
    if (force.start_s == segment_start_s_) return;
    segment_start_s_ = force.start_s;
    velocity_at_segment_start_m_s_ = velocity_m_s;
  }

 private:
  double sign_;
  double release_s_ = 0;
  double segment_start_s_ = -1;
  double velocity_at_segment_start_m_s_ = 0;
  bool released_ = false;
};

}  // namespace breakaway::sil
