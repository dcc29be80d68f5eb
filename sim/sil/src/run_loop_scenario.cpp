#include "breakaway/sil/run_loop_scenario.hpp"

#include <chrono>
#include <deque>
#include <memory>
#include <type_traits>
#include <variant>

#include "axis_run.hpp"
#include "breakaway/cia402/drive.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/machine_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/node_laws.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/law/pid_controller.hpp"
#include "breakaway/odrive/drive.hpp"
#include "plant_budget.hpp"

namespace breakaway::sil {
namespace {

template <class Real, class Controller, class Drive = cia402::Drive<Real>>
class LoopRun {
 public:
  using Loop = firmware::ControlLoop<SimulatedNetwork::Port, Drive, Controller, Real, config::most_axes>;

  LoopRun(const scenario::Scenario& s, const RecordingOptions& recording, const firmware::LoopConfig& config)
      : s_{s},
        recording_{recording},
        period_{config.network.period},
        budget_{plant_budget(s)},
        network_{*s.bus},
        loop_{network_.controller_port(), config} {
    if (recording.frames) network_.log_to(result_.frames);
  }

  Loop& loop() { return loop_; }

  // With all axes in the loop.
  Result run() {
    auto mechanisms = axis_mechanisms(s_, &budget_);
    machine_ = mechanisms.front().machine;
    for (std::size_t place = 0; place < loop_.axes(); ++place)
      axes_.emplace_back(s_, place, std::move(mechanisms[place]), network_, loop_);
    if (commission()) move();
    finish();
    return std::move(result_);
  }

 private:
  using Axis = AxisRun<Loop>;

  void step() {
    network_.begin_period(loop_, now_);
    now_ += period_;
  }
  // When the last step began.
  hal::Time stepped_at() const { return now_ - period_; }
  double scenario_time_s() const { return hal::seconds(stepped_at() - release_); }

  bool all(bool (Axis::*holds)() const) const {
    return std::ranges::all_of(axes_, [&](const Axis& axis) { return (axis.*holds)(); });
  }

  // Steps until the condition holds, or for as long as the set-up of a drive and its way home may take.
  void wait_for(const auto& condition) {
    hal::Duration patience{};
    for (const Axis& axis : axes_) patience = std::max(patience, axis.patience());
    for (const hal::Time begin = now_; !condition() && now_ - begin < patience;) {
      step();
      for (Axis& axis : axes_) axis.release_to_seek_home(hal::seconds(network_.bus().now()));
    }
  }

  void enable_those(const auto& chosen) {
    for (Axis& axis : axes_)
      if (chosen(axis)) axis.enable();
    wait_for([&] {
      return std::ranges::none_of(axes_, [&](const Axis& a) { return chosen(a) && !a.running() && !a.faulted(); });
    });
  }

  // Sets the drives up over the bus, has those move that seek their home, enables the others together, and opens the
  // brakes with the first command. False: no axis runs.
  bool commission() {
    wait_for([this] { return all(&Axis::configured); });
    if (all(&Axis::configured)) {
      enable_those([](const Axis& axis) { return axis.seeks_home(); });
      enable_those([](const Axis& axis) { return !axis.seeks_home(); });
    }
    release_ = stepped_at();
    for (Axis& axis : axes_) axis.release(hal::seconds(network_.bus().now()));
    network_.watch_sync(period_);
    busy_before_ = busy_at_release_ = network_.bus().counters().busy_time;
    return std::ranges::any_of(axes_, &Axis::running);
  }

  void move() {
    const double duration_s = s_.run->duration_s;
    note(0);
    for (double time_s = 0; time_s < duration_s;) {
      time_s = hal::seconds(now_ - release_);
      for (Axis& axis : axes_) axis.change_target(time_s);
      step();
      note(time_s);
      for (Axis& axis : axes_) axis.judge(time_s);
      if (recording_.progress) recording_.progress(time_s / duration_s);
      if (all(&Axis::over) && (s_.run->stop_when_settled || all(&Axis::faulted))) break;
    }
  }

  void note(double time_s) {
    const hal::Duration busy = network_.bus().counters().busy_time;
    const double load = hal::seconds(busy - busy_before_) / hal::seconds(period_);
    busy_before_ = busy;
    for (Axis& axis : axes_) axis.note(time_s, stepped_at(), load, recording_.trace);
    if (machine_ && recording_.trace) result_.machine_trace.push_back(machine_->state());
  }

  void finish() {
    result_.duration_s = scenario_time_s();
    LoopFigures figures;
    figures.ticks = loop_.statistics().ticks();
    figures.missed_ticks = loop_.statistics().missed_ticks();
    for (const Axis& axis : axes_) figures.missed_ticks += axis.periods_without_feedback();
    if (result_.duration_s > 0)
      figures.bus_load = hal::seconds(network_.bus().counters().busy_time - busy_at_release_) / result_.duration_s;
    figures.sync_off_s = hal::seconds(network_.sync_off());
    result_.loop = figures;
    result_.work = budget_.spent();
    result_.work_share = budget_.share();
    if (machine_) result_.machine_end = machine_->state();
    for (Axis& axis : axes_) result_.axes.push_back(axis.finish(stepped_at()));
  }

