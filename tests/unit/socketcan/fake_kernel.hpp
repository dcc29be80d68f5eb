// A kernel with one CAN interface, in place of the system's calls: a machine for tests may have no CAN.
#pragma once

#include <linux/can.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/socket.h>
#include <sys/types.h>

#include <cstdint>
#include <ctime>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace breakaway::socketcan_test {

struct Reception {
  can_frame frame{};
  std::size_t size = sizeof(can_frame);
  std::optional<timespec> software, hardware;  // stamps
  std::optional<std::uint32_t> lost;           // frames, as the socket counts them
};

struct FakeKernel {
  enum Step { socket, index, type, flags, filters, errors, bound, carrier, steps };

  int failing = steps;  // this step of open() fails
  int error = 0;        // with this errno
  int first_descriptor = 1000, descriptor_step = 1;
  int interface_type = ARPHRD_CAN;
  short interface_flags = IFF_UP;
  std::optional<char> carrier_shown = '1';  // nothing: it cannot be read
  int send_error = 0, receive_error = EAGAIN, memory_error = 0;
  bool cuts_frames = false;
  std::uint32_t unsent_bytes = 0;
  std::deque<Reception> incoming;
  timespec monotonic{100, 0}, wall{5000, 0};

  std::vector<std::string> names;  // of interfaces that were asked for
  std::vector<can_filter> filters_set;
  int filter_calls = 0;
  std::uint32_t errors_wanted = 0;
  int stamps_wanted = 0, drops_counted = 0;
  int family = 0, bound_index = 0;
  std::string carrier_path;
  std::vector<can_frame> sent;
  std::set<int> open;
  int closed_of_others = 0;  // descriptors that were not opened here

  bool fails(Step step) const;
};

// That which the calls reach; a test sets it anew.
FakeKernel& kernel();

}  // namespace breakaway::socketcan_test
