// breakaway-node: controls the axes of a node over SocketCAN.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "any_run.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/input/file_roles.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/odrive/messages.hpp"
#include "breakaway/socketcan/kernel_socket.hpp"
#include "configuration.hpp"
#include "listen.hpp"
#include "options.hpp"
#include "outlet.hpp"
#include "realtime.hpp"
#include "reporter.hpp"
#include "service_manager.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {
namespace {

constexpr const char* examples =
    "Example: breakaway-node --can can0 sim/scenarios/can_axis.toml --target 0.25\n"
    "         breakaway-node --can can0 axis.toml --identify --csv run.csv\n"
    "SIGINT, SIGTERM or SIGHUP stops the axes and ends the node; SIGUSR1 acknowledges faults.\n"
    "\n"
    "Exit codes: 0 ended as asked, every axis stopped; 1 a fault, no confirmed stop, --duration ended off the target,\n"
    "or a log or standard output that was not written whole; 2 bad input, nothing moved (one line on standard error\n"
    "says what).";

void add_options(CLI::App& app, Options& o) {
  const auto within = [](double least, const char* range) {
    return CLI::Validator{[=](std::string& text) -> std::string {
                            double value = 0;
                            const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= 1e9;
                            return good ? "" : text + " is not " + range;
                          },
                          ""};
  };
  // Less is no time of the clock, and a duration of none would be that of a run without end.
  const CLI::Validator seconds = within(1e-9, "a number of seconds from 1e-9 to 1e9");
  const CLI::Validator force = within(std::numeric_limits<double>::min(), "a number above 0 and up to 1e9");
  // An empty name is most often a script's unset variable, and not the wish to go without a record of the run.
  const CLI::Validator named{[](std::string& text) -> std::string {
                               return text.empty() ? "the name is empty; give one, or leave the option out" : "";
                             },
                             ""};
  app.add_option(
         "configuration", o.configuration,
         "The node: a file with [plant], [friction], [controller], [drive] of its axes, and [loop]; must be certified")
      ->required();
  app.add_option("--can", o.interface, "The CAN interface, can0 say")->required()->check(named);
  app.add_option(
      "--target", o.targets,
      "Positions [m] to visit in this order, of several axes as 0.1,0.2,-0.1; without, those of [controller] "
      "at their times");
  app.add_option("--dwell", o.dwell_s, "Seconds at rest on a target before the next (1)")->check(seconds);
  app.add_option("--duration", o.duration_s, "Seconds until the axes are stopped; without, a signal ends the node")
      ->check(seconds);
  app.add_option("--max-force", o.max_force_N, "Lower force limit [N] of every axis than the configuration's")
      ->check(force);
  app.add_option("--node-id", o.node_id, "Node id of a single axis' drive instead of the configuration's")
      ->check(CLI::Range(0, 126));
  app.add_option("--wait", o.patience_s, "Seconds for the drives to answer (5)")->check(seconds);
  app.add_option("--priority", o.priority, "Real-time priority (80)")->check(CLI::Range(1, 99));
  app.add_flag("--readonly", o.readonly, "Listen and show; send nothing");
  app.add_flag_callback(
      "--no-realtime", [&o] { o.realtime = false; }, "Run without real-time priority: for trials, not for machines");
  app.add_flag("--identify", o.identify,
               "Find mass, friction and latency of an axis by an experiment; the file need not be certified");
  app.add_option("--axis", o.axis, "The name of the axis to identify, where the file has several");
  app.add_flag("--reset", o.reset, "Acknowledge faults that drives have at the start");
  app.add_option("--csv", o.csv, "Write one line a period to this file; an older one stays until the drives are set up")
      ->check(named);
  app.add_option("--candump", o.candump,
                 "Write all frames of the drives to this file, as candump -L does; an older one stays until the drives "
                 "are set up")
      ->check(named);
  app.add_option("--stream", o.stream,
                 "Send every sample as a JSON object to udp:HOST:PORT, for `breakaway watch --stream` or PlotJuggler")
      ->check(named);
}

// What tells which other nodes are there, SYNC, SDO answers and heartbeats, the SDO requests to us, and the frames of
// our drives.
std::vector<socketcan::Filter> wanted_frames(const Configuration& c) {
  std::vector<socketcan::Filter> wanted;
  if (c.speaks_odrive()) {
    constexpr std::uint16_t of_node = hal::CanFrame::max_id & ~((1U << odrive::command_bits) - 1);
    constexpr auto of_command = static_cast<std::uint16_t>(~of_node & hal::CanFrame::max_id);
    wanted.push_back({odrive::identifier(0, odrive::Command::heartbeat), of_command});
    for (const auto& drive : c.odrives)
      wanted.push_back({odrive::identifier(drive.node_id, odrive::Command::get_version), of_node});
    return wanted;
  }
  wanted = {{canopen::sync_cob_id, hal::CanFrame::max_id},
            {canopen::sdo_response_function_code, canopen::function_code_mask},
            {canopen::heartbeat_function_code, canopen::function_code_mask},
            {canopen::sdo_request_cob_id(c.loop().network.node_id), hal::CanFrame::max_id}};
  for (std::size_t place = 0; place < c.axes.size(); ++place)
    wanted.push_back({c.drive(place).node_id, canopen::node_id_mask});
  return wanted;
}

void open_socket(socketcan::KernelSocket& socket, const Options& o, const Configuration& c) {
  const std::vector<socketcan::Filter> wanted = wanted_frames(c);
  static_assert(4 + config::most_axes <= socketcan::KernelSocket::most_filters);
  const std::span<const socketcan::Filter> all;
  const auto result = socket.open(o.interface.c_str(), o.readonly ? all : wanted);
  if (result != socketcan::OpenResult::done) throw InputError{fmt::format("{}: {}", o.interface, to_string(result))};
}

int run(const Options& o) {
  if (!o.identify && !o.axis.empty()) throw InputError{"--axis is for --identify: add that, or leave it out"};
  require_apart({{"configuration", o.configuration}}, {{"--csv", o.csv}, {"--candump", o.candump}});
  const Configuration configuration = o.identify ? read_experiment(o) : read_configuration(o);
  socketcan::KernelSocket socket;
  open_socket(socket, o, configuration);
  const auto telemetry = std::make_unique<Telemetry>();
  ServiceManager manager{service_environment(), configuration.loop().network.period};
  Reporter reporter{o, *telemetry, configuration, manager};
  if (o.readonly) {
    const ExitCode heard = listen(configuration, o, socket, *telemetry);
    reporter.finish();
    reporter.print(reporter.stream_report());
    return reporter.wrote_everything() ? heard : failed;
  }
  const auto control = [&](auto& node) {
    const auto run_in_time = [&] {
      const RealtimeScope scope;
      if (o.realtime)
        if (const std::string problem = become_realtime(o.priority); !problem.empty()) throw InputError{problem};
      return node.run();
    };
    const ExitCode code = run_in_time();
    reporter.finish();
    reporter.print(node.report() + reporter.stream_report());
    return reporter.wrote_everything() ? code : failed;
  };
  return with_run(configuration, o, socket, *telemetry, control);
}

int refuse(const std::string& what) {
  say(what);
  return bad_input;
}

}  // namespace
}  // namespace breakaway::linux_node

int main(int argc, char** argv) {
  using namespace breakaway;
  ::signal(SIGUSR1, SIG_IGN);  // by default it would end a node that has no faults to acknowledge yet
  linux_node::Options options;
  CLI::App app{"Controls the axes of a node over SocketCAN: the loop that is flashed, on Linux.", "breakaway-node"};
  app.set_version_flag("--version", "breakaway-node " BREAKAWAY_VERSION);
  linux_node::add_options(app, options);
  app.footer(linux_node::examples);
  try {
    app.parse(argc, argv);
    return linux_node::run(options);
  } catch (const CLI::Success& help) {
    const int code = app.exit(help);
    if (std::cout.flush()) return code;
    linux_node::say("standard output: cannot be written");
    return linux_node::failed;
  } catch (const CLI::ParseError& error) {
    return linux_node::refuse(fmt::format("{} (breakaway-node --help tells more)", error.what()));
  } catch (const InputError& error) {
    return linux_node::refuse(error.what());
  } catch (const std::exception& error) {
    return linux_node::refuse(fmt::format("unexpected failure: {}", error.what()));
  }
}
