// The emulated drive with its axis as a process of its own, in real time on a CAN interface.
#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <memory>

#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/braked_slide.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "commands.hpp"

namespace breakaway::cli {
namespace {

struct DriveCommand {
  std::string scene, interface;
  unsigned node_id = 0;  // 0: the scene's
  double duration_s = 0;
  double mode_delay_s = 0;
  std::string supported_modes;
  bool realtime = false;
};

hal::Time monotonic_now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return hal::Time{std::chrono::seconds{t.tv_sec} + hal::Duration{t.tv_nsec}};
}

// A drive in real time: frames in at their time stamps, events at theirs.
class LiveDrive {
 public:
  LiveDrive(const scenario::Scenario& s, const drive_emulator::EmulatorConfig& config, socketcan::KernelSocket& socket)
      : socket_{socket},
        mechanism_{{s.plant.mass_kg, s.friction.law, {0.0, s.plant.position_m, s.plant.velocity_m_s}}},
        drive_{config, mechanism_, [this](const hal::CanFrame& frame, hal::Time) { transmit(frame); }} {
    drive_.power_on(hal::Time{});
  }

  // Until `stop` is set by a signal that interrupts ppoll under `mask`, or `duration` is over.
  void run(const volatile std::sig_atomic_t& stop, const sigset_t& mask, hal::Duration duration) {
    while (stop == 0 && passed() < hal::Time{duration}) {
      receive();
      drive_.advance_to(passed());
      release_brake();
      wait(mask, duration);
    }
    drive_.advance_mechanism_to(passed());
  }

  void print_summary() const {
    fmt::print("position {:.9g} m, {}, largest force {:.4g} N, {} frames lost\n", mechanism_.position_m(),
               mechanism_.slide().sticking() ? "at rest" : "moving", drive_.largest_force_N(last_), lost_);
  }

 private:
  // Never decreases, as the drive wants it.
  hal::Time passed() { return last_ = std::max(last_, since_start(monotonic_now())); }
  // The drive's time starts with this process.
  hal::Time since_start(hal::Time time) const { return hal::Time{time - start_}; }

  void receive() {
    can_frame in;
    hal::Time stamp{};
    for (auto result = socket_.read(in, stamp);; result = socket_.read(in, stamp)) {
      if (result == socketcan::Io::gone)
        throw InputError{"the CAN interface is gone; start this again when it is back"};
      if (result != socketcan::Io::done) return;
      const auto frame = socketcan::from_kernel(in);
      if (!frame) continue;
      last_ = std::max(last_, since_start(stamp));
      drive_.on_frame(*frame, last_);
    }
  }

  // The brake opens when the drive first holds the axis, so that setting it up does not count as motion.
  void release_brake() {
    if (!mechanism_.released() && drive_.state() == cia402::State::operation_enabled)
      mechanism_.release(hal::seconds(last_));
  }

  void wait(const sigset_t& mask, hal::Duration duration) {
    const hal::Time end{duration};
    const hal::Time until = std::min(end, drive_.next_event().value_or(end));
    const hal::Duration left = std::clamp<hal::Duration>(until - passed(), hal::Duration{0}, std::chrono::seconds{1});
    const timespec patience{.tv_sec = left / std::chrono::seconds{1},
                            .tv_nsec = (left % std::chrono::seconds{1}).count()};
    pollfd watched{.fd = socket_.descriptor(), .events = POLLIN, .revents = 0};
    ppoll(&watched, 1, &patience, &mask);
  }

  // A queue without room loses the frame, as it would in a drive.
  void transmit(const hal::CanFrame& frame) {
    if (socket_.write(socketcan::to_kernel(frame)) != socketcan::Io::done) ++lost_;
  }

