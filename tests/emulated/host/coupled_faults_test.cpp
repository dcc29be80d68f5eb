// The node that is flashed for coupled_gantry.toml at random moments of random runs, while its bus, its drives, its
// encoders or other tools fail: force stays bounded, a fault of one axis stops both in that period, every end has a
// name that stays, and the machine reaches its targets again once the cause is gone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "../../campaign/environment.hpp"
#include "../../campaign/tampered_port.hpp"
#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sync.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/simulated_network.hpp"
#include "flashed_node.hpp"

namespace breakaway::emulated {
namespace {

using namespace std::chrono_literals;
using campaign::Tampering;
using firmware::AxisFault;
using Frame = hal::CanFrame;

constexpr std::size_t axes = flashed::node.capacity;
constexpr double max_force_N = 100, no_force_N = 0.1, start_m = 0.03;
// Of the law; a count of a reading, and half a count of a reference.
constexpr double tolerance_m = 1e-5 + 1.5e-6;

class ShownEncoder final : public drive_emulator::Mechanism {
 public:
  explicit ShownEncoder(drive_emulator::Mechanism& truth) : truth_{truth} {}
  std::function<double(double)> shown{};
  void advance_to(double time_s, const model::AppliedForce& force) override { truth_.advance_to(time_s, force); }
  void change_force(const model::AppliedForce& force) override { truth_.change_force(force); }
  double position_m() const override { return shown ? shown(truth_.position_m()) : truth_.position_m(); }
  double true_m() const { return truth_.position_m(); }

 private:
  drive_emulator::Mechanism& truth_;
};

class Gantry {
 public:
  using Port = campaign::TamperedPort<sil::SimulatedNetwork::Port>;

  explicit Gantry(std::uint64_t seed) : random{seed}, port{network_.controller_port(), seed} {
    for (std::size_t i = 0; i < axes; ++i) {
      encoders.emplace_back(mechanisms_[i].seen_by_drive());
      drive_emulator::EmulatorConfig config = *scene_.worlds[i].drive;
      config.max_torque_per_mille *= 2;  // the drive could do twice what its axis may
      drives_.push_back(&network_.add_drive(config, encoders[i]));
    }
  }

  const auto& status(std::size_t i) const { return node_.loop().status(*node_.loop().axis(i)); }
  const auto& master(std::size_t i) const { return node_.loop().drive(*node_.loop().axis(i)); }
  const auto& coordinator() const { return node_.loop().controller(*node_.loop().axis(0)).coordinator(); }

  void step() {
    now_ += flashed::node.loop.network.period;
    network_.advance_to(now_);
    if (each_period) each_period();
    for (std::uint8_t i = 0; i < axes; ++i) {
      wish[i].axis = i;
      const Frame frame = firmware::encode_command(wish[i], flashed::node.loop.network.node_id);
      if (frame != said_[i] || (now_ - hal::Time{}) % 100ms == 0ms) send(frame);
      said_[i] = frame;
    }
    port.begin_period(now_);
    if (!controller_runs) return;
    {
      const testing::RealtimeGuard guard;
      node_.step(now_);
    }
    if (!released_ && status(0).running && status(1).running) {
      released_ = true;
      for (auto& mechanism : mechanisms_) mechanism.axis->release(hal::seconds(now_));
    }
  }
  void run(hal::Duration duration) {
    for (const hal::Time end = now_ + duration; now_ < end;) step();
  }
  hal::Time now() const { return now_; }

  bool faulty() const { return status(0).fault != AxisFault::none || status(1).fault != AxisFault::none; }
  bool holds() const {
    return status(0).running && status(1).running && coordinator().phase() == law::CoordinatorPhase::hold &&
           coordinator().end() == law::CoordinatorEnd::on_target && at_rest();
  }
  bool at_rest() const {
    return !released_ || (mechanisms_[0].axis->state().sticking && mechanisms_[1].axis->state().sticking);
  }
  drive_emulator::DriveEmulator& drive(std::size_t i) { return *drives_[i]; }
  double position_m(std::size_t i) const { return mechanisms_[i].axis->state().position_m; }
  std::int32_t counts(std::size_t i) const { return static_cast<std::int32_t>(std::lround(position_m(i) * 1e6)); }
  double error_m(std::size_t i) const { return position_m(i) - wish[i].target_counts * 1e-6; }
  double force_N(std::size_t i) const { return drives_[i]->force().at_N(hal::seconds(now_), 0, 0); }

