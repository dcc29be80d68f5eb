// breakaway: simulates and designs positioning axes that beat stiction.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "breakaway/input/input_error.hpp"
#include "commands.hpp"
#include "self_description.hpp"

namespace {

int refuse(std::string what) {
  for (char& c : what) {
    if (c == '\n') c = ' ';
  }
  fmt::print(stderr, "breakaway: {}\n", what);
  return breakaway::cli::bad_input;
}

int refuse_standard_output() { return refuse("standard output: cannot be written"); }

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const auto chosen = app.get_subcommands();
  const auto unknown = app.remaining();
  if (chosen.empty() && !unknown.empty())
    return fmt::format("{} is neither a subcommand nor an option{} (breakaway --help lists them)", unknown.front(),
                       breakaway::cli::did_you_mean(app, unknown.front()));
  const std::string command = chosen.empty() ? "" : chosen.front()->get_name() + " ";
  const auto misspelt = chosen.empty() ? std::vector<std::string>{} : chosen.front()->remaining();
  const std::string meant = misspelt.empty() ? "" : breakaway::cli::did_you_mean(*chosen.front(), misspelt.front());
  return fmt::format("{}{} (breakaway {}--help tells more)", error.what(), meant, command);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace breakaway;
  // A reader that is gone, as `head` is after its lines, is an error of what is written to it, and not the end of what
  // else is done.
  std::signal(SIGPIPE, SIG_IGN);
  int exit_code = cli::done;
  CLI::App app{"Positioning control that beats dry friction: simulation and design on a PC.", "breakaway"};
  app.set_version_flag("--version", "breakaway " BREAKAWAY_VERSION);
  app.require_subcommand(1);
  app.footer(std::string{"Example: breakaway simulate sim/scenarios/can_axis.toml --report can_axis.html\n"} +
             cli::exit_codes);
  cli::add_new(app, exit_code);
  cli::add_simulate(app, exit_code);
  cli::add_k3(app, exit_code);
  cli::add_design(app, exit_code);
  cli::add_study(app, exit_code);
  cli::add_identify(app, exit_code);
  cli::add_tune(app, exit_code);
  cli::add_attract(app, exit_code);
  cli::add_basin(app, exit_code);
  cli::add_synthesize(app, exit_code);
  cli::add_tradeoff(app, exit_code);
  cli::add_eds(app, exit_code);
  cli::add_schema(app, exit_code);
#ifdef __linux__
  cli::add_drive(app, exit_code);
  cli::add_watch(app, exit_code);
#endif
  cli::add_help(app, exit_code);
  try {
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0) return refuse_standard_output();
    return exit_code;
  } catch (const CLI::Success& help) {
    const int code = app.exit(help);
    return std::cout.flush() ? code : refuse_standard_output();
  } catch (const CLI::ParseError& error) {
    return refuse(explain(app, error));
  } catch (const InputError& error) {
    return refuse(error.what());
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return refuse_standard_output();
    return refuse(fmt::format("unexpected failure: {}", error.what()));
  }
}
