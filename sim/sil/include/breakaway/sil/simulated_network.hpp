// A controller's port and emulated drives on one virtual CAN bus, brought forward together in simulated time.
#pragma once

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "breakaway/canopen/sync.hpp"
#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/drive_emulator/emulated_drive.hpp"
#include "breakaway/odrive_emulator/odrive_emulator.hpp"
#include "breakaway/sil/result.hpp"
#include "breakaway/virtual_bus/virtual_bus.hpp"

namespace breakaway::sil {

class SimulatedNetwork {
 public:
  using Port = virtual_bus::VirtualBus::Port;

  explicit SimulatedNetwork(const virtual_bus::VirtualBusConfig& config)
      : bus_{config}, controller_port_{bus_.add_port()} {}
  SimulatedNetwork(const SimulatedNetwork&) = delete;
  SimulatedNetwork& operator=(const SimulatedNetwork&) = delete;

  // A drive with its motor on `mechanism`, switched on now. The mechanism must outlive the network.
  drive_emulator::DriveEmulator& add_drive(const drive_emulator::EmulatorConfig& config,
                                           drive_emulator::Mechanism& mechanism) {
    return add<drive_emulator::DriveEmulator>(config, mechanism);
  }
  odrive_emulator::OdriveEmulator& add_drive(const odrive_emulator::EmulatorConfig& config,
                                             drive_emulator::Mechanism& mechanism) {
    return add<odrive_emulator::OdriveEmulator>(config, mechanism);
  }

  // Every frame that leaves the wire from now on is appended to `frames`.
  void log_to(std::vector<TimedFrame>& frames) {
    log_ = &frames;
    listen();
  }
  // From now on the ends of SYNC are compared with whole periods.
  void watch_sync(hal::Duration period) {
    period_ = period;
    first_sync_.reset();
    earliest_ = latest_ = {};
    listen();
  }
  // By how much any two SYNC since then were not whole periods apart, at most.
  hal::Duration sync_off() const { return latest_ - earliest_; }

  // Event by event, so that whatever is answered is answered at its time. Throws what a mechanism does.
  void advance_to(hal::Time time) {
    send_until(time);
    for (const auto& node : nodes_) node->drive->advance_mechanism_to(time);
  }

  // The world up to `now`, at which a period of the loop begins.
  template <class Loop>
  void begin_period(Loop& loop, hal::Time now) {
    finish_period(loop);
    advance_to(now);
    loop.command(now);
  }
  // The world up to the SYNC of the period that command() began, which leaves then.
  template <class Loop>
  void finish_period(Loop& loop) {
    const auto due = loop.sync_due();
    if (!due) return;
    send_until(*due);
    loop.sync(*due);
  }

  Port& controller_port() { return controller_port_; }
  // Another node's door to the bus. It lives as long as the network.
  Port& add_port() { return bus_.add_port(); }
  const virtual_bus::VirtualBus& bus() const { return bus_; }

 private:
  struct Node {
    explicit Node(Port& p) : port{p} {
      port.set_listener(
          [](void* self, const hal::ReceivedFrame& received) noexcept { static_cast<Node*>(self)->receive(received); },
          this);
    }
    // A frame may make the drive move its mechanism, which refuses what it cannot follow. The bus lets no exception
    // through, so the refusal waits for advance_to().
    void receive(const hal::ReceivedFrame& received) noexcept {
      if (refusal) return;
      try {
        drive->on_frame(received.frame, received.time);
      } catch (...) {
        refusal = std::current_exception();
      }
    }
    void advance_to(hal::Time now) const {
      if (refusal) std::rethrow_exception(refusal);
      drive->advance_to(now);
    }
    // A full transmit queue loses the frame, as it would in the drive; the controller's supervision sees what follows.
    void transmit(const hal::CanFrame& frame, hal::Time at) {
      static_cast<void>(port.send(frame, at + std::chrono::seconds{1}));
    }
    Port& port;
    std::unique_ptr<drive_emulator::EmulatedDrive> drive;
    std::exception_ptr refusal;
  };

  template <class Emulator, class Config>
  Emulator& add(const Config& config, drive_emulator::Mechanism& mechanism) {
    nodes_.push_back(std::make_unique<Node>(bus_.add_port()));
    Node& node = *nodes_.back();
    auto drive = std::make_unique<Emulator>(
        config, mechanism, [&node](const hal::CanFrame& frame, hal::Time at) { node.transmit(frame, at); });
    Emulator& added = *drive;
    node.drive = std::move(drive);
    added.power_on(bus_.now());
    return added;
  }

  // The bus and what drives do of their own; a mechanism moves when its drive asks it where it is.
  void send_until(hal::Time time) {
    while (bus_.now() < time) {
      bus_.advance_to(std::max(bus_.now(), next_event(time)));
      for (const auto& node : nodes_) node->advance_to(bus_.now());
    }
  }

  void listen() {
    bus_.set_tap([](void* self, const hal::CanFrame& frame, hal::Time,
                    hal::Time end) noexcept { static_cast<SimulatedNetwork*>(self)->note(frame, end); },
                 this);
  }
  void note(const hal::CanFrame& frame, hal::Time end) {
    if (log_ != nullptr) log_->push_back({hal::seconds(end), frame});
    if (period_ <= hal::Duration::zero() || !canopen::is_sync(frame)) return;  // nobody watches
    if (!first_sync_) first_sync_ = end;
    const hal::Duration passed = end - *first_sync_;
    const hal::Duration off = passed - (passed + period_ / 2) / period_ * period_;
    earliest_ = std::min(earliest_, off);
    latest_ = std::max(latest_, off);
  }

  hal::Time next_event(hal::Time latest) const {
    hal::Time next = std::min(latest, bus_.next_event());
    for (const auto& node : nodes_) next = std::min(next, node->drive->next_event().value_or(latest));
    return next;
  }

  virtual_bus::VirtualBus bus_;
  Port& controller_port_;
  std::vector<std::unique_ptr<Node>> nodes_;
  std::vector<TimedFrame>* log_ = nullptr;
  hal::Duration period_{}, earliest_{}, latest_{};
  std::optional<hal::Time> first_sync_;
};

}  // namespace breakaway::sil
