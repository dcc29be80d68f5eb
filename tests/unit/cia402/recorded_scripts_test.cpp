// What a drive is told, and what is said of it, while things befall its node at any moment: nodes that boot, fall
// silent, lose answers, refuse, fault or are switched on by somebody else, each some of these in a row. The figures are
// those of the code that the other tests and the campaign of faults have accepted. Who changes what a drive is told
// tests it there, and then takes over the lines that this test prints.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "../../recorded_figures.hpp"
#include "breakaway/canopen/bytes.hpp"
#include "drive_fixture.hpp"

namespace breakaway::test::recorded_scripts {
namespace {

using cia402::Home;

constexpr auto key = ScriptedDrive::key;
constexpr Duration longest = 7s;

// Counts, and sums of the milliseconds at which something was so.
struct Figures {
  double commands = 0, command_ms = 0;       // of NMT
  double requests = 0, request_ms = 0;       // by SDO
  double objects = 0;                        // that these were about, each times its place among them
  double aborts = 0;                         // of transfers by the master
  double rpdos = 0, words = 0, targets = 0;  // controlwords, and torques, each times the place of its frame
  double states = 0, setups = 0, stands = 0,
         codes = 0;  // of the drive, its set-up, the object where that stands, faults
  double bits = 0;   // lost heartbeats, lost references, failed homing, stops not obeyed
  double samples = 0, place = 0, travel = 0;
  double patience_ms = 0, reboots = 0, rating = 0;

  std::array<double, 20> all() const {
    return {commands, command_ms, requests, request_ms, objects, aborts, rpdos,  words,       targets, states,
            setups,   stands,     codes,    bits,       samples, place,  travel, patience_ms, reboots, rating};
  }
};

// A drive and its node, of which the test dictates what befalls them.
class Run {
 public:
  Run(const DriveConfig<float>& told, Duration period)
      : drive{told, {.period = period}, scale}, period_{period}, period_ms_{static_cast<double>(period / 1us) / 1000} {}

  void step() {
    now_ += period_;
    node.advance_to(now_);
    drive.update(now_);
    note(drive.feedback());
    drive.command(force_N);
    send(breakaway::canopen::sync_frame());
    drive.on_sync(now_);
    CanFrame frame;
    if (drive.next_command_frame(frame)) send(frame);
    if (drive.next_acyclic_frame(frame, now_)) send(frame);
    deliver();
  }
  void deliver() {
    std::vector<CanFrame> frames;
    frames.swap(node.out);
    for (const CanFrame& frame : frames) drive.on_frame({.frame = frame, .time = now_ + 300us});
  }
  double ms() const { return static_cast<double>(now_.time_since_epoch() / 1us) / 1000; }
  Time now() const { return now_; }

  Drive<float> drive;
  ScriptedDrive node{node_id};
  float force_N = 0;
  Figures figures;

 private:
  void send(const CanFrame& frame) {
    if (frame.id == breakaway::canopen::nmt_cob_id) {
      ++figures.commands;
      figures.command_ms += ms() * frame.data[0];
    } else if (frame.id == sdo_request_cob_id(node_id) && frame.data[0] == 0x80) {
      ++figures.aborts;
    } else if (frame.id == sdo_request_cob_id(node_id)) {
      ++figures.requests;
      figures.request_ms += ms();
      figures.objects += figures.requests * breakaway::canopen::load_little_endian<std::uint16_t>(frame.data, 1);
    } else if (frame.id == rpdo_cob_id(1, node_id)) {
      ++figures.rpdos;
      figures.words += figures.rpdos * frame.data[0];
      figures.targets += figures.rpdos * breakaway::canopen::load_little_endian<std::int16_t>(frame.data, 2);
    }
    node.on_frame(frame);
  }
  void note(const DriveFeedback<float>& feedback) {
    figures.states += ms() * static_cast<double>(feedback.state);
    figures.setups += ms() * static_cast<double>(drive.setup_status());
    figures.stands += drive.setup_object().index + ms() * static_cast<double>(drive.setup_abort_code());
    figures.codes += feedback.fault_code;
    figures.bits += (drive.heartbeat_lost() ? 1 : 0) + (drive.reference_lost() ? 1e4 : 0) +
                    (feedback.homing_failed ? 1e8 : 0) + (feedback.stop_not_obeyed ? 1e-4 : 0);
    figures.samples += (feedback.fresh ? 1 : 0) + (feedback.ever_valid ? 1e4 : 0);
    figures.place += drive.position_counts();
    figures.travel += std::round(1e6 * static_cast<double>(feedback.travel_m));
    figures.patience_ms += static_cast<double>(drive.extra_setup_time() / 1ms) * period_ms_;
    figures.reboots += ms() * drive.reboots();
    const auto& rating = drive.rating();
    figures.rating += rating.rated_current_mA + rating.rated_torque_mNm + rating.max_torque_per_mille +
                      3.0 * rating.found_max_torque_per_mille;
  }

  Duration period_;
  double period_ms_;
  Time now_{};
};

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : bits_{seed} {}
  unsigned below(unsigned n) { return static_cast<unsigned>(bits_() % n); }
  bool one_in(unsigned n) { return below(n) == 0; }
  template <class T, std::size_t N>
  T one_of(const std::array<T, N>& values) {
    return values[below(N)];
  }

