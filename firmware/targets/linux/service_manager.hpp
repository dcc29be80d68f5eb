// What a service manager is told of the node, in the protocol of sd_notify(3): that it is ready, that it lives, that it
// stops, and a line of status.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "breakaway/hal/time.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

// As the manager set them; nullptr: it did not.
struct ServiceEnvironment {
  const char* notify_socket = nullptr;  // NOTIFY_SOCKET: a path, or @ and an abstract name
  const char* watchdog_us = nullptr;    // WATCHDOG_USEC
  const char* watchdog_pid = nullptr;   // WATCHDOG_PID
};

// Reads the environment of this process.
ServiceEnvironment service_environment() noexcept;

class ServiceManager {
 public:
  // period: of the control thread. Throws InputError: the socket cannot be reached, or the time of the watchdog is none
  // or too short for a sign of life, for which it takes 0.1 s and two periods. Without NOTIFY_SOCKET there is no
  // manager, and nobody is told anything.
  ServiceManager(const ServiceEnvironment& environment, hal::Duration period);
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;
  ~ServiceManager();

  bool present() const noexcept { return socket_ >= 0; }

  // Tells what is new, and that the node lives, twice in the time of the watchdog. It lives when the control thread
  // began a period since the last call: a loop that stands still ends the sign of life, and so does a caller that no
  // longer calls, some 50 times a second. Every call is one attempt that does not wait; what the manager did not take
  // is told again. status: one line.
  void poll(hal::Time now, const Telemetry& telemetry, std::string_view status);

 private:
  struct Told {
    bool ready = false, stopping = false;
    std::string status;
    std::optional<hal::Time> alive_at{};
  };

  bool sign_of_life_is_due(hal::Time now) const;
  bool send(std::string_view text) const noexcept;

  int socket_ = -1;
  std::optional<hal::Duration> watchdog_;
  Told told_;
  std::uint64_t periods_ = 0;  // of the control thread, at the last call
};

}  // namespace breakaway::linux_node
