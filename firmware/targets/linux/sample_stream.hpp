// The samples of a run for programs that plot while it goes on: PlotJuggler's UDP server, or `breakaway watch`.
//
// One datagram holds one sample of one axis as a flat JSON object of numbers, for example
//
//   {"timestamp":1763870000.123456,"sample":17,"dropped":0,"latency_us":4.2,"target_m":0.25,"position_m":0.1, ... }
//
//   timestamp    s since 1970, of the period in which the sample was taken: by CLOCK_REALTIME as the node started, and
//                by CLOCK_MONOTONIC from then on, so that a step of the wall clock moves no sample
//   sample       number of the datagram: one that is left out was lost on its way
//   dropped      samples that were not sent until now
//   latency_us   by which the loop's thread woke late in this period
//   bus_load     share of the bus' bit rate that the frames of this node and its drives took lately, 0 to 1
//   target_m, position_m, error_m, command_N, reported_N
//   mode         law::Mode           drive   hal::DriveState
//   fault        firmware::AxisFault fault_code   of the drive, as its EMCY has it
//   stop_not_obeyed, link_lost       1: so it is
//
// What is not known is left out: mode and command of a drive that is only listened to, what is not a number. Where the
// node has several axes, the names from target_m on begin with the axis': "x/position_m".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "configuration.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

// What a datagram says beside its sample.
struct StreamContext {
  hal::Duration since_epoch{};  // of the sample
  std::uint64_t number = 0, dropped = 0;
  double bus_load = 0;
};

// The datagram's content. `axis`: the name that stands before its numbers; empty where there is one axis only.
std::string encode_sample(const StepRecord& step, double resolution_m, std::string_view axis,
                          const StreamContext& context);

class SampleStream {
 public:
  // `destination`: udp:HOST:PORT, HOST a name or an address, of IPv6 in brackets. `axes` must outlive this.
  // Throws InputError: the text is no destination, or there is no way to it.
  SampleStream(const std::string& destination, const std::vector<AxisPlan>& axes);
  SampleStream(const SampleStream&) = delete;
  SampleStream& operator=(const SampleStream&) = delete;
  ~SampleStream();

  // Sends a sample, or drops it where there is no room or nobody listens; it never waits. `lost`: the records that the
  // control thread's ring had no room for.
  void send(const StepRecord& step, hal::Duration since_epoch, double bus_load, std::uint64_t lost);

  // What was sent and what was not, in a line; `lost` as above.
  std::string report(std::uint64_t lost) const;

 private:
  const std::vector<AxisPlan>& axes_;
  std::string destination_;
  int socket_ = -1;
  std::uint64_t number_ = 0, refused_ = 0;
};

}  // namespace breakaway::linux_node
