// An adversary who commands in any order and disturbs at any time: frames are lost, doubled, late, exchanged, spoiled
// and lie about state, place and torque, other masters switch, drives trip and reboot, in random order and together.
// Whatever he does, force stays bounded, it is off after a stop or the axis has a name, no reset is taken under force,
// and once he is gone the axis reaches its target.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <sstream>
#include <string>

#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sync.hpp"
#include "campaign_node.hpp"
#include "environment.hpp"

namespace breakaway::campaign {
namespace {

using firmware::AxisFault;

constexpr double no_force_N = 0.1;
// A stop and the first means of those that follow it, which every drive that answers at all obeys.
constexpr hal::Duration told = cia402::Drive<float>::stop_time + cia402::StateMachine::quick_stop_time + 150ms;

class Adversary {
 public:
  Adversary(const CampaignNode& node, std::uint64_t seed) : w_{node, start_of(seed), seed} {
    w_.run(400ms);
    w_.wish.enable = true;
  }

  // An empty text: all was as it must be.
  std::string fight(int rounds) {
    for (int round = 0; round < rounds && wrong_.empty(); ++round) {
      act();
      const auto pause = std::chrono::microseconds{static_cast<int>(decades(500, 5e5))};
      for (const hal::Time end = w_.now() + pause; w_.now() < end && wrong_.empty();) step();
    }
    if (wrong_.empty() && !recovers()) note("it does not recover");
    return wrong_;
  }

 private:
  static double start_of(std::uint64_t seed) {
    std::mt19937_64 random{seed};
    return std::uniform_real_distribution<>{-0.6, 0.6}(random);
  }
  double between(double low, double high) { return std::uniform_real_distribution<>{low, high}(w_.random); }
  double decades(double low, double high) { return low * std::pow(high / low, between(0, 1)); }
  int any(int count) { return std::uniform_int_distribution<>{0, count - 1}(w_.random); }
  bool coin() { return any(2) == 1; }

  void note(const std::string& what) {
    if (!wrong_.empty()) return;
    std::ostringstream text;
    text << what << " at " << hal::seconds(w_.now()) << " s after" << acts_ << ": fault " << to_string(w_.fault())
         << ", state " << to_string(w_.status().feedback.state) << ", drive " << to_string(w_.drive().state()) << ", "
         << w_.force_N() << " N, wish " << w_.wish.enable << ", at " << w_.axis.true_position_m() << " of "
         << w_.target_m() << " m, set-up " << to_string(w_.master().setup_status());
    wrong_ = text.str();
  }

  void step() {
    const bool ran = w_.status().running, wished = w_.wish.enable;
    const AxisFault before = w_.fault();
    const double force_before_N = std::abs(w_.force_N());
    w_.step();
    const double force_N = std::abs(w_.force_N());
    if (wished) unwished_at_ = w_.now();
    if (restarted_) return void(restarted_ = false);
    if (force_N > FaultWorld::max_force_N * (1 + 1e-6)) note("force above the limit");
    const bool named = w_.fault() != AxisFault::none || w_.status().stop_not_obeyed;
    if (force_N > no_force_N && w_.now() - unwished_at_ > told && !named) note("force after a stop");
    if (ran && !w_.status().running && wished && w_.now() - withdrawn_at_ > 200ms && !named)
      note("an end without a name");
    if (before != AxisFault::none && w_.fault() == AxisFault::none && force_before_N > no_force_N && !lies_)
      note("a reset under force");
    if (!wished) withdrawn_at_ = w_.now();
  }

  void act() {
    static constexpr const char* names[] = {" enable",  " stop",   " reset",   " target", " tamper", " honest",
                                            " lie",     " tool",   " nmt",     " trip",   " reboot", " starve",
                                            " restart", " silent", " inhibit", " brake",  " sto off"};
    const int chosen = any(static_cast<int>(std::size(names)));
    acts_ += names[chosen];
    switch (chosen) {
      case 0:
        w_.wish.enable = true;
        break;
      case 1:
        w_.wish.enable = false;
        break;
      case 2:
        w_.wish.reset_fault = !w_.wish.reset_fault;
        break;
      case 3:
        w_.wish.target_counts = static_cast<std::int32_t>(between(-1e6, 1e6));
        break;
      case 4:
        return tamper(coin() ? w_.port.incoming : w_.port.outgoing);
      case 5:
        return be_honest();
      case 6:
        return lie();
      case 7:
        return write();
      case 8: {
        constexpr canopen::NmtCommand commands[] = {
            canopen::NmtCommand::enter_pre_operational, canopen::NmtCommand::stop, canopen::NmtCommand::reset_node,
            canopen::NmtCommand::reset_communication, canopen::NmtCommand::start};
        return w_.send(canopen::nmt_frame(commands[any(5)], FaultWorld::drive_id));
      }
      case 9:
        return w_.drive().trip_fault(0x2310, w_.now());
      case 10:
        w_.drive().power_off(w_.now());
        return w_.drive().power_on(w_.now());
      case 11:
        w_.controller_runs = false;
        w_.run(std::chrono::milliseconds{static_cast<int>(decades(2, 300))});
        w_.controller_runs = true;
        break;
      case 12:
        w_.start_controller();
        restarted_ = true;
        break;
      case 13:
        return w_.drive().set_silent(coin());
      case 14:
        return w_.drive().inhibit_beyond(coin() ? cia402::State::switch_on_disabled : cia402::State::switched_on,
                                         w_.now());
      case 15:
        return coin() ? w_.axis.lock() : w_.axis.unlock();
      default:
        return w_.drive().inhibit_beyond({}, w_.now());
    }
  }

