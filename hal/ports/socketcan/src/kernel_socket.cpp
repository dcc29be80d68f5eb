#include "breakaway/socketcan/kernel_socket.hpp"

#include <fcntl.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/if_arp.h>
#include <linux/net_tstamp.h>
#include <linux/sock_diag.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>

namespace breakaway::socketcan {
namespace {

// From its stamp, in the interrupt, to the socket.
constexpr hal::Duration longest_delivery = std::chrono::microseconds{100};

hal::Time to_time(const timespec& t) noexcept {
  return hal::Time{std::chrono::seconds{t.tv_sec} + hal::Duration{t.tv_nsec}};
}

hal::Time now_on(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return to_time(t);
}

template <class T>
bool set(int socket, int level, int option, const T& value) noexcept {
  return setsockopt(socket, level, option, &value, sizeof value) == 0;
}

Io failure(int error) noexcept {
  switch (error) {
    case ENETDOWN:
      return Io::down;
    case ENODEV:
    case ENXIO:
    case EBADF:
      return Io::gone;
    case EAGAIN:
    case ENOBUFS:
    case ENOMEM:
    case EINTR:
      return Io::again;
    default:
      return Io::refused;
  }
}

}  // namespace

OpenResult KernelSocket::open(const char* interface, std::span<const Filter> filters) noexcept {
  close();
  const std::size_t length = std::strlen(interface);
  if (length == 0 || length >= name_.size()) return OpenResult::no_such_interface;
  name_ = {};
  std::copy_n(interface, length, name_.begin());
  filter_count_ = std::min(filters.size(), most_filters);
  std::copy_n(filters.begin(), filter_count_, filters_.begin());
  return configure();
}

OpenResult KernelSocket::fail(OpenResult result) noexcept {
  error_number_ = errno;
  close();
  return result;
}

OpenResult KernelSocket::configure() noexcept {
  socket_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (socket_ < 0) {
    const bool permission = errno == EPERM || errno == EACCES;
    return fail(permission ? OpenResult::no_permission : OpenResult::no_can_support);
  }
  empty_at_ = now_on(CLOCK_MONOTONIC);
  lost_of_socket_ = 0;
  ifreq request{};
  std::copy(name_.begin(), name_.end(), request.ifr_name);
  if (ioctl(socket_, SIOCGIFINDEX, &request) != 0) return fail(OpenResult::no_such_interface);
  const int index = request.ifr_ifindex;
  if (ioctl(socket_, SIOCGIFHWADDR, &request) != 0) return fail(OpenResult::failed);
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN) return fail(OpenResult::not_can);
  if (ioctl(socket_, SIOCGIFFLAGS, &request) != 0) return fail(OpenResult::failed);
  if ((request.ifr_flags & IFF_UP) == 0) return fail(OpenResult::is_down);

  std::array<can_filter, most_filters> wanted{};
  for (std::size_t i = 0; i < filter_count_; ++i)
    wanted[i] = {filters_[i].id, filters_[i].mask | CAN_EFF_FLAG | CAN_RTR_FLAG};
  const auto bytes = static_cast<socklen_t>(filter_count_ * sizeof(can_filter));
  if (filter_count_ > 0 && setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, wanted.data(), bytes) != 0)
    return fail(OpenResult::failed);
  constexpr can_err_mask_t errors = CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
  constexpr int yes = 1;
  // Old kernels and some drivers lack time stamps and drop counters; there a frame is stamped when it is read.
  constexpr int stamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE | SOF_TIMESTAMPING_RX_HARDWARE |
                         SOF_TIMESTAMPING_RAW_HARDWARE;
  set(socket_, SOL_SOCKET, SO_TIMESTAMPING, stamps);
  set(socket_, SOL_SOCKET, SO_RXQ_OVFL, yes);
  if (!set(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors)) return fail(OpenResult::failed);

  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return fail(OpenResult::failed);

  std::array<char, 32 + IFNAMSIZ> path{};
  std::snprintf(path.data(), path.size(), "/sys/class/net/%s/carrier", name_.data());
  carrier_ = ::open(path.data(), O_RDONLY | O_CLOEXEC);
  return carrier_ < 0 ? fail(OpenResult::failed) : OpenResult::done;
}

bool KernelSocket::reopen() noexcept {
  close();
  return configure() == OpenResult::done;
}

void KernelSocket::close() noexcept {
  if (socket_ >= 0) ::close(socket_);
  if (carrier_ >= 0) ::close(carrier_);
  socket_ = carrier_ = -1;
}

Io KernelSocket::write(const can_frame& frame) const noexcept {
  const ssize_t written = ::send(socket_, &frame, sizeof frame, MSG_DONTWAIT);
  return written == static_cast<ssize_t>(sizeof frame) ? Io::done : failure(errno);
}

Io KernelSocket::read(can_frame& frame, hal::Time& received) noexcept {
  iovec place{.iov_base = &frame, .iov_len = sizeof frame};
  alignas(cmsghdr) std::array<char, 256> control;
  msghdr message{};
  message.msg_iov = &place;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const hal::Time asked_at = now_on(CLOCK_MONOTONIC);
  const ssize_t count = recvmsg(socket_, &message, MSG_DONTWAIT);
  if (count < 0 && errno == EAGAIN) empty_at_ = asked_at;
  if (count < 0) return failure(errno);
  if (count != static_cast<ssize_t>(sizeof frame)) return Io::again;
  const hal::Time now = now_on(CLOCK_MONOTONIC);
  received = now;
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_TIMESTAMPING) {
      received = when(part, now);
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      count_lost(part);
    }
  }
  return Io::done;
}

hal::Time KernelSocket::when(cmsghdr* part, hal::Time now) noexcept {
  scm_timestamping stamps{};
  std::memcpy(&stamps, CMSG_DATA(part), sizeof stamps);
  const hal::Time software = to_time(stamps.ts[0]), hardware = to_time(stamps.ts[2]);
  hal::Time time = now;
  if (software != hal::Time{})
    time = on_monotonic_clock(software, now_on(CLOCK_REALTIME), now, empty_at_ - longest_delivery);
  return hardware != hal::Time{} ? hardware_clock_.align(hardware, time) : time;
}

// The kernel counts modulo 2^32, and from 0 in a socket that was opened anew.
void KernelSocket::count_lost(cmsghdr* part) noexcept {
  std::uint32_t lost = 0;
  std::memcpy(&lost, CMSG_DATA(part), sizeof lost);
  lost_frames_ += lost - lost_of_socket_;
  lost_of_socket_ = lost;
}

std::size_t KernelSocket::unsent_bytes() const noexcept {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (getsockopt(socket_, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) != 0) return 0;
  return memory[SK_MEMINFO_WMEM_ALLOC];
}

// The carrier of a CAN interface goes away in bus-off, and cannot be read while the interface is down.
bool KernelSocket::on_bus() const noexcept {
  char carrier = '0';
  return pread(carrier_, &carrier, 1, 0) == 1 && carrier == '1';
}

}  // namespace breakaway::socketcan