  void send(const Frame& frame) { static_cast<void>(tool_.send(frame, now_ + 10ms)); }
  // Over the bus, or through a service port of the drive that nobody on the bus sees.
  void write(std::size_t i, bool seen, std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned bytes) {
    Frame frame{.id = canopen::sdo_request_cob_id(static_cast<std::uint8_t>(i + 1)), .size = 8, .data = {}};
    frame.data[0] = static_cast<std::uint8_t>(0x23U | (4U - bytes) << 2);
    canopen::store_little_endian(frame.data, index, 1);
    frame.data[3] = sub;
    canopen::store_little_endian(frame.data, value, 4);
    if (seen)
      send(frame);
    else
      drive(i).on_frame(frame, now_);
  }
  void bus_state(hal::BusState state) { network_.controller_port().set_bus_state(state); }

  std::mt19937_64 random;
  std::function<void()> each_period;
  bool controller_runs = true;
  std::array<firmware::MotionCommand, axes> wish{};

 private:
  scenario::Scenario scene_ = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/coupled_gantry.toml");
  std::vector<sil::AxisMechanism> mechanisms_ = sil::axis_mechanisms(scene_);
  sil::SimulatedNetwork network_{*scene_.bus};
  sil::SimulatedNetwork::Port& tool_ = network_.add_port();
  std::vector<drive_emulator::DriveEmulator*> drives_;
  hal::Time now_{};
  std::array<Frame, axes> said_{};
  bool released_ = false;

 public:
  std::deque<ShownEncoder> encoders;
  Port port;

