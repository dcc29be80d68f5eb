#include "breakaway/scenario/read_scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/parse_toml.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"
#include "played_sheet.hpp"
#include "read_coupled.hpp"
#include "read_friction.hpp"
#include "read_plant.hpp"
#include "read_quirks.hpp"

namespace breakaway::scenario {
namespace {

using namespace config;

constexpr Range not_negative{0, 1e12};
constexpr Range anywhere{-1e9, 1e9};
constexpr Range delay{0, 1};

Key seed(std::uint64_t& to) {
  return optional("seed", integer([&to](std::int64_t n) { to = static_cast<std::uint64_t>(n); }, 0, INT64_MAX));
}

// The upper end of a range whose lower end is read before it.
Value upper_delay(hal::Duration& to, const hal::Duration& least, std::string_view lower) {
  Value value = duration_s(to, delay);
  value.expects += fmt::format(", not below {}", lower);
  value.take = [take = value.take, &to, &least](const Entry& entry) { return take(entry) && to >= least; };
  return value;
}

constexpr double fastest_rad_s = 1e6;

// What no run could follow, and what contradicts itself.
void require_sound_plant(const Node& node, const Axis& axis, const AxisWorld& world) {
  const auto fail = [&](const std::string& what) {
    throw InputError{(node.axes.size() == 1 ? std::string{} : "axis " + axis.name + ": ") + what}.in_file(node.file);
  };
  const model::CompliantPlant& plant = world.plant;
  if (world.gap_m > 0 && !plant.load) fail("[plant.backlash] needs a [plant.load]: give the load behind the gap");
  double mass_kg = truth_of(axis).mass_kg, stiffness_N_per_m = 0;
  if (plant.presliding) stiffness_N_per_m += plant.presliding->stiffness_N_per_m;
  if (plant.load) {
    mass_kg = std::min(mass_kg, plant.load->mass_kg);
    stiffness_N_per_m += plant.load->coupling.stiffness_N_per_m;
  }
  if (const double fast_rad_s = std::sqrt(stiffness_N_per_m / mass_kg); fast_rad_s > fastest_rad_s)
    fail(
        fmt::format("[plant] vibrates at about {:.2g} rad/s, faster than the {:g} rad/s that a run can follow; lower "
                    "stiffness_N_per_m to {:.2g} at most",
                    fast_rad_s, fastest_rad_s, mass_kg * fastest_rad_s * fastest_rad_s));
}

// An axis on a machine starts where that does.
void require_possible_start(const Node& node, const Axis& axis, const AxisWorld& world,
                            const std::optional<CoupledMachine>& machine) {
  const double start_m = machine ? world.place->read.dot(machine->start.q) : world.position_m;
  if (const std::string problem = start_problem(axis, world, start_m); !problem.empty())
    throw InputError{fmt::format("{}{} = {:.10g} {}",
                                 node.axes.size() == 1 ? std::string{} : "axis " + axis.name + ": ",
                                 machine ? "what it reads of [start] q" : "[plant] position_m", start_m, problem)}
        .in_file(node.file);
}

// The error of an axis that limits its position is counted by these, if it begins between them.
std::string uncounted_start(const Axis& axis, double start_m) {
  double farthest_m = std::max(std::abs(start_m), std::abs(start_m - axis.controller.target_m));
  for (const TargetChange& change : axis.controller.targets)
    farthest_m = std::max(farthest_m, std::abs(start_m - change.position_m));
  if (is_counted(farthest_m, axis)) return {};
  return fmt::format(
      "is {:g} m from the encoder's zero or from a target, more than 32 bits count of encoder_resolution_m = {:g}; "
      "begin nearer, or take a larger unit",
      farthest_m, axis.drive->encoder_resolution_m);
}

// A rigid axis at its start. What makes it more than that, a [machine] has itself.
bool says_nothing_of_motion(const AxisWorld& world) {
  return world.plant.rigid() && world.plant.force_N == 0 && world.gap_m == 0 && !world.drift && world.position_m == 0 &&
         world.velocity_m_s == 0;
}

void require_sound_place(const Axis& axis, const AxisWorld& world, bool has_law, bool has_place, bool has_machine) {
  const auto fail = [&](const std::string& what) { throw InputError{"axis " + axis.name + ": " + what}; };
  if (has_place && !has_machine) fail("[plant.machine] needs a [machine]: describe the one that it pushes");
  if (!has_machine) return;
  if (axis.drive && axis.drive->odrive)
    fail(
        "[drive] protocol = \"odrive\" stands beside a [machine], whose axes speak \"canopen\" so far; take that, or "
        "leave the [machine] out");
  if (!has_place)
    fail(
        "[plant.machine] is missing: say which coordinate of the [machine] its drive pushes, as machine = { push = 1 "
        "}");
  if (has_law || !says_nothing_of_motion(world))
    fail(
        "[plant] and [friction] say how an axis alone moves, and this one moves as the [machine] does: put forces, "
        "springs and friction there, and where it starts into [start]");
  const Truth truth = truth_of(axis);
  if (truth.mass_kg != axis.mass_kg || truth.bounds.lower_N != axis.friction.bounds.lower_N ||
      truth.bounds.upper_N != axis.friction.bounds.upper_N)
    fail(
        "[told] mass_kg and friction stand beside a [machine], which is the truth: write what the controller is told "
        "into [plant] mass_kg and [friction]");
}

// What a file says of the world, while it is read.
class WorldReader {
 public:
  FileRows rows() {
    return {.root = root_rows(), .loop = {}, .bus = bus_rows(), .run = run_rows(), .axis = [this](std::size_t) {
              return axis_rows();
            }};
  }

