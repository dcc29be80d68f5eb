// The axes of a node from set-up to stop: the control loop once a period, and what the operator wants of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/socketcan/kernel_socket.hpp"
#include "configuration.hpp"
#include "drive_run.hpp"
#include "options.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

// Flashed: config::AnyNode<float>, config::WorkNode<float> or config::MachineNode<float>. Side: as of DriveRun.
template <class Flashed, class Side>
class NodeRun : private DriveRun<Flashed, Side> {
 public:
  // All arguments must outlive it.
  NodeRun(const Flashed& flashed, const Configuration& configuration, const Options& options,
          socketcan::KernelSocket& socket, Telemetry& telemetry);

  // Until the operator or --duration ends it; the axes are stopped then. Nothing in it waits but for the next tick.
  // Throws InputError, before anything moved, when a drive cannot be used or another master is on the bus.
  ExitCode run();

  // What happened, in lines; after run().
  std::string report() const;

 private:
  using Base = DriveRun<Flashed, Side>;
  using Base::axes_, Base::c_, Base::loop_, Base::now_, Base::options_, Base::telemetry_;
  using Base::ended_well, Base::figures, Base::last_words, Base::stop_text;
  using Base::get_ready, Base::enable, Base::step, Base::stop;
  using Base::plan, Base::status;

  struct Trip {
    std::size_t visit = 0;
    std::optional<hal::Time> enabled_since{};
    bool reached = false;
  };

  void refuse_far_targets();
  void move();
  void follow_times();
  void follow_tour();
  void visit(std::size_t place, std::size_t visit);
  bool holds(std::size_t place) const;
  bool all_hold() const;
  bool rests_on_target(std::size_t place) const;

  std::vector<Trip> trips_;                 // of the axes
  std::optional<hal::Time> resting_since_;  // all axes, on a tour
};

}  // namespace breakaway::linux_node