 private:
  firmware::ControlNode<Port, std::remove_const_t<decltype(flashed::node)>> node_{port, flashed::node};
};

double between(Gantry& g, double low, double high) { return std::uniform_real_distribution<>{low, high}(g.random); }
double decades(Gantry& g, double low, double high) { return low * std::pow(high / low, between(g, 0, 1)); }
bool coin(Gantry& g) { return (g.random() & 1U) != 0; }

// Of one axis, but for what is of the bus. A drive that hears is without force two periods after its stop; a deaf one
// once it was told by other means.
struct Fault {
  std::string name;
  std::function<void(Gantry&, std::size_t)> cause;
  bool of_the_bus = false;  // neither drive need hear
  bool deaf = false;        // its own drive may be
  bool encoder = false;     // the truth cannot be known while it lasts
};

bool is_drives(const Frame& f) { return canopen::is_sync(f) || canopen::node_id_of(f.id) <= axes; }

std::vector<Fault> make_faults() {
  std::vector<Fault> list;
  const auto frames = [&](const char* name, void (*how)(Gantry&, Tampering&)) {
    list.push_back(
        {name,
         [how](Gantry& g, std::size_t axis) {
           const auto node = static_cast<std::uint8_t>(axis + 1);
           switch (g.random() % 5) {
             case 0:
               g.port.incoming.concerns = [node](const Frame& f) { return f.id == canopen::tpdo_cob_id(1, node); };
               return how(g, g.port.incoming);
             case 1:
               g.port.outgoing.concerns = [node](const Frame& f) { return f.id == canopen::rpdo_cob_id(1, node); };
               return how(g, g.port.outgoing);
             case 2:
               g.port.outgoing.concerns = canopen::is_sync;
               return how(g, g.port.outgoing);
             case 3:
               g.port.incoming.concerns = is_drives;
               return how(g, g.port.incoming);
             default:
               g.port.incoming.concerns = g.port.outgoing.concerns = is_drives;
               how(g, g.port.incoming);
               return how(g, g.port.outgoing);
           }
         },
         true, true});
  };
  frames("frames lost", [](Gantry& g, Tampering& t) { t.lost = decades(g, 1e-3, 1); });
  frames("frames late", [](Gantry& g, Tampering& t) {
    t.late = decades(g, 1e-2, 1);
    t.late_by_periods = coin(g) ? 1 : 20;
  });
  frames("frames doubled", [](Gantry& g, Tampering& t) { t.doubled = decades(g, 1e-2, 1); });
  frames("frames shuffled", [](Gantry&, Tampering& t) { t.shuffled = true; });
  frames("frames spoiled", [](Gantry& g, Tampering& t) { t.spoiled = decades(g, 1e-3, 1); });
  frames("a burst lost", [](Gantry& g, Tampering& t) {
    t.lost = 1;
    g.each_period = [&g, &t, end = g.now() + std::chrono::milliseconds{static_cast<int>(decades(g, 1, 100))}] {
      if (g.now() >= end) t.lost = 0;
    };
  });
  list.push_back({"bus off", [](Gantry& g, std::size_t) { g.bus_state(hal::BusState::bus_off); }, true, true});
  list.push_back({"controller starved",
                  [](Gantry& g, std::size_t) {
                    g.controller_runs = false;
                    g.run(std::chrono::milliseconds{static_cast<int>(decades(g, 2, 400))});
                    g.controller_runs = true;
                  },
                  true, true});
  list.push_back({"another SYNC",
                  [](Gantry& g, std::size_t) { g.each_period = [&g] { g.send(canopen::sync_frame()); }; }, true, true});
  list.push_back({"another master's command",
                  [](Gantry& g, std::size_t axis) {
                    Frame f{.id = canopen::rpdo_cob_id(1, static_cast<std::uint8_t>(axis + 1)), .size = 8, .data = {}};
                    f.data[0] = 0x0F;
                    canopen::store_little_endian(f.data, static_cast<std::int16_t>(between(g, -2000, 2000)), 2);
                    if (coin(g)) return g.send(f);
                    g.each_period = [&g, f] { g.send(f); };
                  },
                  false, true});
  list.push_back({"drive trips", [](Gantry& g, std::size_t a) { g.drive(a).trip_fault(0x2310, g.now()); }});
  list.push_back({"drive reboots",
                  [](Gantry& g, std::size_t a) {
                    g.drive(a).power_off(g.now());
                    g.drive(a).power_on(g.now());
                  },
                  false, true});
  list.push_back({"drive without power", [](Gantry& g, std::size_t a) { g.drive(a).power_off(g.now()); }, false, true});
  list.push_back({"cable pulled", [](Gantry& g, std::size_t a) { g.drive(a).set_silent(true); }, false, true});
  list.push_back({"heartbeat lost", [](Gantry& g, std::size_t a) { g.drive(a).suppress_heartbeat(true); }});
  list.push_back({"drive falls back", [](Gantry& g, std::size_t a) {
                    constexpr std::array states{cia402::State::switch_on_disabled, cia402::State::ready_to_switch_on,
                                                cia402::State::switched_on};
                    g.drive(a).inhibit_beyond(states[g.random() % 3], g.now());
                  }});
  list.push_back({"EMCY", [](Gantry& g, std::size_t a) {
                    g.send(canopen::emcy_frame({.code = 0x3210}, static_cast<std::uint8_t>(a + 1)));
                  }});
  list.push_back(
      {"force saturated", [](Gantry& g, std::size_t a) { g.drive(a).limit_peak_force(decades(g, 1, 90), g.now()); }});
  struct Written {
    const char* name;
    std::uint16_t index;
    std::uint8_t sub;
    std::uint32_t value;
    unsigned bytes;
    bool deaf;
  };
  for (const Written& w : {Written{"RPDO off", 0x1400, 1, 0x80000200, 4, true},
                           {"TPDO off", 0x1800, 1, 0xC0000180, 4, true},
                           {"TPDO at every second SYNC", 0x1800, 2, 2, 1, true},
                           {"another SYNC's COB-ID", 0x1005, 0, 0x81, 4, true},
                           {"60B2h", 0x60B2, 0, 600, 2, false},
                           {"6072h lowered", 0x6072, 0, 300, 2, false},
                           {"heartbeat off", 0x1017, 0, 0, 2, false},
                           {"another mode", 0x6060, 0, 0, 1, false},
                           {"controlword 0", 0x6040, 0, 0, 2, false}})
    list.push_back({w.name,
                    [w](Gantry& g, std::size_t a) {
                      const bool pdo = w.index == 0x1400 || w.index == 0x1800;
                      g.write(a, coin(g), w.index, w.sub,
                              w.value + (pdo && w.sub == 1 ? static_cast<std::uint32_t>(a + 1) : 0U), w.bytes);
                    },
                    false, w.deaf});
  for (const auto command : {canopen::NmtCommand::stop, canopen::NmtCommand::enter_pre_operational,
                             canopen::NmtCommand::reset_node, canopen::NmtCommand::reset_communication})
    list.push_back({"NMT of another node",
                    [command](Gantry& g, std::size_t a) {
                      const bool all = g.random() % 4 == 0;
                      g.send(canopen::nmt_frame(command, all ? std::uint8_t{0} : static_cast<std::uint8_t>(a + 1)));
                    },
                    true, true});
  const auto encoder = [&](const char* name, std::function<std::function<double(double)>(Gantry&, double)> how) {
    list.push_back({name, [how](Gantry& g, std::size_t a) { g.encoders[a].shown = how(g, g.encoders[a].true_m()); },
                    false, false, true});
  };
  encoder("encoder frozen", [](Gantry&, double at_m) { return [at_m](double) { return at_m; }; });
  encoder("encoder jumps", [](Gantry& g, double) {
    return [jump_m = (coin(g) ? 1 : -1) * decades(g, 2e-6, 10)](double m) { return m + jump_m; };
  });
  encoder("encoder reversed", [](Gantry&, double at_m) { return [at_m](double m) { return 2 * at_m - m; }; });
  list.push_back({"nothing but a target", [](Gantry&, std::size_t) {}});
  return list;
}

void mend(Gantry& g) {
  g.port.incoming = g.port.outgoing = {};
  g.each_period = nullptr;
  g.controller_runs = true;
  g.bus_state(hal::BusState::error_active);
  for (std::size_t i = 0; i < axes; ++i) {
    g.encoders[i].shown = nullptr;
    auto& drive = g.drive(i);
    if (drive.nmt_state() == canopen::NmtState::boot_up) drive.power_on(g.now());
    drive.set_silent(false);
    drive.suppress_heartbeat(false);
    drive.inhibit_beyond({}, g.now());
    drive.limit_peak_force(1000, g.now());
    g.write(i, false, 0x6072, 0, 4000, 2);
  }
}

class OneRun {
 public:
  OneRun(const Fault& fault, const Fault* second, std::uint64_t seed)
      : fault_{fault}, second_{second}, seed_{seed}, g_{seed} {}