  // The scenario around the node that was read with these rows.
  Scenario finish(Node node) {
    Scenario s;
    s.machine = coupled_machine();
    for (std::size_t i = 0; i < node.axes.size(); ++i) {
      AxisWorld& world = worlds_[i].world;
      world.friction = {truth_of(node.axes[i]).bounds, std::move(worlds_[i].shape)};
      if (node.axes[i].drive) emulate_drive(node, node.axes[i], worlds_[i]);
      if (world.plant.load) world.plant.load->coupling.gap_m = world.gap_m;
      require_sound_plant(node, node.axes[i], world);
      world.place = place_of(node, i, s.machine);
      require_possible_start(node, node.axes[i], world, s.machine);
      s.worlds.push_back(std::move(world));
    }
    s.scalar = scalar_type(node);
    if (node.bit_rate) {
      bus_.bit_rate = *node.bit_rate;
      bus_.max_delay = std::max(bus_.min_delay, bus_.max_delay);
      s.bus = bus_;
    }
    if (has_run_) s.run = run_;
    s.node = std::move(node);
    require_told(s);
    return s;
  }

 private:
  struct ReadAxis {
    AxisWorld world;
    std::optional<PlaceInFile> place;
    model::ShapePtr shape = model::shape::constant(1);
    bool has_law = false;
    ScalarType scalar = ScalarType::float32;
    hal::Duration min_tpdo_delay = drive_emulator::EmulatorConfig{}.min_tpdo_delay;
    hal::Duration max_tpdo_delay = drive_emulator::EmulatorConfig{}.max_tpdo_delay;
    std::uint64_t seed = 1;
    drive_emulator::Quirks quirks{};
    bool has_torque_base = false;  // among the quirks; else the drive has that of which the node is told
  };

  // A deque, because the rows refer to its elements.
  AxisRows axis_rows() {
    ReadAxis& a = worlds_.emplace_back();
    return {.plant = plant_rows(a.world) + std::vector<Key>{optional("machine", table([&a](const Section& section) {
                                                                       read_place(section, a.place.emplace());
                                                                     }))},
            .friction = {optional("law", table(
                                             [&a](const Section& law) {
                                               a.shape = read_shape(law);
                                               a.has_law = true;
                                             },
                                             "law"))},
            .controller = {optional(
                "scalar", choice(a.scalar, {{"float", ScalarType::float32}, {"double", ScalarType::float64}}))},
            .drive = {optional("tpdo_delay_min_s", duration_s(a.min_tpdo_delay, delay)),
                      optional("tpdo_delay_max_s", upper_delay(a.max_tpdo_delay, a.min_tpdo_delay, "tpdo_delay_min_s")),
                      seed(a.seed),
                      optional("quirks", table([&a](const Section& section) { read_quirks_of(section, a); }))}};
  }

  static void read_quirks_of(const Section& section, ReadAxis& axis) {
    read_quirks(section, axis.quirks);
    axis.has_torque_base = section.has("torque_relative_to_max");
  }

