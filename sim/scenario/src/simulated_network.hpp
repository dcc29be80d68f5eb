// One controller and one emulated drive on a virtual CAN bus, brought forward together in simulated time.
#pragma once

#include <algorithm>

#include "braked_slide.hpp"
#include "breakaway/drive/drive_emulator.hpp"
#include "breakaway/scenario/result.hpp"
#include "breakaway/virtual_bus/virtual_bus.hpp"

namespace breakaway::scenario {

class SimulatedNetwork {
 public:
  using Port = virtual_bus::VirtualBus::Port;

  // frames: where to log what passes on the bus; may be null.
  SimulatedNetwork(const Scenario& s, std::vector<TimedFrame>* frames)
      : slide_{s},
        bus_{*s.bus},
        controller_port_{bus_.add_port()},
        drive_port_{bus_.add_port()},
        drive_{*s.drive, slide_, [this](const hal::CanFrame& frame, hal::Time at) { transmit(frame, at); }},
        frames_{frames} {
    drive_port_.set_listener(
        [](void* self, const hal::ReceivedFrame& received) noexcept {
          static_cast<SimulatedNetwork*>(self)->drive_.on_frame(received.frame, received.time);
        },
        this);
    if (frames_ != nullptr) bus_.set_tap(&SimulatedNetwork::log, this);
    drive_.power_on(hal::Time{0});
  }
  SimulatedNetwork(const SimulatedNetwork&) = delete;
  SimulatedNetwork& operator=(const SimulatedNetwork&) = delete;

  // Event by event, so that whatever is answered is answered at its time.
  void advance_to(hal::Time time) {
    while (bus_.now() < time) {
      const hal::Time next = std::min({time, bus_.next_event(), drive_.next_event().value_or(time)});
      bus_.advance_to(std::max(next, bus_.now()));
      drive_.advance_to(bus_.now());
    }
    drive_.advance_mechanism_to(time);
  }

  void release_brake() { slide_.release(std::chrono::duration<double>(bus_.now()).count()); }

  Port& controller_port() { return controller_port_; }
  const virtual_bus::VirtualBus& bus() const { return bus_; }
  const drive::DriveEmulator& drive() const { return drive_; }
  const BrakedSlide& mechanism() const { return slide_; }

 private:
  // A full transmit queue loses the frame, as it would in the drive; the controller's supervision sees what follows.
  void transmit(const hal::CanFrame& frame, hal::Time at) {
    static_cast<void>(drive_port_.send(frame, at + std::chrono::seconds{1}));
  }

  static void log(void* self, const hal::CanFrame& frame, hal::Time, hal::Time end) noexcept {
    static_cast<SimulatedNetwork*>(self)->frames_->push_back({std::chrono::duration<double>(end).count(), frame});
  }

  BrakedSlide slide_;
  virtual_bus::VirtualBus bus_;
  Port& controller_port_;
  Port& drive_port_;
  drive::DriveEmulator drive_;
  std::vector<TimedFrame>* frames_;
};

}  // namespace breakaway::scenario