  void go() {
    begin();
    axis_ = g_.random() % axes;
    fault_.cause(g_, axis_);
    const hal::Time cause = g_.now();
    if (second_ != nullptr) {
      for (const hal::Time at = cause + std::chrono::milliseconds{g_.random() % 50}; g_.now() < at;) step();
      second_->cause(g_, 1 - axis_);
    }
    const hal::Time other_target = coin(g_) ? cause + std::chrono::milliseconds{g_.random() % 50} : hal::Time::max();
    follow(cause + 3s, other_target);
    const bool was_faulty = g_.faulty();
    mend(g_);
    if (!was_faulty) follow(g_.now() + 15s, hal::Time::max());
    if (!g_.faulty() && !on_target()) ADD_FAILURE() << "neither on target nor named: " << text();
    g_.run(300ms);
    recover();
    for (std::size_t i = 0; i < axes; ++i)
      EXPECT_LE(g_.drive(i).largest_force_N(g_.now()), max_force_N * (1 + 1e-6)) << text();
  }

 private:
  void begin() {
    g_.wish[0].target_counts = g_.wish[1].target_counts = target(0);
    g_.run(20ms);
    for (auto& wish : g_.wish) wish.enable = true;
    g_.run(std::chrono::milliseconds{static_cast<int>(between(g_, 1, g_.random() % 4 == 0 ? 300 : 1500))});
  }

