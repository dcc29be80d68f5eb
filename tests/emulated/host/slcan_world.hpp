// The world of a controller on slcan: an adapter on a virtual CAN bus, with the emulated drive and its axis behind it.
//
// Time moves in whole periods: the status request with which the controller ends its step (F) lets one period pass.
// What the controller sent before it was sent at the step's instant, and what came back by the end of the period is
// told before the answer to F,
// as is whether frames were taken: while the controller works, the line is quiet. Nothing depends on how long anyone
// takes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "axis_under_test.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/simulated_network.hpp"

namespace breakaway::emulated {

class SlcanWorld {
 public:
  explicit SlcanWorld(const scenario::Scenario& s);

  // Any piece of what the controller says; the adapter's answer.
  std::string answer(std::string_view text);
  // What the adapter says next, before its answer to the next status request: a frame from another node.
  void tell(const hal::CanFrame& frame) { told_ += line(frame); }

  std::uint64_t periods() const { return periods_; }
  double position_m() const { return mechanism_.axis->position_m(); }
  bool sticking() const { return mechanism_.axis->state().sticking; }
  bool released() const { return mechanism_.axis->released(); }
  const std::vector<sil::TimedFrame>& frames() const { return frames_; }
  // At the end of every period, and of all frames that the bus carried, with their times: equal only for equal runs.
  const std::vector<double>& positions_m() const { return positions_m_; }
  std::uint64_t frame_hash() const;

 private:
  std::string carry_out(std::string_view command);
  std::string take_frame(std::string_view command);
  std::string pass_period();
  static std::string line(const hal::CanFrame& frame);

  hal::Duration period_;
  sil::AxisMechanism mechanism_;
  sil::SimulatedNetwork network_;
  drive_emulator::DriveEmulator& drive_;
  std::vector<sil::TimedFrame> frames_;
  std::vector<double> positions_m_;
  std::string command_, told_;
  std::uint64_t periods_ = 0;
  bool open_ = false;
};

}  // namespace breakaway::emulated
