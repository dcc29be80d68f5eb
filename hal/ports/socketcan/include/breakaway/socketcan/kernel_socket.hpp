// KernelSocket: a CAN_RAW socket on one interface, with kernel filters, error frames and receive time stamps. It models
// RawSocket of port.hpp.
#pragma once

#include <net/if.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "breakaway/socketcan/hardware_clock.hpp"
#include "breakaway/socketcan/port.hpp"

namespace breakaway::socketcan {

// Filter: passes a data frame with an 11-bit identifier for which (identifier & mask) == (id & mask).
struct Filter {
  std::uint16_t id = 0;
  std::uint16_t mask = 0;
};

enum class OpenResult : std::uint8_t {
  done,
  no_can_support,     // the kernel lacks AF_CAN or CAN_RAW
  no_such_interface,  // or the name cannot be one
  not_can,
  is_down,
  no_permission,
  failed,  // error_number() says why
};

// The sentences tell the remedy and follow the interface's name.
constexpr std::string_view to_string(OpenResult result) noexcept {
  switch (result) {
    case OpenResult::done:
      return "open";
    case OpenResult::no_can_support:
      return "this kernel has no CAN sockets: load them with `modprobe can_raw`, or boot a kernel that has "
             "CONFIG_CAN_RAW";
    case OpenResult::no_such_interface:
      return "there is no such interface: `ip -br link` lists those there are; a virtual one is made by `ip link add "
             "dev vcan0 type vcan`";
    case OpenResult::not_can:
      return "is not a CAN interface: `ip -br link show type can` and `type vcan` list those";
    case OpenResult::is_down:
      return "is down: as root, `ip link set NAME type can bitrate 1000000` (not for vcan), then `ip link set NAME up`";
    case OpenResult::no_permission:
      return "may not be opened by this user: run as root or grant CAP_NET_RAW";
    case OpenResult::failed:
      return "cannot be used as a CAN interface";
  }
  return "unknown result";
}

class KernelSocket {
 public:
  static constexpr std::size_t most_filters = 16;

  KernelSocket() noexcept = default;
  KernelSocket(const KernelSocket&) = delete;
  KernelSocket& operator=(const KernelSocket&) = delete;
  ~KernelSocket() { close(); }

  // Opens the interface. Without filters every frame is received; if there are more than most_filters, the first ones
  // count. Own frames are not received.
  OpenResult open(const char* interface, std::span<const Filter> filters) noexcept;
  int error_number() const noexcept { return error_number_; }
  // The descriptor is for poll(2).
  int descriptor() const noexcept { return socket_; }

  // RawSocket; see port.hpp for what the calls promise.

  Io write(const can_frame& frame) const noexcept;
  Io read(can_frame& frame, hal::Time& received) noexcept;
  std::size_t unsent_bytes() const noexcept;
  bool on_bus() const noexcept;
  bool reopen() noexcept;
  std::uint64_t lost_frames() const noexcept { return lost_frames_; }

 private:
  OpenResult configure() noexcept;
  hal::Time when(cmsghdr* part, hal::Time now) noexcept;
  void count_lost(cmsghdr* part) noexcept;
  OpenResult fail(OpenResult result) noexcept;
  void close() noexcept;

  std::array<char, IFNAMSIZ> name_{};
  std::array<Filter, most_filters> filters_{};
  std::size_t filter_count_ = 0;
  int socket_ = -1;
  int carrier_ = -1;  // /sys/class/net/<name>/carrier
  int error_number_ = 0;
  std::uint64_t lost_frames_ = 0;
  std::uint32_t lost_of_socket_ = 0;  // as the kernel counted them last, from when this socket was opened
  hal::Time empty_at_{};  // when nothing waited to be read; what is read later reached the socket after that
  HardwareClock hardware_clock_;
};

static_assert(hal::CanPort<Port<KernelSocket>>);

}  // namespace breakaway::socketcan