  socketcan::KernelSocket& socket_;
  sil::BrakedSlide mechanism_;
  hal::Time start_ = monotonic_now();
  hal::Time last_{};
  std::uint64_t lost_ = 0;
  drive_emulator::DriveEmulator drive_;
};

volatile std::sig_atomic_t stop_wanted = 0;

// SIGINT and SIGTERM are delivered in ppoll only, so that none comes between the look and the wait.
sigset_t prepare_signals() {
  sigset_t blocked, before;
  sigemptyset(&blocked);
  for (const int signal : {SIGINT, SIGTERM}) {
    sigaddset(&blocked, signal);
    std::signal(signal, [](int) { stop_wanted = 1; });
  }
  sigprocmask(SIG_BLOCK, &blocked, &before);
  return before;
}

// Below the controller, which must not wait for the drive that it commands.
void become_realtime() {
  constexpr int priority = 70;
  const sched_param wanted{.sched_priority = priority};
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0 || sched_setscheduler(0, SCHED_FIFO, &wanted) != 0)
    throw InputError{
        fmt::format("--realtime: {}; run as root, or raise rtprio and memlock in limits.conf", std::strerror(errno))};
}

drive_emulator::EmulatorConfig drive_config(const scenario::Scenario& s, const DriveCommand& options) {
  drive_emulator::EmulatorConfig config = *s.drive;
  if (options.node_id != 0) config.node_id = static_cast<std::uint8_t>(options.node_id);
  if (!options.supported_modes.empty())
    config.supported_modes = static_cast<std::uint32_t>(std::stoul(options.supported_modes, nullptr, 16));
  config.quirks.mode_display_delay = hal::Duration{std::llround(options.mode_delay_s * 1e9)};
  return config;
}

int drive_scene(const DriveCommand& options) {
  const scenario::Scenario s = scenario::read_scenario(options.scene);
  if (!s.drive) throw InputError{options.scene + ": has no [drive]; give a scene with a drive on a bus"};
  socketcan::KernelSocket socket;
  const auto opened = socket.open(options.interface.c_str(), {});
  if (opened != socketcan::OpenResult::done)
    throw InputError{fmt::format("{}: {}", options.interface, to_string(opened))};
  const sigset_t mask = prepare_signals();
  if (options.realtime) become_realtime();
  const drive_emulator::EmulatorConfig config = drive_config(s, options);
  LiveDrive drive{s, config, socket};
  fmt::print("drive {} on {}\n", config.node_id, options.interface);
  std::fflush(stdout);
  const double duration_s = options.duration_s > 0 ? options.duration_s : 1e9;
  drive.run(stop_wanted, mask, hal::Duration{std::llround(duration_s * 1e9)});
  drive.print_summary();
  return done;
}

}  // namespace

void add_drive(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<DriveCommand>();
  CLI::App* command = app.add_subcommand("drive", "Emulate a drive with its axis on a CAN interface, in real time");
  command->add_option("scene", options->scene, "The scene: its [plant], [friction] and [drive]")->required();
  command->add_option("--can", options->interface, "The CAN interface, can0 or vcan0, say")->required();
  command->add_option("--node-id", options->node_id, "CANopen node id instead of the scene's")
      ->check(CLI::Range(1, 127));
  command->add_option("--duration", options->duration_s, "Seconds until it ends; without, SIGINT or SIGTERM ends it")
      ->check(positive_number);
  command->add_flag("--realtime", options->realtime, "Lock the memory and run at real-time priority 70");
  command
      ->add_option("--supported-modes", options->supported_modes,
                   "What 6502h shows, hexadecimal; without bit 9 the drive has no cyclic synchronous torque mode")
      ->check(CLI::Validator{[](std::string& text) -> std::string {
                               const bool good = !text.empty() && text.size() <= 8 &&
                                                 text.find_first_not_of("0123456789abcdefABCDEF") == text.npos;
                               return good ? "" : text + " is not a hexadecimal number of at most 8 digits";
                             },
                             ""});
  command
      ->add_option("--mode-delay", options->mode_delay_s,
                   "Seconds for which 6061h shows no mode after one was requested")
      ->check(positive_number);
  command->footer(std::string{"Example: breakaway drive --can vcan0 sim/scenarios/can_axis.toml\n"
                              "and, in another terminal: breakaway-node --can vcan0 sim/scenarios/can_axis.toml\n"} +
                  exit_codes);
  command->callback([options, &exit_code] { exit_code = drive_scene(*options); });
}

}  // namespace breakaway::cli
