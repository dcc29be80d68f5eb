#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/new_node.hpp"
#include "breakaway/design/binding_limit.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/input/shell_word.hpp"
#include "call_files.hpp"
#include "commands.hpp"

namespace breakaway::cli {
namespace {

// One of the seven numbers, by option or by question.
struct Question {
  const char* option;
  const char* unit;
  const char* question;
  double config::KnownAxis::*answer;
};

constexpr std::array questions{
    Question{"--mass", "kg", "Mass that moves, with all that is geared to it", &config::KnownAxis::mass_kg},
    Question{"--friction-lower", "N", "Least friction, anywhere and ever", &config::KnownAxis::friction_lower_N},
    Question{"--friction-upper", "N", "Greatest friction, anywhere and ever", &config::KnownAxis::friction_upper_N},
    Question{"--encoder", "m", "One count of the encoder", &config::KnownAxis::encoder_resolution_m},
    Question{"--rate", "Hz", "Rate of the control loop", &config::KnownAxis::rate_Hz},
    Question{"--force", "N", "Greatest force of the drive", &config::KnownAxis::max_force_N},
    Question{"--move", "m", "Longest move", &config::KnownAxis::longest_move_m},
};

struct NewCommand {
  std::array<std::optional<double>, questions.size()> given;
  std::string file = "axis.toml";
};

// What is wrong with an answer, or nothing.
std::string answer_problem(const std::string& answer, const Question& question, config::KnownAxis known) try {
  if (std::string wrong = positive_number(answer); !wrong.empty()) return wrong;
  known.*question.answer = std::stod(answer);
  config::require_possible_so_far(known);
  return "";
} catch (const InputError& error) {
  return error.what();
}

// Asks on standard error until the answer is a number above 0 that agrees with what is known.
double ask(const Question& question, const config::KnownAxis& known) {
  while (true) {
    fmt::print(stderr, "{} [{}]: ", question.question, question.unit);
    std::string line;
    if (!std::getline(std::cin, line)) {
      fmt::print(stderr, "\n");
      throw InputError{fmt::format("{} is not given, and standard input has no answer: add {} NUMBER",
                                   question.question, question.option)};
    }
    line = CLI::detail::trim(line);
    const std::string problem = answer_problem(line, question, known);
    if (problem.empty()) return std::stod(line);
    fmt::print(stderr, "{}\n", problem);
  }
}

config::KnownAxis known_axis(const NewCommand& options) {
  config::KnownAxis known;
  for (std::size_t i = 0; i < questions.size(); ++i) known.*questions[i].answer = options.given[i].value_or(0);
  config::require_possible_so_far(known);
  for (std::size_t i = 0; i < questions.size(); ++i)
    if (!options.given[i]) known.*questions[i].answer = ask(questions[i], known);
  return known;
}

// An axis that may rest as far away as it ever moves is certified and of no use: mostly a number has another unit.
void require_use(const config::KnownAxis& known, double error_m, const design::BindingLimit& limit) {
  if (error_m < known.longest_move_m) return;
  throw InputError{
      fmt::format("the axis may rest {:g} m away from its target, and its longest move is {:g} m; limited most by {}: "
                  "is that in SI units?",
                  rounded_up(error_m, 3), known.longest_move_m, limit.name)};
}

int make_new(const NewCommand& options) {
  const bool to_file = options.file != "-";
  const config::KnownAxis known = known_axis(options);
  const config::NewNode made = config::new_node(known);
  const design::BrakedPromise& promise = *made.report.braked;
  const config::Axis& axis = made.node.axes.front();
  const design::BindingLimit limit = design::binding_limit(config::braked_class(made.node, axis));
  require_use(known, promise.error_m, limit);
  format::write_output(options.file, made.text);
  if (!to_file) return done;
  fmt::print("{} is written, and certified: position_tolerance_m = {:g}, true error at rest at most {:g} m\n",
             options.file, axis.controller.position_tolerance_m, rounded_up(promise.error_m, 3));
  fmt::print("accuracy is limited most by {}: with half of it a tolerance of {:g} m could be certified\n", limit.name,
             rounded_up(limit.least_tolerance_m, 3));
  fmt::print("next: breakaway simulate {} --report axis.html\n", shell_word(options.file));
  return done;
}

}  // namespace

void add_new(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<NewCommand>();
  CLI::App* command = app.add_subcommand(
      "new", "Write the file of an axis from seven numbers, certified; those that are not given are asked for");
  CallFiles files{*command};
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const Question& question = questions[i];
    command->add_option(question.option, options->given[i], fmt::format("{} [{}]", question.question, question.unit))
        ->check(positive_number);
  }
  files.makes("-o,--output", options->file, "Write to this file (axis.toml); - is standard output");
  command->footer(std::string{"Example: breakaway new --mass 12 --friction-lower 15 --friction-upper 28 --encoder 5e-7 "
                              "--rate 1000 --force 200 --move 0.4\n"} +
                  exit_codes);
  files.then([options, &exit_code] { exit_code = make_new(*options); });
}

}  // namespace breakaway::cli
