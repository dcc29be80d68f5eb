#include "breakaway/watch/bus_source.hpp"

#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "breakaway/watch/bus_listener.hpp"
#include "breakaway/watch/commander.hpp"

namespace breakaway::watch {
namespace {

using namespace std::chrono_literals;

hal::Time monotonic_now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return hal::Time{std::chrono::seconds{t.tv_sec} + hal::Duration{t.tv_nsec}};
}

config::Node read_flashable(const std::string& file) {
  config::Node node = config::read_node(file);
  config::require_flashable(node);
  return node;
}

class WatchedBus final : public BusSource {
 public:
  WatchedBus(const std::string& interface, const std::string& node_file, bool control, History& history)
      : interface_{interface},
        node_{read_flashable(node_file)},
        history_{history},
        listener_{node_},
        commander_{node_, listener_} {
    const auto result = socket_.open(interface.c_str(), {});
    if (result != socketcan::OpenResult::done) throw InputError{fmt::format("{}: {}", interface, to_string(result))};
    thread_ = std::jthread{[this, control](const std::stop_token& stop) { run(stop, control); }};
  }

  std::string description() const override { return fmt::format("{} on {}", node_.file, interface_); }

  std::vector<std::string> axes() const override { return listener_.axes(); }

  std::string obey(const Command& command) override {
    const std::scoped_lock lock{mutex_};
    return commander_.obey(command, monotonic_now());
  }

  void page_is_seen() override {
    const std::scoped_lock lock{mutex_};
    commander_.page_is_seen(monotonic_now());
  }

 private:
  // Shorter than what a full bus needs to fill the socket, and than any interval of commands.
  static constexpr auto interval = 2ms;

  void run(const std::stop_token& stop, bool control) {
    while (!stop.stop_requested()) {
      port_.poll(monotonic_now());
      receive();
      if (control) command();
      note_link();
      std::this_thread::sleep_for(interval);
    }
    if (!control) return;
    send(commander_.farewell());
    // The port hands over what the kernel had no room for.
    for (int n = 0; n < 10; ++n, std::this_thread::sleep_for(interval)) port_.poll(monotonic_now());
  }

  void receive() {
    for (hal::ReceivedFrame received; port_.receive(received);) {
      const std::scoped_lock lock{mutex_};
      if (auto sample = listener_.on_frame(received)) history_.add(*std::move(sample));
    }
  }

  void command() {
    const std::scoped_lock lock{mutex_};
    send(commander_.due(monotonic_now()));
  }

  void send(const std::vector<hal::CanFrame>& frames) {
    constexpr auto patience = 50ms;
    for (const hal::CanFrame& frame : frames) static_cast<void>(port_.send(frame, monotonic_now() + patience));
  }

  void note_link() {
    const bool lost = port_.link_lost();
    if (lost && !link_lost_)
      history_.complain(fmt::format("{}: {}", interface_, to_string(socketcan::OpenResult::is_down)));
    link_lost_ = lost;
  }

  std::string interface_;
  config::Node node_;
  History& history_;
  std::mutex mutex_;  // of listener and commander
  BusListener listener_;
  Commander commander_;
  socketcan::KernelSocket socket_;
  socketcan::Port<socketcan::KernelSocket> port_{socket_};
  bool link_lost_ = false;
  std::jthread thread_;
};

}  // namespace

std::unique_ptr<BusSource> watch_bus(const std::string& interface, const std::string& node_file, bool control,
                                     History& history) {
  return std::make_unique<WatchedBus>(interface, node_file, control, history);
}

}  // namespace breakaway::watch