  std::int32_t target(std::int32_t about) { return about + static_cast<std::int32_t>(between(g_, -1, 1) * 5e3); }

  bool on_target() const {
    if (!g_.holds()) return false;
    for (std::size_t i = 0; i < axes; ++i)
      if (std::abs(g_.error_m(i)) > tolerance_m) return false;
    return true;
  }

  void follow(hal::Time end, hal::Time other_target) {
    hal::Time settled = hal::Time::max();
    while (g_.now() < end) {
      if (g_.now() >= other_target) {
        other_target = hal::Time::max();
        g_.wish[0].target_counts = g_.wish[1].target_counts = target(g_.wish[0].target_counts);
      }
      step();
      if (settled == hal::Time::max() && (g_.faulty() || on_target())) settled = g_.now();
      if (g_.now() > settled + 500ms && (g_.faulty() || on_target())) break;
    }
  }

  void step() {
    g_.step();
    look();
  }

  // What must be so in every period.
  void look() {
    if (!g_.faulty()) return;
    for (std::size_t i = 0; i < axes; ++i) {
      const AxisFault fault = g_.status(i).fault;
      if (named_[i] == AxisFault::none) named_[i] = fault;
      if (fault == AxisFault::none || g_.status(i).running || fault != named_[i])
        fail("a fault of one axis does not stop both by a name that stays");
    }
    if (named_at_ == hal::Time{}) named_at_ = g_.now();
    if (!fault_.of_the_bus && second_ == nullptr && named_[axis_] == AxisFault::stopped_with_another)
      fail("the name is on the axis that has no fault");
    const hal::Duration since = g_.now() - named_at_;
    for (std::size_t i = 0; i < axes; ++i) {
      const bool hears = !fault_.of_the_bus && second_ == nullptr && !(fault_.deaf && i == axis_);
      if (since > (hears ? 2ms : 900ms) && std::abs(g_.force_N(i)) > no_force_N) fail("force after a stop");
    }
  }

  // What an operator does: reset, reference where it is lost, a target that is certified from here, enable.
  void recover() {
    for (int attempt = 0; attempt < 5; ++attempt) {
      for (int n = 0; n < 20000 && !g_.at_rest(); ++n) g_.step();
      for (auto& wish : g_.wish) wish = {.target_counts = wish.target_counts};
      g_.run(150ms);
      const bool lost = lost_reference();
      for (auto& wish : g_.wish) wish.reset_fault = true;
      for (int n = 0; n < 5000 && (g_.faulty() || n < 200); ++n) g_.step();
      if (lost || lost_reference()) refer();
      // Where both ends are nearer than start_m. A beam that an encoder had bent further is for its operator to
      // straighten.
      const double middle_m = (g_.position_m(0) + g_.position_m(1)) / 2;
      const double room_m = 0.97 * start_m - std::abs(g_.position_m(0) - middle_m);
      if ((fault_.encoder || second_ != nullptr) && (room_m < 0 || std::abs(middle_m) > 0.9)) return;
      const auto to = static_cast<std::int32_t>(1e6 * (middle_m + between(g_, -1, 1) * room_m));
      for (auto& wish : g_.wish) wish = {.target_counts = to};
      g_.run(150ms);
      for (auto& wish : g_.wish) wish.enable = true;
      for (int n = 0; n < 20000 && !g_.faulty(); ++n) {
        g_.step();
        if (on_target()) return;
      }
      recoveries_ << "; then " << state();
    }
    ADD_FAILURE() << "not recovered: " << text();
  }
  bool lost_reference() const { return g_.master(0).reference_lost() || g_.master(1).reference_lost(); }
  void refer() {
    for (std::size_t i = 0; i < axes; ++i) g_.wish[i] = {.target_counts = g_.counts(i)};
    g_.run(150ms);
    for (auto& wish : g_.wish) wish.reference = true;
    for (int n = 0; n < 5000 && (n < 200 || lost_reference()); ++n) g_.step();
  }

