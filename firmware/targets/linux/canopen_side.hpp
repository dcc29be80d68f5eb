// CanopenSide: what a run of drives does and says otherwise for CiA 402 than for another protocol.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/node_objects.hpp"
#include "breakaway/firmware/served_port.hpp"
#include "breakaway/hal/network_config.hpp"
#include "configuration.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

struct CanopenSide {
  using Drive = cia402::Drive<float>;
  // The node answers whoever reads its objects.
  template <class Port>
  using Served = firmware::ServedPort<Port>;
  template <class Loop, class Flashed>
  using Objects = firmware::NodeObjects<Loop, Flashed>;

  static constexpr bool is_canopen = true;
  static constexpr const char* stop_means = "PDO, SDO and NMT";

  static bool was_heard(const Drive& drive) { return drive.nmt_state().has_value(); }
  static hal::Duration extra_setup_time(const Drive& drive) { return drive.extra_setup_time(); }
  // The node that is alive, as the frame shows.
  static std::optional<std::uint8_t> heard_node(const hal::CanFrame& frame);
  // Who else commands these nodes, as the frame shows; empty: it shows nothing of that.
  static std::string other_master(const hal::CanFrame& frame, const hal::NetworkConfig& network,
                                  std::span<const std::uint8_t> nodes);
  // Why the drive is refused, with the remedy.
  static std::string why_unusable(const Drive& drive);
  // Why a drive that answers does not get ready.
  static std::string why_standing(const Drive& drive);
  static void note(const Drive& drive, StepRecord& step);
  // What is to be said of the drive at the end, in a line; empty: nothing.
  static std::string last_words(const Drive& drive, const AxisPlan& plan);
};

}  // namespace breakaway::linux_node