  const scenario::Scenario& s_;
  RecordingOptions recording_;
  hal::Duration period_;
  Result result_;
  motion::WorkBudget budget_;
  SimulatedNetwork network_;
  Loop loop_;
  std::shared_ptr<const DrivenMachine> machine_;
  std::deque<Axis> axes_;
  hal::Time now_{};
  hal::Time release_{};
  hal::Duration busy_before_{};
  hal::Duration busy_at_release_{};
};

bool speaks_odrive(const scenario::Scenario& s) { return s.node.axes.front().drive->odrive.has_value(); }

template <class Flashed>
Result run_flashed_odrives(const scenario::Scenario& s, const RecordingOptions& recording, const Flashed& node) {
  using Laws = firmware::NodeLaws<Flashed>;
  using Real = typename Laws::Scalar;
  Laws laws{node};
  LoopRun<Real, typename Laws::Law, odrive::Drive<Real>> run{s, recording, node.loop};
  for (std::size_t i = 0; i < node.count; ++i)
    static_cast<void>(
        run.loop().add_axis(config::odrive_config<Real>(s.node.axes[i]), laws.law_of(i), node.axes[i].limits));
  return run.run();
}

template <class Flashed>
Result run_flashed(const scenario::Scenario& s, const RecordingOptions& recording, const Flashed& node) {
  using Laws = firmware::NodeLaws<Flashed>;
  // Axes of one machine are not of this protocol.
  if constexpr (requires { node.axes[0].kicks; }) {
    if (speaks_odrive(s)) return run_flashed_odrives(s, recording, node);
  }
  Laws laws{node};
  LoopRun<typename Laws::Scalar, typename Laws::Law> run{s, recording, node.loop};
  firmware::add_axes(run.loop(), node, laws);
  return run.run();
}

template <class Real, class Drive>
Result run_pid_on(const scenario::Scenario& s, const RecordingOptions& recording,
                  typename Drive::Config (*drive_config)(const config::Axis&)) {
  LoopRun<Real, law::PidController<Real>, Drive> run{s, recording, config::loop_config(s.node)};
  for (const config::Axis& axis : s.node.axes) {
    const law::PidController<Real> controller{config::pid_parameters<Real>(s.node, axis)};
    static_cast<void>(run.loop().add_axis(drive_config(axis), controller, config::axis_limits<Real>(axis)));
  }
  return run.run();
}

template <class Real>
Result run_pid(const scenario::Scenario& s, const RecordingOptions& recording) {
  if (speaks_odrive(s)) return run_pid_on<Real, odrive::Drive<Real>>(s, recording, config::odrive_config<Real>);
  return run_pid_on<Real, cia402::Drive<Real>>(s, recording, config::drive_config<Real>);
}

bool in_double(const scenario::Scenario& s) { return s.scalar == scenario::ScalarType::float64; }

Result run_with(const scenario::Scenario& s, const RecordingOptions& recording, const SharedNode& node) {
  return std::visit(
      [&]<class Flashed>(const Flashed& flashed) {
        if constexpr (std::is_same_v<Flashed, std::monostate>)
          return in_double(s) ? run_pid<double>(s, recording) : run_pid<float>(s, recording);
        else
          return run_flashed(s, recording, *flashed);
      },
      node);
}

// One loop has one kind of controller.
void require_one_kind(const scenario::Scenario& s) {
  for (const config::Axis& axis : s.node.axes) {
    if (axis.controller.pid.has_value() != s.node.axes.front().controller.pid.has_value())
      throw InputError{"[controller] kind differs from axis to axis; a loop runs one kind of controller"}.in_file(
          s.node.file);
  }
}

}  // namespace

SharedNode flashed_node(const scenario::Scenario& s) {
  config::require_fitting_bus(s.node);
  require_one_kind(s);
  if (s.node.axes.front().controller.pid) return {};
  if (s.node.coupling) {
    const stability::MachineCertificate certificate = config::examine_machine(s.node);
    if (in_double(s))
      return std::make_shared<const config::MachineNode<double>>(config::flashed_machine<double>(s.node, certificate));
    return std::make_shared<const config::MachineNode<float>>(config::flashed_machine<float>(s.node, certificate));
  }
  if (config::is_by_work(s.node)) {
    if (in_double(s)) return std::make_shared<const config::WorkNode<double>>(config::flashed_by_work<double>(s.node));
    return std::make_shared<const config::WorkNode<float>>(config::flashed_by_work<float>(s.node));
  }
  if (in_double(s)) return std::make_shared<const config::AnyNode<double>>(config::flashed<double>(s.node));
  return std::make_shared<const config::AnyNode<float>>(config::flashed<float>(s.node));
}

Result run_loop_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording,
                         const SharedNode& node) {
  const auto start = std::chrono::steady_clock::now();
  Result result = run_with(scenario, recording, node);
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

Result run_loop_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording) {
  return run_loop_scenario(scenario, recording, flashed_node(scenario));
}

}  // namespace breakaway::sil
