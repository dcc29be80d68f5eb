// The emulated drives with their axes as a process of its own, in real time on a CAN interface.
#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/odrive/messages.hpp"
#include "breakaway/odrive_emulator/odrive_emulator.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "commands.hpp"
#include "drive_config.hpp"

namespace breakaway::cli {
namespace {

struct DriveCommand {
  std::string scenario, axis, interface;
  double duration_s = 1e9;  // without the option: until a signal
  DriveChanges changes;
  bool realtime = false;
};

// Of a step of the motion, where the scenario asks for nothing else. The finest, which a simulation takes, costs twice
// as much where load and motor stick and slip in turn, more than a period on a slow processor: in real time an answer
// that comes late is worse than one whose tenth digit is wrong.
constexpr double usual_tolerance = 1e-8;

hal::Time now_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return hal::Time{std::chrono::seconds{t.tv_sec} + hal::Duration{t.tv_nsec}};
}

hal::Time monotonic_now() { return now_of(CLOCK_MONOTONIC); }

// Of this thread: stands still while another has the processor.
hal::Time processor_now() { return now_of(CLOCK_THREAD_CPUTIME_ID); }

// Drives with their axes in real time: frames in at their time stamps, events at theirs.
class LiveDrives {
 public:
  // `configs` has one for each axis of the scenario.
  LiveDrives(const scenario::Scenario& s, const std::vector<DriveConfig>& configs, socketcan::KernelSocket& socket)
      : socket_{socket} {
    auto mechanisms = sil::axis_mechanisms(s);
    for (std::size_t i = 0; i < configs.size(); ++i)
      axes_.emplace_back(*this, s.node.axes[i].name, std::move(mechanisms[i]), configs[i]);
  }

  // Until `stop` is set by a signal that interrupts ppoll under `mask`, or `duration` is over.
  void run(const volatile std::sig_atomic_t& stop, const sigset_t& mask, hal::Duration duration) {
    while (stop == 0 && passed() < hal::Time{duration}) {
      const hal::Time woken = passed(), processor_woken = processor_now();
      receive();
      // No further: a frame that has come since woken is played at its stamp, in the next round.
      last_ = std::max(last_, woken);
      for (Axis& axis : axes_) axis.advance_to(last_);
      note_work(woken, processor_now() - processor_woken);
      wait(mask, duration);
    }
    last_ = std::max(last_, passed());
    for (Axis& axis : axes_) axis.drive->advance_mechanism_to(last_);
  }

  void print_summary() const {
    for (const Axis& axis : axes_) {
      const std::string name = axes_.size() > 1 ? "axis " + axis.name + ": " : std::string{};
      fmt::print("{}position {:.9g} m, {}, largest force {:.4g} N, {} frames lost\n", name,
                 axis.mechanism.axis->state().position_m, axis.mechanism.axis->state().sticking ? "at rest" : "moving",
                 axis.drive->largest_force_N(last_), axis.lost);
    }
    fmt::print("busy for at most {:.3g} ms at a time, {:.3f} s after the start, for {:.3g} ms of processor time\n",
               1e3 * hal::seconds(longest_work_), hal::seconds(longest_work_began_.time_since_epoch()),
               1e3 * hal::seconds(its_processor_time_));
  }

 private:
  struct Axis {
    Axis(LiveDrives& drives, std::string axis, sil::AxisMechanism moved, const DriveConfig& config)
        : name{std::move(axis)}, mechanism{std::move(moved)} {
      const auto send = [this, &drives](const hal::CanFrame& frame, hal::Time) {
        if (!drives.transmit(frame)) ++lost;
      };
      std::visit([&](const auto& of) { play(of, send); }, config);
      drive->power_on(hal::Time{});
    }
    Axis(const Axis&) = delete;
    Axis& operator=(const Axis&) = delete;

    void play(const drive_emulator::EmulatorConfig& config, const auto& send) {
      auto played = std::make_unique<drive_emulator::DriveEmulator>(config, mechanism.seen_by_drive(), send);
      holds_axis = [of = played.get()] { return of->state() == cia402::State::operation_enabled; };
      drive = std::move(played);
    }
    void play(const odrive_emulator::EmulatorConfig& config, const auto& send) {
      auto played = std::make_unique<odrive_emulator::OdriveEmulator>(config, mechanism.seen_by_drive(), send);
      holds_axis = [of = played.get()] { return of->state() == odrive::AxisState::closed_loop_control; };
      drive = std::move(played);
    }

    // The brake opens when the drive first holds the axis, so that setting it up does not count as motion.
    void advance_to(hal::Time now) const {
      drive->advance_to(now);
      if (!mechanism.axis->released() && holds_axis()) mechanism.axis->release(hal::seconds(now));
    }

    std::string name;
    sil::AxisMechanism mechanism;
    std::uint64_t lost = 0;
    std::unique_ptr<drive_emulator::EmulatedDrive> drive;
    std::function<bool()> holds_axis;
  };

  void note_work(hal::Time began, hal::Duration processor_time) {
    const hal::Duration work = passed() - began;
    if (work <= longest_work_) return;
    longest_work_ = work;
    longest_work_began_ = began;
    its_processor_time_ = processor_time;
  }

