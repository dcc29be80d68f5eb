// Drives an axis with a controller that speaks slcan on a socket, and compares the run with the same node in this
// process.
//   emulated_axis SOCKET
// Exit codes: 0 every frame is equal and the axis rests on its target; 1 not so; 2 no controller at the socket.
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <exception>
#include <thread>

#include "closed_loop.hpp"

namespace breakaway::emulated {
namespace {

class Socket {
 public:
  // Tries for ten seconds: the other side may still be starting.
  explicit Socket(const std::string& path) : handle_{socket(AF_UNIX, SOCK_STREAM, 0)} {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) throw std::runtime_error("the socket's name is too long: " + path);
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    for (int tries = 0; connect(handle_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0; ++tries) {
      if (tries == 100) throw std::runtime_error("nobody listens at " + path);
      std::this_thread::sleep_for(std::chrono::milliseconds{100});
    }
    const timeval patience{.tv_sec = 20, .tv_usec = 0};
    setsockopt(handle_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() { close(handle_); }

  std::string_view read() {
    const ssize_t count = recv(handle_, buffer_.data(), buffer_.size(), 0);
    if (count <= 0) throw std::runtime_error("the controller fell silent");
    return {buffer_.data(), static_cast<std::size_t>(count)};
  }
  void write(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t count = send(handle_, text.data(), text.size(), MSG_NOSIGNAL);
      if (count <= 0) throw std::runtime_error("the controller hung up");
      text.remove_prefix(static_cast<std::size_t>(count));
    }
  }

 private:
  int handle_;
  std::array<char, 4096> buffer_{};
};

void report(const char* who, const SlcanWorld& world, double error_m) {
  fmt::print("{:<9} {} periods, {} frames, hash {:016x}, final error {:.3g} m, {}\n", who, world.periods(),
             world.frames().size(), world.frame_hash(), error_m, world.sticking() ? "at rest" : "moving");
}

int run(const std::string& path) {
  const scenario::Scenario s = bench::axis_scenario();
  SlcanWorld here{s};
  Commander commander_here{s};
  run_node_here(here, commander_here);
  const double error_here_m = here.position_m() - commander_here.target_m();
  report("host", here, error_here_m);

  SlcanWorld there{s};
  Commander commander{s};
  Socket socket{path};
  while (!commander.finished()) socket.write(converse(there, commander, socket.read()));
  report("emulated", there, there.position_m() - commander.target_m());

  const bool equal = there.frame_hash() == here.frame_hash() && there.positions_m() == here.positions_m();
  const bool settled = there.sticking() && std::abs(error_here_m) <= s.node.settle_tolerance_m;
  fmt::print("{}: every frame and position is {}\n", equal && settled ? "PASS" : "FAIL", equal ? "equal" : "NOT equal");
  return equal && settled ? 0 : 1;
}

}  // namespace
}  // namespace breakaway::emulated

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: emulated_axis SOCKET\n");
    return 2;
  }
  try {
    return breakaway::emulated::run(argv[1]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "emulated_axis: {}\n", error.what());
    return 2;
  }
}