 private:
  std::mt19937_64 bits_;
};

DriveConfig<float> random_config(Dice& dice) {
  DriveConfig<float> told = config;
  if (dice.one_in(4)) told.heartbeat_timeout = 1500ms;
  if (dice.one_in(4)) told.sdo_timeout = dice.one_in(2) ? 3s : 7ms;
  if (dice.one_in(4)) told.torque_base = cia402::TorqueBase::largest;
  if (dice.one_in(4)) told.rated_torque_mNm = 1000;
  if (dice.one_in(4)) told.invert_direction = true;
  if (dice.one_in(4)) told.absolute_encoder = true;
  const unsigned home = dice.below(4);
  if (home == 0) told.homing = {.home = Home::here, .position_counts = -40};
  if (home == 1) told.homing = {.home = Home::by_drive, .position_counts = 500, .search_counts_s = 9, .timeout = 700ms};
  return told;
}

// Something befalls the node, or a call is made, at a random moment; some of it ends after a while.
class Events {
 public:
  Events(Run& run, Dice& dice) : run_{run}, dice_{dice} {}

  void befall() {
    ScriptedDrive& node = run_.node;
    switch (dice_.below(24)) {
      case 0:
        node.boot();
        return run_.deliver();
      case 1:
        node.silent = true;
        break;
      case 2:
        node.nmt = dice_.one_in(2) ? NmtState::pre_operational : NmtState::stopped;
        return;
      case 3:
        if (dice_.one_in(2)) node.emergency(static_cast<std::uint16_t>(0x2310 + dice_.below(9)));
        node.state = State::fault;
        return;
      case 4:
        return run_.drive.request_stop();
      case 5:
      case 6:
        return run_.drive.reset_fault();
      case 7:
        node.follows_controlword = false;
        break;
      case 8:
        node.sdo_requests_lost = 1 + dice_.below(4);
        return;
      case 9:
        node.refused[random_object()] = random_refusal();
        break;
      case 10:
        node.shows_the_mode_at_once = false;
        node.objects[key(0x6061, 0)] = 0xFF;
        break;
      case 11:
        node.state = dice_.one_of(std::array{State::operation_enabled, State::quick_stop_active,
                                             State::fault_reaction_active, State::not_ready_to_switch_on});
        return;
      case 12:
        node.sends_tpdo = false;
        break;
      case 13:
        node.ignores_start = true;
        break;
      case 14:
        node.boots_silently = !node.boots_silently;
        return node.boot();
      case 15:
        return run_.drive.set_reference_counts(static_cast<std::int32_t>(dice_.below(1000)));
      case 16:
        node.extra_status = dice_.one_in(3) ? 0x2000 : 0x1400;
        break;
      case 17:
        node.follows_sdo_controlword = false;
        break;
      case 18:
        return answer_unasked();
      case 19:
        node.objects[key(0x6072, 0)] = 500 + 100 * dice_.below(20);
        return;
      default:
        return run_.drive.request_enable();
    }
    ends_ = run_.now() + std::chrono::milliseconds{1 + dice_.below(dice_.one_in(2) ? 30 : 900)};
  }
  void pass() {
    if (run_.now() < ends_) return;
    ScriptedDrive& node = run_.node;
    node.silent = node.ignores_start = false;
    node.follows_controlword = node.follows_sdo_controlword = node.sends_tpdo = true;
    node.refused.clear();
    node.extra_status = 0;
    if (!node.shows_the_mode_at_once) node.objects[key(0x6061, 0)] = node.objects[key(0x6060, 0)];
    node.shows_the_mode_at_once = true;
  }

 private:
  std::uint32_t random_object() {
    return key(dice_.one_of(std::array<std::uint16_t, 10>{0x6040, 0x1000, 0x6502, 0x6076, 0x6072, 0x6041, 0x1017,
                                                          0x607E, 0x6060, 0x6061}),
               0);
  }
  SdoAbort random_refusal() {
    return dice_.one_of(std::array{SdoAbort::device_state, SdoAbort::timeout, SdoAbort::no_such_object,
                                   SdoAbort::read_only, SdoAbort::local_control});
  }
  // Of a service that nobody uses, or of a write.
  void answer_unasked() {
    const auto command = static_cast<std::uint8_t>(dice_.one_in(2) ? 0xC0 : 0x60);
    run_.drive.on_frame({.frame = {.id = sdo_response_cob_id(node_id), .size = 8, .data = {command, 0x41, 0x60, 0}},
                         .time = run_.now()});
  }

  Run& run_;
  Dice& dice_;
  Time ends_{};
};

Figures run(std::uint64_t seed) {
  Dice dice{seed};
  Run run{random_config(dice), dice.one_of(std::array<Duration, 4>{1ms, 1ms, 1ms, 4ms})};
  run.node.objects[key(0x6502, 0)] = 1U << 9 | 1U << 5;
  run.node.shows_the_mode_at_once = true;
  run.node.counts = 77'000;
  run.force_N = dice.one_in(2) ? 10 : -3;
  Events events{run, dice};
  if (!dice.one_in(4)) {
    run.node.boot();
    run.deliver();
  }
  const unsigned mean_ms = dice.one_of(std::array<unsigned, 3>{30, 200, 900});
  while (run.now() < Time{longest}) {
    events.pass();
    if (dice.one_in(mean_ms) && run.now() < Time{longest - 3s}) events.befall();
    run.node.counts += dice.one_in(3) ? 1 : 0;
    run.step();
  }
  return run.figures;
}

class RecordedScripts : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RecordedScripts, AreAnsweredAsTheyWere) {
  static const recorded::RecordedFigures kept{BREAKAWAY_SOURCE_DIR "/tests/unit/cia402/recorded_scripts.csv", 12};
  constexpr std::uint64_t scripts = 8;
  for (std::uint64_t i = 0; i < scripts; ++i) {
    const std::uint64_t number = scripts * GetParam() + i;
    kept.expect("script " + std::to_string(number), run(number).all());
  }
}
INSTANTIATE_TEST_SUITE_P(Of, RecordedScripts, testing::Range(std::uint64_t{0}, std::uint64_t{50}));

}  // namespace
}  // namespace breakaway::test::recorded_scripts
