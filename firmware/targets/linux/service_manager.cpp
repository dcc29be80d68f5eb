#include "service_manager.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "breakaway/input/input_error.hpp"

namespace breakaway::linux_node {
namespace {

InputError unreachable(std::string_view name, std::string_view why) {
  return InputError{fmt::format(
      "NOTIFY_SOCKET={}: {}; start the node by a service manager, or unset the variable (`env -u NOTIFY_SOCKET`)", name,
      why)};
}

// A socket that is connected to the manager's and never waits.
int connected(std::string_view name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name.empty() || (name.front() != '/' && name.front() != '@'))
    throw unreachable(name, "is neither a path nor @ and an abstract name");
  if (name.size() >= sizeof address.sun_path) throw unreachable(name, "is longer than the name of a socket may be");
  std::memcpy(address.sun_path, name.data(), name.size());
  if (name.front() == '@') address.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket >= 0 && connect(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0) return socket;
  const int error = errno;
  if (socket >= 0) close(socket);
  throw unreachable(name, std::strerror(error));
}

std::optional<std::int64_t> number(const char* text) {
  const char* const end = text + std::strlen(text);
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(text, end, value);
  if (error != std::errc{} || rest != end) return {};
  return value;
}

// Nothing where the manager expects no sign of life, or expects it of another process.
std::optional<hal::Duration> watchdog_time(const ServiceEnvironment& environment, hal::Duration period) {
  if (environment.watchdog_us == nullptr) return {};
  if (environment.watchdog_pid != nullptr && number(environment.watchdog_pid) != std::int64_t{getpid()}) return {};
  const auto time = number(environment.watchdog_us);
  const std::int64_t least_us = (2 * period + std::chrono::milliseconds{100}) / std::chrono::microseconds{1};
  constexpr std::int64_t longest_us = 86'400'000'000;
  if (!time || *time < least_us || *time > longest_us)
    throw InputError{
        fmt::format("WATCHDOG_USEC={}: is no number of microseconds from {} to {}; WatchdogSec= of the unit sets it",
                    environment.watchdog_us, least_us, longest_us)};
  return std::chrono::microseconds{*time};
}

}  // namespace

ServiceEnvironment service_environment() noexcept {
  return {std::getenv("NOTIFY_SOCKET"), std::getenv("WATCHDOG_USEC"), std::getenv("WATCHDOG_PID")};
}

ServiceManager::ServiceManager(const ServiceEnvironment& environment, hal::Duration period) {
  if (environment.notify_socket == nullptr) return;
  watchdog_ = watchdog_time(environment, period);
  socket_ = connected(environment.notify_socket);
}

ServiceManager::~ServiceManager() {
  if (present()) close(socket_);
}

void ServiceManager::poll(hal::Time now, const Telemetry& telemetry, std::string_view status) {
  if (!present()) return;
  Told next{.ready = telemetry.ready,
            .stopping = telemetry.stopping,
            .status = std::string{status},
            .alive_at = told_.alive_at};
  std::string text;
  if (next.ready && !told_.ready) text += "READY=1\n";
  if (next.stopping && !told_.stopping) text += "STOPPING=1\n";
  if (next.status != told_.status) text += "STATUS=" + next.status + "\n";
  const bool alive = std::exchange(periods_, telemetry.periods) != telemetry.periods;
  if (alive && sign_of_life_is_due(now)) {
    text += "WATCHDOG=1\n";
    next.alive_at = now;
  }
  if (!text.empty() && send(text)) told_ = std::move(next);
}

bool ServiceManager::sign_of_life_is_due(hal::Time now) const {
  return watchdog_ && (!told_.alive_at || now - *told_.alive_at >= *watchdog_ / 2);
}

bool ServiceManager::send(std::string_view text) const noexcept {
  return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
}

}  // namespace breakaway::linux_node
