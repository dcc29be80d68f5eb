// Electronic data sheets of what is on the bus, for CANopen tools.
#include "breakaway/eds/to_eds.hpp"

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <string>

#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "call_files.hpp"
#include "commands.hpp"

namespace breakaway::cli {
namespace {

struct EdsCommand {
  std::string file, axis, output = "-";
  bool node = false, drive = false;
};

eds::Device drive_of_axis(const EdsCommand& options, const scenario::Scenario& s) {
  const scenario::Scenario one = options.axis.empty() ? s : only_axis(s, options.axis);
  if (one.axes() > 1)
    throw InputError{"has several axes, each with a drive of its own; say whose with --axis NAME"}.in_file(s.node.file);
  if (one.worlds.front().odrive)
    throw InputError{"has a [drive] of protocol = \"odrive\", and an EDS is of a CANopen drive; take \"canopen\""}
        .in_file(s.node.file);
  if (!one.worlds.front().drive)
    throw InputError{"has no [drive]; only an axis with one has a data sheet of it"}.in_file(s.node.file);
  return eds::drive_device(*one.worlds.front().drive);
}

// The present; or what SOURCE_DATE_EPOCH says, for who wants the same file again.
std::chrono::system_clock::time_point date() {
  const char* const fixed = std::getenv("SOURCE_DATE_EPOCH");
  if (fixed == nullptr) return std::chrono::system_clock::now();
  constexpr std::time_t end_of_year_9999 = 253'402'300'799;
  std::string text = fixed;
  const std::string wrong = whole_number(text);
  if (!wrong.empty() || text.size() > 12 || std::stoll(text) > end_of_year_9999)
    throw InputError{"SOURCE_DATE_EPOCH: " + text + " must be whole seconds since 1970, before the year 10000"};
  return std::chrono::system_clock::from_time_t(std::stoll(text));
}

int write_eds(const EdsCommand& options) {
  const scenario::Scenario s = scenario::read_scenario(options.file);
  const eds::Device device = options.drive ? drive_of_axis(options, s) : eds::node_device(s.node);
  const std::string name = options.output == "-" ? "" : std::filesystem::path{options.output}.filename().string();
  format::write_output(options.output, eds::to_eds(device, name, date()));
  return done;
}

}  // namespace

void add_eds(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<EdsCommand>();
  CLI::App* command = app.add_subcommand(
      "eds", "Write the CANopen electronic data sheet (EDS) of the controller node, or of an axis' emulated drive");
  CallFiles files{*command};
  files.reads("file", options->file, "The node, or the scenario")->required();
  CLI::Option* const node = command->add_flag("--node", options->node, "Of the controller node, as without it");
  CLI::Option* const drive =
      command->add_flag("--drive", options->drive, "Of the emulated drive of the axis")->excludes(node);
  command->add_option("--axis", options->axis, "The name of the axis, where the file has several")->needs(drive);
  files.writes("-o,--output", options->output, "Write to this file; - is standard output, as without it");
  command->footer(std::string{"Example: breakaway eds sim/scenarios/can_axis.toml -o node.eds\n"
                              "and breakaway eds sim/scenarios/can_axis.toml --drive -o drive.eds\n"} +
                  exit_codes);
  files.then([options, &exit_code] { exit_code = write_eds(*options); });
}

}  // namespace breakaway::cli