  // A command that is lost or spoiled is a wish of the commander.
  static bool is_of_the_drive(const hal::CanFrame& frame) {
    return canopen::node_id_of(frame.id) == FaultWorld::drive_id || canopen::is_sync(frame);
  }

  void tamper(Tampering& t) {
    t.concerns = is_of_the_drive;
    double* const shares[] = {&t.lost, &t.doubled, &t.spoiled, &t.late};
    *shares[any(4)] = decades(1e-3, 1);
    t.late_by_periods = coin() ? 1 : 20;
    t.swapped = any(4) == 0;
    t.shuffled = coin();
    lies_ = lies_ || t.spoiled > 0;
  }

  void be_honest() {
    w_.port.incoming = w_.port.outgoing = {};
    lies_ = false;
  }

  // The TPDO says another state, another place or another torque.
  void lie() {
    lies_ = true;
    w_.port.incoming.concerns = is_of_the_drive;
    constexpr std::uint16_t words[] = {0x0240, 0x0221, 0x0223, 0x0227, 0x0237, 0x0207, 0x021F, 0x0218, 0x1237, 0xFFFF};
    const int which = any(3);
    const std::uint16_t word = words[any(10)];
    const auto offset = static_cast<std::uint32_t>(between(-1, 1) * decades(1, 2e9));
    const auto torque = static_cast<std::uint16_t>(static_cast<int>(between(-4000, 4000)));
    w_.port.incoming.lie = [=](hal::CanFrame& frame) {
      if (frame.id != canopen::tpdo_cob_id(1, FaultWorld::drive_id)) return;
      if (which == 0) canopen::store_little_endian(frame.data, word, 0);
      if (which == 1)
        canopen::store_little_endian(frame.data, canopen::load_little_endian<std::uint32_t>(frame.data, 2) + offset, 2);
      if (which == 2) canopen::store_little_endian(frame.data, torque, 6);
    };
  }

  // Another tool writes the controlword, the mode, a torque or a PDO's identifier.
  void write() {
    struct Write {
      std::uint16_t index;
      std::uint8_t sub;
      std::uint32_t value;
      std::uint8_t bytes;
    };
    static constexpr Write writes[] = {{0x6040, 0, 0x06, 2}, {0x6040, 0, 0x07, 2},       {0x6040, 0, 0x0F, 2},
                                       {0x6040, 0, 0x80, 2}, {0x6060, 0, 10, 1},         {0x6060, 0, 6, 1},
                                       {0x6071, 0, 900, 2},  {0x1400, 1, 0x80000201, 4}, {0x1800, 1, 0xC0000181, 4},
                                       {0x1005, 0, 0x81, 4}, {0x6072, 0, 300, 2},        {0x1017, 0, 0, 2},
                                       {0x1016, 1, 0, 4},    {0x605A, 0, 2, 2},          {0x1400, 5, 0, 2}};
    const Write& write = writes[any(static_cast<int>(std::size(writes)))];
    w_.by_service_port = coin();
    w_.write_to_drive(write.index, write.sub, write.value, write.bytes);
  }

  bool recovers() {
    be_honest();
    w_.controller_runs = true;
    w_.drive().set_silent(false);
    w_.drive().inhibit_beyond({}, w_.now());
    w_.axis.unlock();
    for (int attempt = 0; attempt < 6; ++attempt) {
      w_.wish = {};
      w_.run(500ms);
      for (int i = 0; i < 30000 && !w_.axis.at_rest(); ++i) w_.step();
      w_.wish.reset_fault = true;
      for (int i = 0; i < 3000 && (w_.fault() != AxisFault::none || i < 200); ++i) w_.step();
      w_.wish = {};
      w_.run(150ms);
      w_.wish.enable = true;
      for (int i = 0; i < 40000 && w_.fault() == AxisFault::none; ++i) {
        w_.step();
        if (w_.on_target()) return true;
      }
    }
    return false;
  }

  FaultWorld w_;
  std::string wrong_, acts_;
  hal::Time unwished_at_{}, withdrawn_at_{};
  bool restarted_ = false, lies_ = false;
};

TEST(AdversaryCampaign, NeverGetsForceBeyondItsLimitOrAnEndWithoutANameAndTheAxisRecovers) {
  const CampaignNode node = make_node(true);
  ASSERT_TRUE(verify(node).ok()) << to_string(verify(node).error);
  const long fights = from_environment("BREAKAWAY_FIGHTS", 60), first = from_environment("BREAKAWAY_FIRST_FIGHT", 0);
  for (long i = first; i < first + fights; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    EXPECT_EQ((Adversary{node, seed}.fight(5 + static_cast<int>(seed % 25))), "") << "fight " << i;
  }
}

}  // namespace
}  // namespace breakaway::campaign
