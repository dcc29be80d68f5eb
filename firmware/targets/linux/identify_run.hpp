// The experiment that identifies one axis, over CAN: drives are set up and stopped as by NodeRun, and every guard of
// the loop stays; the law is an experiment.
#pragma once

#include <string>

#include "breakaway/evaluation/record.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "configuration.hpp"
#include "drive_run.hpp"
#include "experiment_node.hpp"
#include "options.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

template <class Side>
class IdentifyRun : private DriveRun<ExperimentNode, Side> {
 public:
  // The configuration is read_experiment()'s. All arguments must outlive it.
  IdentifyRun(const ExperimentNode& node, const Configuration& configuration, const Options& options,
              socketcan::KernelSocket& socket, Telemetry& telemetry);

  // Until the experiment is over. A signal makes it brake, rest and end. Throws InputError as NodeRun::run().
  ExitCode run();

  // What happened, and what was found, in lines; after run().
  std::string report() const;

 private:
  using Base = DriveRun<ExperimentNode, Side>;
  using Base::axes_, Base::laws_, Base::loop_, Base::options_, Base::telemetry_;
  using Base::ended_well, Base::figures, Base::last_words, Base::stop_text;
  using Base::get_ready, Base::enable, Base::step, Base::stop;
  using Base::plan, Base::status;

  void move();
  void keep();

  evaluation::Record record_;
  bool load_on_spring_ = false;
};

}  // namespace breakaway::linux_node
