// The calls of kernel_socket.cpp, defined in this program in place of the C library's. What does not concern the fake
// goes on to the system.
#include "fake_kernel.hpp"

#include <fcntl.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstring>

namespace breakaway::socketcan_test {

FakeKernel& kernel() {
  static FakeKernel one;
  return one;
}

bool FakeKernel::fails(Step step) const {
  if (failing != step) return false;
  errno = error;
  return true;
}

namespace {

int opened() {
  const int descriptor = kernel().first_descriptor + kernel().descriptor_step * static_cast<int>(kernel().open.size());
  kernel().open.insert(descriptor);
  return descriptor;
}

void add_part(msghdr& message, std::size_t& used, int type, const void* data, std::size_t size) {
  auto* const part = reinterpret_cast<cmsghdr*>(static_cast<char*>(message.msg_control) + used);
  part->cmsg_level = SOL_SOCKET;
  part->cmsg_type = type;
  part->cmsg_len = CMSG_LEN(size);
  std::memcpy(CMSG_DATA(part), data, size);
  used += CMSG_SPACE(size);
}

}  // namespace
}  // namespace breakaway::socketcan_test

using breakaway::socketcan_test::FakeKernel;
using breakaway::socketcan_test::kernel;

extern "C" {

int socket(int domain, int type, int protocol) noexcept {
  if (domain != PF_CAN) return static_cast<int>(syscall(SYS_socket, domain, type, protocol));
  if (kernel().fails(FakeKernel::socket)) return -1;
  return breakaway::socketcan_test::opened();
}

int ioctl(int descriptor, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (!kernel().open.contains(descriptor)) return static_cast<int>(syscall(SYS_ioctl, descriptor, request, argument));
  auto& interface = *static_cast<ifreq*>(argument);
  switch (request) {
    case SIOCGIFINDEX:
      kernel().names.emplace_back(interface.ifr_name);
      if (kernel().fails(FakeKernel::index)) return -1;
      interface.ifr_ifindex = 7;
      return 0;
    case SIOCGIFHWADDR:
      if (kernel().fails(FakeKernel::type)) return -1;
      interface.ifr_hwaddr.sa_family = static_cast<sa_family_t>(kernel().interface_type);
      return 0;
    case SIOCGIFFLAGS:
      if (kernel().fails(FakeKernel::flags)) return -1;
      interface.ifr_flags = kernel().interface_flags;
      return 0;
    default:
      errno = EINVAL;
      return -1;
  }
}

int setsockopt(int descriptor, int level, int option, const void* value, socklen_t size) noexcept {
  FakeKernel& k = kernel();
  if (!k.open.contains(descriptor))
    return static_cast<int>(syscall(SYS_setsockopt, descriptor, level, option, value, size));
  if (level == SOL_CAN_RAW && option == CAN_RAW_FILTER) {
    if (k.fails(FakeKernel::filters)) return -1;
    ++k.filter_calls;
    k.filters_set.resize(size / sizeof(can_filter));
    std::memcpy(k.filters_set.data(), value, size);
  } else if (level == SOL_CAN_RAW && option == CAN_RAW_ERR_FILTER) {
    if (k.fails(FakeKernel::errors)) return -1;
    std::memcpy(&k.errors_wanted, value, sizeof k.errors_wanted);
  } else if (level == SOL_SOCKET) {
    std::memcpy(option == SO_RXQ_OVFL ? &k.drops_counted : &k.stamps_wanted, value, sizeof(int));
  }
  return 0;
}

int getsockopt(int descriptor, int level, int option, void* value, socklen_t* size) noexcept {
  if (!kernel().open.contains(descriptor))
    return static_cast<int>(syscall(SYS_getsockopt, descriptor, level, option, value, size));
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  memory[SK_MEMINFO_WMEM_ALLOC] = kernel().unsent_bytes;
  std::memcpy(value, memory.data(), sizeof memory);
  errno = kernel().memory_error;
  return kernel().memory_error == 0 ? 0 : -1;
}

int bind(int descriptor, const sockaddr* address, socklen_t size) noexcept {
  if (!kernel().open.contains(descriptor)) return static_cast<int>(syscall(SYS_bind, descriptor, address, size));
  if (kernel().fails(FakeKernel::bound)) return -1;
  sockaddr_can given{};
  std::memcpy(&given, address, sizeof given);
  kernel().family = given.can_family;
  kernel().bound_index = given.can_ifindex;
  return 0;
}

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const unsigned mode = (flags & O_CREAT) != 0 ? va_arg(arguments, unsigned) : 0U;
  va_end(arguments);
  if (std::strncmp(path, "/sys/class/net/", 15) != 0)
    return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
  kernel().carrier_path = path;
  if (kernel().fails(FakeKernel::carrier)) return -1;
  return breakaway::socketcan_test::opened();
}

int close(int descriptor) {
  if (kernel().open.erase(descriptor) > 0) return 0;
  if (descriptor < 3) {
    ++kernel().closed_of_others;
    return 0;
  }
  return static_cast<int>(syscall(SYS_close, descriptor));
}

ssize_t send(int descriptor, const void* data, size_t size, int flags) {
  FakeKernel& k = kernel();
  if (!k.open.contains(descriptor)) return syscall(SYS_sendto, descriptor, data, size, flags, nullptr, 0);
  errno = k.send_error;
  if (k.send_error != 0) return k.cuts_frames ? 4 : -1;
  can_frame frame{};
  std::memcpy(&frame, data, sizeof frame);
  k.sent.push_back(frame);
  return static_cast<ssize_t>(size);
}

ssize_t recvmsg(int descriptor, msghdr* message, int flags) {
  FakeKernel& k = kernel();
  if (!k.open.contains(descriptor)) return syscall(SYS_recvmsg, descriptor, message, flags);
  errno = k.receive_error;
  if (k.incoming.empty()) return -1;
  if (message->msg_iovlen != 1 || message->msg_controllen < 128) return 0;
  const auto received = k.incoming.front();
  k.incoming.pop_front();
  std::memcpy(message->msg_iov->iov_base, &received.frame, received.size);
  std::size_t used = 0;
  using breakaway::socketcan_test::add_part;
  if (received.software || received.hardware) {
    scm_timestamping stamps{};
    if (received.software) stamps.ts[0] = *received.software;
    if (received.hardware) stamps.ts[2] = *received.hardware;
    add_part(*message, used, SO_TIMESTAMPING, &stamps, sizeof stamps);
  }
  if (received.lost) add_part(*message, used, SO_RXQ_OVFL, &*received.lost, sizeof *received.lost);
  message->msg_controllen = used;
  return static_cast<ssize_t>(received.size);
}

ssize_t pread(int descriptor, void* data, size_t size, off_t offset) {
  if (!kernel().open.contains(descriptor)) return syscall(SYS_pread64, descriptor, data, size, offset);
  if (!kernel().carrier_shown || offset != 0 || size != 1) return -1;
  *static_cast<char*>(data) = *kernel().carrier_shown;
  return 1;
}

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  if (kernel().open.empty()) return static_cast<int>(syscall(SYS_clock_gettime, clock, time));
  *time = clock == CLOCK_REALTIME ? kernel().wall : kernel().monotonic;
  return 0;
}

}  // extern "C"
