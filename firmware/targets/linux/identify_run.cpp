#include "identify_run.hpp"

#include <fmt/format.h>

#include <cstddef>

#include "breakaway/evaluation/identification.hpp"
#include "breakaway/evaluation/summary.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/shell_word.hpp"

namespace breakaway::linux_node {
namespace {

// What the record says, or why it says nothing.
std::string findings(const evaluation::Record& record, bool load_on_spring) {
  using evaluation::Mechanism;
  try {
    return evaluation::summary(
        evaluation::evaluate(record, {}, load_on_spring ? Mechanism::load_on_spring : Mechanism::one_mass));
  } catch (const InputError& error) {
    return fmt::format("  nothing found  {}\n", error.what());
  }
}

}  // namespace

template <class Side>
IdentifyRun<Side>::IdentifyRun(const ExperimentNode& node, const Configuration& configuration, const Options& options,
                               socketcan::KernelSocket& socket, Telemetry& telemetry)
    : Base{node, configuration, options, socket, telemetry} {
  const identify::ExperimentParameters<float>& told = node.experiment;
  record_ = {told.period_s, plan(0).resolution_m, told.force_step_N, {}};
  load_on_spring_ = told.load_on_spring;
  // Memory is taken before the first period.
  record_.readings.reserve(static_cast<std::size_t>(2 * told.duration_s / told.period_s));
}

template <class Side>
ExitCode IdentifyRun<Side>::run() {
  get_ready();
  // The experiment counts from where the axis stands, so that a float is exact to the count.
  loop_.set_target_counts(axes_.front().id, loop_.drive(axes_.front().id).position_counts());
  enable();
  telemetry_.ready = !telemetry_.stop;
  move();
  stop();
  return ended_well(0) && laws_.experiment().ending() == identify::Ending::complete ? done : failed;
}

template <class Side>
void IdentifyRun<Side>::move() {
  while (!laws_.experiment().finished() && status(0).fault == firmware::AxisFault::none) {
    if (telemetry_.stop) {
      if (!status(0).running) return;
      laws_.experiment().request_end();
    }
    step();
    if (status(0).feedback.state == hal::DriveState::unusable) return;
    if (status(0).running) keep();
  }
}

template <class Side>
void IdentifyRun<Side>::keep() {
  if (record_.readings.size() == record_.readings.capacity()) return laws_.experiment().request_end();
  const double position_m = loop_.drive(axes_.front().id).position_counts() * record_.resolution_m;
  record_.readings.push_back({position_m, static_cast<double>(status(0).output.force_N), status(0).feedback.fresh});
}

template <class Side>
std::string IdentifyRun<Side>::report() const {
  std::string text =
      fmt::format("{:<11} {}\nexperiment  {}\n", plan(0).name, stop_text(0), to_string(laws_.experiment().ending()));
  text += findings(record_, load_on_spring_) + last_words(0);
  if (!options_.csv.empty() && telemetry_.csv_unwritten == 0)
    text += fmt::format("next: breakaway identify {} --log {} -o identified.toml\n", shell_word(options_.configuration),
                        shell_word(options_.csv));
  return text + figures();
}

template class IdentifyRun<CanopenSide>;
template class IdentifyRun<OdriveSide>;

}  // namespace breakaway::linux_node
