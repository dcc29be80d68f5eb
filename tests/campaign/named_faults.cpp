#include "named_faults.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/heartbeat.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sync.hpp"

namespace breakaway::campaign {
namespace {

using canopen::NmtCommand;
using cia402::State;

double between(FaultWorld& w, double low, double high) { return std::uniform_real_distribution<>{low, high}(w.random); }
double decades(FaultWorld& w, double low, double high) { return low * std::pow(high / low, between(w, 0, 1)); }
bool coin(FaultWorld& w) { return (w.random() & 1U) != 0; }

bool is_tpdo(const hal::CanFrame& frame) { return frame.id == canopen::tpdo_cob_id(1, FaultWorld::drive_id); }
bool is_rpdo(const hal::CanFrame& frame) { return frame.id == canopen::rpdo_cob_id(1, FaultWorld::drive_id); }
bool is_cyclic(const hal::CanFrame& frame) { return is_tpdo(frame) || is_rpdo(frame) || canopen::is_sync(frame); }
bool is_any(const hal::CanFrame&) { return true; }
// A command that is spoiled is a wish of the commander, and not a fault.
bool is_of_the_drive(const hal::CanFrame& frame) {
  return canopen::node_id_of(frame.id) == FaultWorld::drive_id || canopen::is_sync(frame);
}

void nothing(FaultWorld&) {}
void end_tampering(FaultWorld& w) { w.port.incoming = w.port.outgoing = {}; }
void end_each_period(FaultWorld& w) { w.each_period = nullptr; }
void mend_encoder(FaultWorld& w) {
  w.axis.encoder = [](double position_m) { return position_m; };
}

NamedFault written(std::string name, std::uint16_t index, std::uint8_t sub, std::uint32_t value, std::uint8_t bytes,
                   Stop stop) {
  return {std::move(name),
          [=](FaultWorld& w) {
            w.by_service_port = coin(w);
            w.write_to_drive(index, sub, value, bytes);
          },
          nothing, stop};
}

NamedFault nmt(std::string name, NmtCommand command, Stop stop = Stop::escalated) {
  return {std::move(name), [command](FaultWorld& w) { w.send(canopen::nmt_frame(command, FaultWorld::drive_id)); },
          nothing, stop};
}

// Both directions, or one of them.
NamedFault tampered(std::string name, std::function<void(FaultWorld&, Tampering&)> how,
                    bool (*concerns)(const hal::CanFrame&), Stop stop = Stop::escalated) {
  return {std::move(name),
          [how = std::move(how), concerns](FaultWorld& w) {
            const auto which = w.random() % 3;
            for (Tampering* t : {&w.port.incoming, &w.port.outgoing}) {
              if ((which == 1 && t == &w.port.outgoing) || (which == 2 && t == &w.port.incoming)) continue;
              t->concerns = concerns;
              how(w, *t);
            }
          },
          end_tampering, stop};
}

void add_written(std::vector<NamedFault>& list) {
  list.push_back(written("RPDO1 switched off by another tool", 0x1400, 1, 0x80000201, 4, Stop::escalated));
  list.push_back(written("TPDO1 switched off by another tool", 0x1800, 1, 0xC0000181, 4, Stop::escalated));
  list.push_back(written("TPDO1 sent every second SYNC only", 0x1800, 2, 2, 1, Stop::escalated));
  list.push_back(written("drive listens for another SYNC (1005h)", 0x1005, 0, 0x81, 4, Stop::escalated));
  list.push_back(written("force added by 60B2h", 0x60B2, 0, 600, 2, Stop::at_once));
  list.push_back(written("6072h lowered", 0x6072, 0, 300, 2, Stop::at_once));
  list.push_back(written("heartbeat switched off (1017h)", 0x1017, 0, 0, 2, Stop::at_once));
  list.push_back(written("another mode of operation (6060h)", 0x6060, 0, 0, 1, Stop::at_once));
  list.push_back(written("controlword 0 from another tool", 0x6040, 0, 0, 2, Stop::at_once));
  list.push_back({"6072h raised and force added by 60B2h",
                  [](FaultWorld& w) {
                    w.by_service_port = coin(w);
                    w.write_to_drive(0x6072, 0, 4000, 2);
                    w.write_to_drive(0x60B2, 0, coin(w) ? 3500 : 0xFFFFU - 3500, 2);
                  },
                  nothing, Stop::at_once, false, false, true});
  list.push_back({"enabled with force by another tool",
                  [](FaultWorld& w) {
                    w.by_service_port = coin(w);
                    w.write_to_drive(0x6060, 0, 10, 1);
                    w.write_to_drive(0x6071, 0, 900, 2);
                    for (const std::uint32_t controlword : {0x06U, 0x07U, 0x0FU})
                      w.write_to_drive(0x6040, 0, controlword, 2);
                  },
                  nothing, Stop::escalated});
  list.push_back({"enabled with force after its TPDO1 was switched off",
                  [](FaultWorld& w) {
                    w.by_service_port = coin(w);
                    w.write_to_drive(0x1800, 1, 0xC0000181, 4);
                    w.write_to_drive(0x1400, 1, 0x80000201, 4);
                    w.write_to_drive(0x6071, 0, 900, 2);
                    for (const std::uint32_t controlword : {0x06U, 0x07U, 0x0FU})
                      w.write_to_drive(0x6040, 0, controlword, 2);
                  },
                  nothing, Stop::escalated});
}

void add_bus(std::vector<NamedFault>& list) {
  list.push_back({"SYNC lost",
                  [](FaultWorld& w) {
                    w.port.outgoing.concerns = canopen::is_sync;
                    w.port.outgoing.lost = 1;
                  },
                  end_tampering, Stop::escalated});
  list.push_back(nmt("NMT Enter Pre-operational by another node", NmtCommand::enter_pre_operational));
  list.push_back(nmt("NMT Stop by another node", NmtCommand::stop));
  list.push_back(nmt("NMT Reset node by another node", NmtCommand::reset_node));
  list.push_back(nmt("NMT Reset communication by another node", NmtCommand::reset_communication));
  list.push_back({"heartbeat lost", [](FaultWorld& w) { w.drive().suppress_heartbeat(true); },
                  [](FaultWorld& w) { w.drive().suppress_heartbeat(false); }});
  list.push_back({"bus-off", [](FaultWorld& w) { w.controller_port().set_bus_state(hal::BusState::bus_off); },
                  [](FaultWorld& w) { w.controller_port().set_bus_state(hal::BusState::error_active); },
                  Stop::escalated});
  list.push_back({"cable of the drive pulled", [](FaultWorld& w) { w.drive().set_silent(true); },
                  [](FaultWorld& w) { w.drive().set_silent(false); }, Stop::escalated});
  list.push_back(tampered(
      "frames lost", [](FaultWorld& w, Tampering& t) { t.lost = decades(w, 1e-3, 1); }, is_any));
  list.push_back(tampered(
      "frames late",
      [](FaultWorld& w, Tampering& t) {
        t.late = decades(w, 1e-2, 1);
        t.late_by_periods = coin(w) ? 1 : 20;
      },
      is_any));
  list.push_back(tampered(
      "frames doubled", [](FaultWorld& w, Tampering& t) { t.doubled = decades(w, 1e-2, 1); }, is_any));
  list.push_back(tampered(
      "frames in another order", [](FaultWorld&, Tampering& t) { t.shuffled = true; }, is_any));
  list.push_back(tampered(
      "frames spoiled", [](FaultWorld& w, Tampering& t) { t.spoiled = decades(w, 1e-3, 1); }, is_of_the_drive));
  list.push_back({"TPDOs exchanged in pairs",
                  [](FaultWorld& w) {
                    w.port.incoming.concerns = is_tpdo;
                    w.port.incoming.swapped = true;
                  },
                  end_tampering, Stop::escalated});
  list.push_back(tampered(
      "cyclic frames lost now and then", [](FaultWorld& w, Tampering& t) { t.lost = decades(w, 1e-3, 0.1); },
      is_cyclic));
  list.push_back({"bus flooded",
                  [](FaultWorld& w) {
                    w.each_period = [&w] {
                      for (int i = 0; i < 9; ++i) w.send({.id = 0x010, .size = 8, .data = {0x55, 0xAA}});
                    };
                  },
                  end_each_period, Stop::escalated});
  list.push_back({"another master's SYNC",
                  [](FaultWorld& w) { w.each_period = [&w] { w.send(canopen::sync_frame()); }; }, end_each_period});
  list.push_back({"another master's commands",
                  [](FaultWorld& w) {
                    hal::CanFrame enabled{
                        .id = canopen::rpdo_cob_id(1, FaultWorld::drive_id), .size = 8, .data = {0x0F}};
                    const auto torque = static_cast<std::int16_t>(decades(w, 1, 2000) * (coin(w) ? 1 : -1));
                    canopen::store_little_endian(enabled.data, torque, 2);
                    w.each_period = [&w, enabled] { w.send(enabled); };
                  },
                  end_each_period, Stop::escalated});
  list.push_back({"another node's heartbeat with our id",
                  [](FaultWorld& w) { w.send(canopen::heartbeat_frame(canopen::NmtState::operational, 127)); },
                  nothing});
  list.push_back({"two drives with one node id", [](FaultWorld& w) { w.add_twin(); },
                  [](FaultWorld& w) { w.remove_twin(); }, Stop::escalated});
  list.push_back({"EMCY and its reset in one period",
                  [](FaultWorld& w) {
                    w.send(canopen::emcy_frame({.code = 0x3210}, FaultWorld::drive_id));
                    w.send(canopen::emcy_frame({}, FaultWorld::drive_id));
                  },
                  nothing});
}

void add_drive(std::vector<NamedFault>& list) {
  const auto inhibit = [](State highest) {
    return [highest](FaultWorld& w) { w.drive().inhibit_beyond(highest, w.now()); };
  };
  const auto release = [](FaultWorld& w) { w.drive().inhibit_beyond({}, w.now()); };
  list.push_back({"safe torque off", inhibit(State::switch_on_disabled), release});
  list.push_back({"no supply of the power stage", inhibit(State::ready_to_switch_on), release});
  list.push_back({"interlock of the drive", inhibit(State::switched_on), release});
  list.push_back({"drive trips", [](FaultWorld& w) { w.drive().trip_fault(0x2310, w.now()); }, nothing});
  list.push_back({"drive reboots",
                  [](FaultWorld& w) {
                    w.drive().power_off(w.now());
                    w.drive().power_on(w.now());
                  },
                  nothing, Stop::escalated});
  list.push_back({"drive without power", [](FaultWorld& w) { w.drive().power_off(w.now()); },
                  [](FaultWorld& w) { w.drive().power_on(w.now()); }, Stop::escalated});
  list.push_back({"SDO answers slow",
                  [](FaultWorld& w) {
                    w.drive().delay_sdo_responses(std::chrono::microseconds{static_cast<int>(decades(w, 5e3, 2e5))});
                  },
                  [](FaultWorld& w) { w.drive().delay_sdo_responses(200us); }});
  list.push_back({"force saturated", [](FaultWorld& w) { w.drive().limit_peak_force(decades(w, 1, 45), w.now()); },
                  [](FaultWorld& w) { w.drive().limit_peak_force(100, w.now()); }});
}

void add_axis(std::vector<NamedFault>& list) {
  list.push_back({"brake stuck", [](FaultWorld& w) { w.axis.lock(); }, [](FaultWorld& w) { w.axis.unlock(); }});
  list.push_back(
      {"encoder frozen",
       [](FaultWorld& w) { w.axis.encoder = [frozen_m = w.axis.true_position_m()](double) { return frozen_m; }; },
       mend_encoder, Stop::at_once, true});
  list.push_back({"encoder jumps",
                  [](FaultWorld& w) {
                    const double jump_m = (coin(w) ? 1 : -1) * decades(w, 0.02, 50);
                    w.axis.encoder = [jump_m](double position_m) { return position_m + jump_m; };
                  },
                  mend_encoder, Stop::at_once, true});
  list.push_back({"encoder wraps at 16 bit",
                  [](FaultWorld& w) {
                    w.axis.encoder = [](double position_m) {
                      return static_cast<double>(static_cast<std::int16_t>(std::llround(position_m * 1e6))) * 1e-6;
                    };
                  },
                  mend_encoder, Stop::at_once, true});
  list.push_back({"encoder reversed",
                  [](FaultWorld& w) {
                    w.axis.encoder = [at_m = w.axis.true_position_m()](double position_m) {
                      return 2 * at_m - position_m;
                    };
                  },
                  mend_encoder, Stop::at_once, true});
  list.push_back({"encoder noisy",
                  [](FaultWorld& w) {
                    w.axis.encoder = [&w, noise_m = decades(w, 2e-6, 0.1)](double position_m) {
                      return position_m + between(w, -noise_m, noise_m);
                    };
                  },
                  mend_encoder, Stop::at_once, true});
  list.push_back({"force gain wrong", [](FaultWorld& w) { w.axis.force_gain = decades(w, 0.05, 5); },
                  [](FaultWorld& w) { w.axis.force_gain = 1; }});
  list.push_back(
      {"force reversed", [](FaultWorld& w) { w.axis.force_gain = -1; }, [](FaultWorld& w) { w.axis.force_gain = 1; }});
}

void add_controller(std::vector<NamedFault>& list) {
  list.push_back({"controller starved",
                  [](FaultWorld& w) {
                    w.controller_runs = false;
                    w.run(std::chrono::milliseconds{static_cast<int>(decades(w, 2, 400))});
                    w.controller_runs = true;
                  },
                  nothing, Stop::escalated});
  list.push_back(
      {"controller restarted", [](FaultWorld& w) { w.start_controller(); }, nothing, Stop::escalated, false, true});
  list.push_back({"clock jumps",
                  [](FaultWorld& w) {
                    w.port.clock_ahead =
                        std::chrono::microseconds{static_cast<std::int64_t>((coin(w) ? 1 : -1) * decades(w, 2e3, 1e7))};
                  },
                  nothing, Stop::escalated});
  list.push_back({"remote commander falls silent", [](FaultWorld& w) { w.commander_lives = false; },
                  [](FaultWorld& w) { w.commander_lives = true; }});
}

// For up to half a second, with two to ten times the least friction, unless it was mended before.
void add_surroundings(std::vector<NamedFault>& list) {
  list.push_back({"axis dragged from outside",
                  [](FaultWorld& w) {
                    w.axis.foreign_N = (coin(w) ? 1 : -1) * decades(w, 5, 25);
                    const hal::Time end =
                        w.now() + std::chrono::microseconds{static_cast<std::int64_t>(decades(w, 5e3, 5e5))};
                    w.each_period = [&w, end] {
                      if (w.now() >= end) w.axis.foreign_N = 0;
                    };
                  },
                  [](FaultWorld& w) {
                    w.axis.foreign_N = 0;
                    end_each_period(w);
                  }});
}

}  // namespace

std::vector<NamedFault> named_faults() {
  std::vector<NamedFault> list;
  add_written(list);
  add_bus(list);
  add_drive(list);
  add_axis(list);
  add_controller(list);
  add_surroundings(list);
  return list;
}

}  // namespace breakaway::campaign