  // The drives' time starts with this process.
  hal::Time passed() const { return since_start(monotonic_now()); }
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
      for (Axis& axis : axes_) axis.drive->on_frame(*frame, last_);
    }
  }

  // An axis that may move is followed in short steps: a frame that comes after a silence does not wait for all of it.
  hal::Duration longest_wait() const {
    const bool still = std::ranges::none_of(axes_, [](const Axis& axis) { return axis.mechanism.axis->released(); });
    return still ? std::chrono::milliseconds{1000} : std::chrono::milliseconds{2};
  }

  void wait(const sigset_t& mask, hal::Duration duration) {
    hal::Time until{duration};
    for (const Axis& axis : axes_) until = std::min(until, axis.drive->next_event().value_or(until));
    const hal::Duration left = std::clamp<hal::Duration>(until - passed(), hal::Duration{0}, longest_wait());
    const timespec patience{.tv_sec = left / std::chrono::seconds{1},
                            .tv_nsec = (left % std::chrono::seconds{1}).count()};
    pollfd watched{.fd = socket_.descriptor(), .events = POLLIN, .revents = 0};
    ppoll(&watched, 1, &patience, &mask);
  }

  // A queue without room loses the frame, as it would in a drive.
  bool transmit(const hal::CanFrame& frame) {
    return socket_.write(socketcan::to_kernel(frame)) == socketcan::Io::done;
  }

  socketcan::KernelSocket& socket_;
  hal::Time start_ = monotonic_now();
  hal::Time last_{};              // up to which the drives were played; never decreases, as a drive wants it
  hal::Duration longest_work_{};  // between two waits: in it no frame is answered
  hal::Time longest_work_began_{};
  hal::Duration its_processor_time_{};  // less where others had the processor meanwhile
  std::deque<Axis> axes_;
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

scenario::Scenario read_drives(const DriveCommand& options) {
  scenario::Scenario s = scenario::read_scenario(options.scenario);
  if (!options.axis.empty()) s = only_axis(s, options.axis);
  for (scenario::AxisWorld& world : s.worlds) {
    if (!world.drive && !world.odrive)
      throw InputError{s.node.file + ": has no [drive]; give a scenario whose axes have drives on a bus"};
    if (!world.tolerance) world.tolerance = usual_tolerance;
  }
  if (options.changes.node_id && s.axes() > 1)
    throw InputError{"--node-id: is for one drive, and the scenario has several; say which with --axis NAME"};
  return s;
}

int drive_scenario(const DriveCommand& options) {
  const scenario::Scenario s = read_drives(options);
  std::vector<DriveConfig> configs;
  for (const scenario::AxisWorld& world : s.worlds) configs.push_back(drive_config(world, options.changes));
  socketcan::KernelSocket socket;
  const auto opened = socket.open(options.interface.c_str(), {});
  if (opened != socketcan::OpenResult::done)
    throw InputError{fmt::format("{}: {}", options.interface, to_string(opened))};
  const sigset_t mask = prepare_signals();
  if (options.realtime) become_realtime();
  LiveDrives drives{s, configs, socket};
  for (const auto& config : configs)
    fmt::print("drive {} on {}\n", std::visit([](const auto& of) { return of.node_id; }, config), options.interface);
  std::fflush(stdout);
  drives.run(stop_wanted, mask, hal::Duration{std::llround(options.duration_s * 1e9)});
  drives.print_summary();
  return done;
}

}  // namespace

void add_drive(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<DriveCommand>();
  CLI::App* command =
      app.add_subcommand("drive", "Emulate the drives with their axes on a CAN interface, in real time");
  command->add_option("scenario", options->scenario, "The scenario: [plant], [friction] and [drive] of its axes")
      ->required();
  command->add_option("--axis", options->axis, "The name of the one axis whose drive to emulate; without, all of them");
  command->add_option("--can", options->interface, "The CAN interface, can0 or vcan0, say")->required();
  command->add_option("--node-id", options->changes.node_id, "Node id instead of the scenario's")
      ->check(whole_number_between(0, 127));
  command->add_option("--duration", options->duration_s, "Seconds until it ends; without, SIGINT or SIGTERM ends it")
      ->check(number_of_seconds);
  command->add_flag("--realtime", options->realtime, "Lock the memory and run at real-time priority 70");
  command
      ->add_option("--supported-modes", options->changes.supported_modes,
                   "What 6502h shows, hexadecimal; without bit 9 the drive has no cyclic synchronous torque mode")
      ->check(CLI::Validator{[](std::string& text) -> std::string {
                               const bool good = !text.empty() && text.size() <= 8 &&
                                                 text.find_first_not_of("0123456789abcdefABCDEF") == text.npos;
                               return good ? "" : text + " is not a hexadecimal number of at most 8 digits";
                             },
                             ""});
  command
      ->add_option("--mode-delay", options->changes.mode_delay_s,
                   "Seconds for which 6061h shows no mode after one was requested, instead of the scenario's")
      ->check(number_of_seconds);
  command->footer(std::string{"Example: breakaway drive --can vcan0 sim/scenarios/can_axis.toml\n"
                              "and, in another terminal: breakaway-node --can vcan0 sim/scenarios/can_axis.toml\n"} +
                  exit_codes);
  command->callback([options, &exit_code] { exit_code = drive_scenario(*options); });
}

}  // namespace breakaway::cli