  static std::vector<Key> plant_rows(AxisWorld& world) {
    const auto part = [&world](void (*read)(const Section&, AxisWorld&)) {
      return table([&world, read](const Section& section) { read(section, world); });
    };
    return {optional("position_m", number(world.position_m, "m", anywhere)),
            optional("velocity_m_s", number(world.velocity_m_s, "m/s", anywhere)),
            optional("force_N", number(world.plant.force_N, "N", {-1e12, 1e12})),
            optional("presliding", part(read_presliding)),
            optional("load", part(read_load)),
            optional("backlash", part(read_backlash)),
            optional("cogging", part(read_cogging)),
            optional("ripple", part(read_ripple)),
            optional("encoder_error", part(read_encoder_error)),
            optional("drift", part(read_drift))};
  }

  std::vector<Key> root_rows() {
    const auto keep = [](std::optional<Section>& to) { return table([&to](const Section& part) { to = part; }); };
    return {optional("machine", keep(machine_)), optional("start", keep(start_))};
  }

  std::optional<CoupledMachine> coupled_machine() const {
    if (start_ && !machine_) start_->fail("q", "needs a [machine]; an axis alone starts at position_m of its [plant]");
    if (!machine_) return {};
    CoupledMachine coupled{read_coupled_machine(*machine_), {}};
    const Eigen::Index n = coupled.machine.coordinates();
    coupled.start.q.setZero(n), coupled.start.v.setZero(n);
    if (start_) coupled.start = read_start(*start_, n, anywhere);
    return coupled;
  }

  std::optional<MachinePlace> place_of(const Node& node, std::size_t i,
                                       const std::optional<CoupledMachine>& machine) const {
    const std::optional<PlaceInFile>& place = worlds_[i].place;
    try {
      require_sound_place(node.axes[i], worlds_[i].world, worlds_[i].has_law, place.has_value(), machine.has_value());
      return machine ? std::optional{place_in(*machine, *place, node.axes[i].name)} : std::nullopt;
    } catch (const InputError& error) {
      throw error.in_file(node.file);
    }
  }

  std::vector<Key> bus_rows() {
    return {optional("loss_probability", number(bus_.loss_probability, "", {0, 1})),
            optional("delay_min_s", duration_s(bus_.min_delay, delay)),
            optional("delay_max_s", upper_delay(bus_.max_delay, bus_.min_delay, "delay_min_s")), seed(bus_.seed)};
  }

  std::vector<Key> run_rows() {
    return {required("duration_s", number(
                                       [this](double value) {
                                         run_.duration_s = value;
                                         has_run_ = true;
                                       },
                                       "s", {0, 1e6, true})),
            optional("settle_time_s", number(run_.settle_time_s, "s", not_negative)),
            optional("stop_when_settled", boolean(run_.stop_when_settled)),
            optional("accuracy_m", number(run_.accuracy_m, "m", positive))};
  }

  static void emulate_drive(const Node& node, const Axis& described, ReadAxis& axis) {
    if (described.drive->odrive)
      axis.world.odrive = odrive_emulator(node, described);
    else
      axis.world.drive = emulator(node, described, axis);
  }

  static odrive_emulator::EmulatorConfig odrive_emulator(const Node& node, const Axis& described) {
    const Drive& drive = *described.drive;
    const Odrive& o = *drive.odrive;
    const bool polled = o.estimates == odrive::Estimates::polled;
    odrive_emulator::EmulatorConfig c;
    c.node_id = drive.node_id;
    c.force_per_torque_N_per_Nm = truth_of(described).force_per_torque_N_per_Nm;
    c.travel_per_turn_m = o.travel_per_turn_m;
    c.max_torque_Nm = std::min(o.max_torque_Nm, drive.peak_force_N.value_or(unlimited) / c.force_per_torque_N_per_Nm);
    if (o.torque_constant_Nm_per_A) c.torque_constant_Nm_per_A = *o.torque_constant_Nm_per_A;
    c.current_loop_time_constant_s = drive.current_loop_time_constant_s;
    c.encoder_resolution_m = drive.encoder_resolution_m;
    c.heartbeat_period = drive.heartbeat_period;
    c.estimate_period = c.torque_period = polled ? hal::Duration{} : o.estimate_period;
    // Its owner gives it time for two commands that are lost, however slow the loop is.
    if (node.loop) c.watchdog_timeout = std::max(c.watchdog_timeout, 3 * node.loop->period);
    return c;
  }

