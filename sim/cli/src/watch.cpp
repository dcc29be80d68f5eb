// A live page in the browser: what a node's stream, a run's file or the bus tells of the axes.
#include "breakaway/watch/server.hpp"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "breakaway/watch/bus_source.hpp"
#include "breakaway/watch/source.hpp"
#include "commands.hpp"

namespace breakaway::cli {
namespace {

struct WatchCommand {
  std::string stream, file, interface, node;
  bool control = false;
  watch::ServerOptions server;
};

// SIGINT and SIGTERM wait for sigtimedwait() in every thread that begins later.
sigset_t block_end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

// Until the operator ends it. What cannot be read is said once; the page counts the others.
void wait_for_end(const sigset_t& signals, const watch::History& history) {
  constexpr timespec interval{.tv_sec = 0, .tv_nsec = 200'000'000};
  bool complained = false;
  while (sigtimedwait(&signals, nullptr, &interval) < 0) {
    const watch::Losses losses = history.losses();
    if (complained || losses.complaint.empty()) continue;
    complained = true;
    // Without an exception where nobody reads it any more.
    std::fputs(fmt::format("breakaway: warning: {} (the page counts what follows)\n", losses.complaint).c_str(),
               stderr);
  }
}

void check(const WatchCommand& options) {
  const auto given = [](const std::string& option) { return option.empty() ? 0 : 1; };
  if (given(options.stream) + given(options.file) + given(options.interface) != 1)
    throw InputError{"watch: give one of --stream PORT, --file RUN.csv and --can INTERFACE, for what is to be watched"};
  if (options.control && options.interface.empty())
    throw InputError{
        "--control: commands are sent on CAN; give --can INTERFACE and the node's file, or leave --control out"};
  if (options.interface.empty() != options.node.empty())
    throw InputError{"watch: --can needs the node's file, and nothing else does: breakaway watch --can can0 axis.toml"};
}

void serve(WatchCommand& options, const watch::Source& source, std::optional<watch::Operator> the_operator,
           const sigset_t& signals, const watch::History& history) {
  options.server.description = source.description();
  options.server.live = options.file.empty();
  const watch::Server server{options.server, history, std::move(the_operator)};
  fmt::print("{}: {}\n", options.server.description, server.url());
  std::fflush(stdout);
  wait_for_end(signals, history);
}

void serve_bus(WatchCommand& options, const sigset_t& signals, watch::History& history) {
  const auto bus = watch::watch_bus(options.interface, options.node, options.control, history);
  options.server.axes = bus->axes();
  std::optional<watch::Operator> the_operator;
  if (options.control)
    the_operator = watch::Operator{.obey = [&bus](const watch::Command& command) { return bus->obey(command); },
                                   .is_there = [&bus] { bus->page_is_seen(); }};
  serve(options, *bus, std::move(the_operator), signals, history);
}

int watch_axes(WatchCommand options) {
  check(options);
  const sigset_t signals = block_end_signals();
  watch::History history;
  if (!options.interface.empty()) {
    serve_bus(options, signals, history);
  } else if (!options.stream.empty()) {
    serve(options, *watch::receive_stream(options.stream, history), {}, signals, history);
  } else {
    serve(options, *watch::follow_file(options.file, history), {}, signals, history);
  }
  return done;
}

}  // namespace

void add_watch(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<WatchCommand>();
  CLI::App* command = app.add_subcommand("watch", "Show position, error, force, modes and faults live in the browser");
  command->add_option("--stream", options->stream,
                      "Receive what breakaway-node --stream udp:HOST:PORT sends: PORT, or ADDRESS:PORT for nodes on "
                      "other machines (0.0.0.0:PORT: on any)");
  command->add_option("--file", options->file,
                      "Show a run that breakaway-node --csv or simulate --csv writes or wrote; - is standard input");
  command->add_option("node", options->node, "With --can: the file of the node whose axes are on the bus");
  command->add_option("--can", options->interface, "Listen on this CAN interface, can0 say, and send nothing");
  command->add_flag("--control", options->control,
                    "With --can: have the page enable, move, stop and reset the axes of a node that others command. A "
                    "page that is closed stops them");
  command->add_option("--http", options->server.port, "The port of the page (8080); 0 is any free one")
      ->check(whole_number_between(0, 65535));
  command
      ->add_option("--bind", options->server.bind,
                   "The address of this machine at which the page is served (127.0.0.1: for this machine only)")
      ->check(CLI::Validator{[](std::string& text) -> std::string {
                               return text.empty() ? "the address is empty; give one of this machine" : "";
                             },
                             ""});
  command->footer(std::string{"Example: breakaway watch --stream 9870\n"
                              "and, in another terminal: breakaway-node --can can0 axis.toml --stream "
                              "udp:localhost:9870\n"
                              "With an image on the bus: breakaway watch --can can0 axis.toml --control\n"
                              "SIGINT or SIGTERM (Ctrl-C) ends it.\n"} +
                  exit_codes);
  command->callback([options, &exit_code] { exit_code = watch_axes(*options); });
}

}  // namespace breakaway::cli