  void fail(const char* what) {
    if (!failed_) ADD_FAILURE() << what << ": " << text();
    failed_ = true;
  }
  std::string state() const {
    std::ostringstream out;
    for (std::size_t i = 0; i < axes; ++i)
      out << " [" << i << ": " << to_string(g_.status(i).fault) << ", state "
          << static_cast<int>(g_.status(i).feedback.state) << (g_.status(i).running ? ", runs" : "") << ", force "
          << g_.force_N(i) << " N, error " << g_.error_m(i) << "]";
    out << " phase " << static_cast<int>(g_.coordinator().phase()) << " kicks " << g_.coordinator().kicks();
    return out.str();
  }
  std::string text() const {
    std::ostringstream out;
    out << fault_.name << " of axis " << axis_;
    if (second_ != nullptr) out << " and " << second_->name << " of the other";
    out << ", seed " << seed_ << " at " << hal::seconds(g_.now()) << " s, named " << to_string(named_[0]) << " / "
        << to_string(named_[1]) << " at " << hal::seconds(named_at_) << " s;" << state() << recoveries_.str();
    return out.str();
  }

  const Fault& fault_;
  const Fault* second_;  // of the other axis; none
  std::uint64_t seed_;
  Gantry g_;
  std::size_t axis_ = 0;
  std::array<AxisFault, axes> named_{};
  hal::Time named_at_{};
  bool failed_ = false;
  std::ostringstream recoveries_{};
};

// BREAKAWAY_ONSETS runs of each fault from the seeds of BREAKAWAY_FIRST_ONSET on; BREAKAWAY_FAULT names one of them.
TEST(CoupledFaults, AreBoundedStopBothAxesByNameAndAreRecoveredFrom) {
  const long runs = campaign::from_environment("BREAKAWAY_ONSETS", 1);
  const long first = campaign::from_environment("BREAKAWAY_FIRST_ONSET", 0);
  const std::string only = campaign::text_from_environment("BREAKAWAY_FAULT");
  const std::vector<Fault> faults = make_faults();
  for (std::size_t f = 0; f < faults.size(); ++f) {
    if (!only.empty() && faults[f].name != only) continue;
    for (long i = first; i < first + runs; ++i) {
      const auto seed = static_cast<std::uint64_t>(i) * 1001 + f;
      // Every third time the other axis has a fault of its own shortly after.
      OneRun{faults[f], seed % 3 == 0 ? &faults[seed / 3 % faults.size()] : nullptr, seed}.go();
    }
  }
}

// A sample may be lost: of either axis, at any time, but two of one axis in a row, which are "feedback stale".
TEST(CoupledFaults, SingleSamplesThatAreLostEndNothingAndTheTargetsAreReached) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    Gantry g{seed};
    std::array<bool, axes + 1> lost_before{};
    const double share = decades(g, 0.01, 1);
    g.port.incoming.lost = 1;
    g.port.incoming.concerns = [&](const Frame& f) {
      for (std::uint8_t node = 1; node <= axes; ++node) {
        if (f.id == canopen::tpdo_cob_id(1, node))
          return lost_before[node] = !lost_before[node] && between(g, 0, 1) < share;
      }
      return false;
    };
    for (auto& wish : g.wish) wish.target_counts = static_cast<std::int32_t>(seed) * 1000 - 4000;
    g.run(20ms);
    for (auto& wish : g.wish) wish.enable = true;
    for (int n = 0; n < 8000 && !g.holds() && !g.faulty(); ++n) g.step();
    EXPECT_TRUE(g.holds()) << seed << ", share " << share;
    for (std::size_t i = 0; i < axes; ++i) {
      EXPECT_LE(std::abs(g.error_m(i)), tolerance_m) << seed;
      EXPECT_EQ(g.status(i).fault, AxisFault::none) << to_string(g.status(i).fault) << seed << ", share " << share;
    }
  }
}

}  // namespace
}  // namespace breakaway::emulated
