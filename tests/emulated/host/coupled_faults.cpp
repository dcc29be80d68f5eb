#include "coupled_faults.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <random>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sync.hpp"

namespace breakaway::emulated {
namespace {

using campaign::Tampering;
using Frame = hal::CanFrame;
using Faults = std::vector<CoupledFault>;

bool is_drives(const Frame& f) { return canopen::is_sync(f) || canopen::node_id_of(f.id) <= axes; }

// Of one axis' drive, of SYNC, or of all that the controller hears, or hears and says.
void add_frames(Faults& list) {
  const auto frames = [&](const char* name, void (*how)(FlashedGantry&, Tampering&)) {
    list.push_back(
        {name,
         [how](FlashedGantry& g, std::size_t axis) {
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
  frames("frames lost", [](FlashedGantry& g, Tampering& t) { t.lost = decades(g, 1e-3, 1); });
  frames("frames late", [](FlashedGantry& g, Tampering& t) {
    t.late = decades(g, 1e-2, 1);
    t.late_by_periods = coin(g) ? 1 : 20;
  });
  frames("frames doubled", [](FlashedGantry& g, Tampering& t) { t.doubled = decades(g, 1e-2, 1); });
  frames("frames shuffled", [](FlashedGantry&, Tampering& t) { t.shuffled = true; });
  frames("frames spoiled", [](FlashedGantry& g, Tampering& t) { t.spoiled = decades(g, 1e-3, 1); });
  frames("a burst lost", [](FlashedGantry& g, Tampering& t) {
    t.lost = 1;
    g.each_period = [&g, &t, end = g.now() + std::chrono::milliseconds{static_cast<int>(decades(g, 1, 100))}] {
      if (g.now() >= end) t.lost = 0;
    };
  });
}

void add_bus(Faults& list) {
  list.push_back({"bus off", [](FlashedGantry& g, std::size_t) { g.bus_state(hal::BusState::bus_off); }, true, true});
  list.push_back({"controller starved",
                  [](FlashedGantry& g, std::size_t) {
                    g.controller_runs = false;
                    g.run(std::chrono::milliseconds{static_cast<int>(decades(g, 2, 400))});
                    g.controller_runs = true;
                  },
                  true, true});
  list.push_back({"another SYNC",
                  [](FlashedGantry& g, std::size_t) { g.each_period = [&g] { g.send(canopen::sync_frame()); }; }, true,
                  true});
  list.push_back({"another master's command",
                  [](FlashedGantry& g, std::size_t axis) {
                    Frame f{.id = canopen::rpdo_cob_id(1, static_cast<std::uint8_t>(axis + 1)), .size = 8, .data = {}};
                    f.data[0] = 0x0F;
                    canopen::store_little_endian(f.data, static_cast<std::int16_t>(between(g, -2000, 2000)), 2);
                    if (coin(g)) return g.send(f);
                    g.each_period = [&g, f] { g.send(f); };
                  },
                  false, true});
}

void add_drives(Faults& list) {
  list.push_back({"drive trips", [](FlashedGantry& g, std::size_t a) { g.drive(a).trip_fault(0x2310, g.now()); }});
  list.push_back({"drive reboots",
                  [](FlashedGantry& g, std::size_t a) {
                    g.drive(a).power_off(g.now());
                    g.drive(a).power_on(g.now());
                  },
                  false, true});
  list.push_back(
      {"drive without power", [](FlashedGantry& g, std::size_t a) { g.drive(a).power_off(g.now()); }, false, true});
  list.push_back({"cable pulled", [](FlashedGantry& g, std::size_t a) { g.drive(a).set_silent(true); }, false, true});
  list.push_back({"heartbeat lost", [](FlashedGantry& g, std::size_t a) { g.drive(a).suppress_heartbeat(true); }});
  list.push_back({"drive falls back", [](FlashedGantry& g, std::size_t a) {
                    constexpr std::array states{cia402::State::switch_on_disabled, cia402::State::ready_to_switch_on,
                                                cia402::State::switched_on};
                    g.drive(a).inhibit_beyond(states[g.random() % 3], g.now());
                  }});
  list.push_back({"EMCY", [](FlashedGantry& g, std::size_t a) {
                    g.send(canopen::emcy_frame({.code = 0x3210}, static_cast<std::uint8_t>(a + 1)));
                  }});
  list.push_back({"force saturated",
                  [](FlashedGantry& g, std::size_t a) { g.drive(a).limit_peak_force(decades(g, 1, 90), g.now()); }});
}

// By another tool.
void add_written(Faults& list) {
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
                    [w](FlashedGantry& g, std::size_t a) {
                      const bool pdo = w.index == 0x1400 || w.index == 0x1800;
                      g.write(a, coin(g), w.index, w.sub,
                              w.value + (pdo && w.sub == 1 ? static_cast<std::uint32_t>(a + 1) : 0U), w.bytes);
                    },
                    false, w.deaf});
}

void add_network_management(Faults& list) {
  for (const auto command : {canopen::NmtCommand::stop, canopen::NmtCommand::enter_pre_operational,
                             canopen::NmtCommand::reset_node, canopen::NmtCommand::reset_communication})
    list.push_back({"NMT of another node",
                    [command](FlashedGantry& g, std::size_t a) {
                      const bool all = g.random() % 4 == 0;
                      g.send(canopen::nmt_frame(command, all ? std::uint8_t{0} : static_cast<std::uint8_t>(a + 1)));
                    },
                    true, true});
}

void add_encoders(Faults& list) {
  const auto encoder = [&](const char* name, std::function<std::function<double(double)>(FlashedGantry&, double)> how) {
    list.push_back({name,
                    [how](FlashedGantry& g, std::size_t a) { g.encoders[a].shown = how(g, g.encoders[a].true_m()); },
                    false, false, true});
  };
  encoder("encoder frozen", [](FlashedGantry&, double at_m) { return [at_m](double) { return at_m; }; });
  encoder("encoder jumps", [](FlashedGantry& g, double) {
    return [jump_m = (coin(g) ? 1 : -1) * decades(g, 2e-6, 10)](double m) { return m + jump_m; };
  });
  encoder("encoder reversed", [](FlashedGantry&, double at_m) { return [at_m](double m) { return 2 * at_m - m; }; });
}

}  // namespace

double between(FlashedGantry& g, double low, double high) {
  return std::uniform_real_distribution<>{low, high}(g.random);
}
double decades(FlashedGantry& g, double low, double high) { return low * std::pow(high / low, between(g, 0, 1)); }
bool coin(FlashedGantry& g) { return (g.random() & 1U) != 0; }

std::vector<CoupledFault> coupled_faults() {
  Faults list;
  add_frames(list);
  add_bus(list);
  add_drives(list);
  add_written(list);
  add_network_management(list);
  add_encoders(list);
  list.push_back({"nothing but a target", [](FlashedGantry&, std::size_t) {}});
  return list;
}

void mend(FlashedGantry& g) {
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

}  // namespace breakaway::emulated