  static drive_emulator::EmulatorConfig emulator(const Node& node, const Axis& described, const ReadAxis& axis) {
    const Drive& drive = *described.drive;
    drive_emulator::EmulatorConfig c;
    c.node_id = drive.node_id;
    c.rated_torque_mNm = drive.rated_torque_mNm;
    c.rated_current_mA = drive.rated_current_mA;
    c.max_torque_per_mille = drive.max_torque_per_mille;
    c.force_per_torque_N_per_Nm = truth_of(described).force_per_torque_N_per_Nm;
    c.peak_force_N = drive.peak_force_N;
    c.current_loop_time_constant_s = drive.current_loop_time_constant_s;
    c.encoder_resolution_m = drive.encoder_resolution_m;
    // A unit of position is then so many counts of the encoder, and the file says its travel.
    if (const std::uint32_t units = axis.quirks.feed_constant; drive.user_position_unit && units != 0)
      c.encoder_resolution_m *= units / double{drive_emulator::encoder_counts_per_revolution};
    c.min_tpdo_delay = axis.min_tpdo_delay;
    c.max_tpdo_delay = std::max(axis.min_tpdo_delay, axis.max_tpdo_delay);
    c.seed = axis.seed;
    c.quirks = axis.quirks;
    if (!axis.has_torque_base) c.quirks.torque_relative_to_max = drive.torque_base == cia402::TorqueBase::largest;
    if (drive.data_sheet && node.loop) play_sheet(node, described, c);
    return c;
  }

  // One loop computes in one type.
  ScalarType scalar_type(const Node& node) const {
    const ScalarType first = worlds_.front().scalar;
    for (const ReadAxis& axis : worlds_) {
      if (axis.scalar != first)
        throw InputError{"[controller] scalar differs from axis to axis; a loop computes in one type"}.in_file(
            node.file);
    }
    return first;
  }

  std::deque<ReadAxis> worlds_;
  std::optional<Section> machine_, start_;
  virtual_bus::VirtualBusConfig bus_;
  Run run_;
  bool has_run_ = false;
};

Scenario read_document(const toml::table& document, const std::string& name, KnownTables* known) {
  WorldReader world;
  return world.finish(config::read_node(document, name, world.rows(), known));
}

}  // namespace

Scenario parse_scenario(std::string_view text, const std::string& name, KnownTables* known) {
  return with_document(text, name, [&](const toml::table& document) { return read_document(document, name, known); });
}

Scenario read_scenario(const std::filesystem::path& file) {
  return parse_scenario(file_contents(file), shown_name(file));
}

std::string start_problem(const Axis& axis, const AxisWorld& world, double position_m) {
  if (std::string problem = uncounted_start(axis, position_m); !problem.empty()) return problem;
  if (axis.drive && begins_at_home(axis.drive->homing) &&
      std::abs(position_m - axis.drive->homing.position_m) > axis.drive->encoder_resolution_m)
    return fmt::format(
        "is not where [drive] home says that the axis stands when it begins, home_position_m = {:g}; give both the "
        "same",
        axis.drive->homing.position_m);
  const bool reads_the_truth = axis.drive && axis.drive->homing.home == cia402::Home::none &&
                               !(world.drive && world.drive->quirks.counts_from_power_on);
  const Limits& limits = axis.limits;
  if (!reads_the_truth || (position_m >= limits.position_min_m && position_m <= limits.position_max_m)) return {};
  return fmt::format(
      "is outside the [limits], {:.10g} to {:.10g} m, where the axis is stopped at once; begin between them, "
      "or widen them",
      limits.position_min_m, limits.position_max_m);
}

Scenario only_axis(const Scenario& scenario, const std::string& name) {
  const auto& axes = scenario.node.axes;
  const auto found = std::ranges::find(axes, name, &Axis::name);
  if (found == axes.end()) {
    std::string names;
    for (const Axis& axis : axes) names += (names.empty() ? "\"" : ", \"") + axis.name + "\"";
    throw InputError{fmt::format("has no axis \"{}\"; it has {}", name, names)}.in_file(scenario.node.file);
  }
  if (scenario.machine && axes.size() > 1)
    throw InputError{
        "has a [machine] that its axes share, so that none can be taken alone; leave the choice of an axis "
        "out, or give it a file of its own"}
        .in_file(scenario.node.file);
  Scenario one = scenario;
  one.node.axes = {*found};
  one.worlds = {scenario.worlds[static_cast<std::size_t>(found - axes.begin())]};
  return one;
}

}  // namespace breakaway::scenario
