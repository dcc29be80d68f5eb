// The subcommands of `breakaway`, one file each.
#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <system_error>

namespace breakaway::cli {

enum ExitCode : int {
  done = 0,
  failed_check = 1,  // not settled, or not certified
  bad_input = 2,
};

constexpr const char* exit_codes =
    "\nA file to read may be -, standard input.\n"
    "Exit codes: 0 done; 1 not settled, or a check failed; 2 bad input (one line on standard error says what).";

// Each adds its subcommand; when that is run, it sets exit_code or throws InputError.
void add_new(CLI::App& app, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_k3(CLI::App& app, int& exit_code);
void add_design(CLI::App& app, int& exit_code);
void add_study(CLI::App& app, int& exit_code);
void add_identify(CLI::App& app, int& exit_code);
void add_tune(CLI::App& app, int& exit_code);
void add_attract(CLI::App& app, int& exit_code);
void add_basin(CLI::App& app, int& exit_code);
void add_synthesize(CLI::App& app, int& exit_code);
void add_tradeoff(CLI::App& app, int& exit_code);
void add_eds(CLI::App& app, int& exit_code);
void add_schema(CLI::App& app, int& exit_code);
void add_drive(CLI::App& app, int& exit_code);  // on Linux
void add_watch(CLI::App& app, int& exit_code);  // on Linux

// For options: CLI11 reads "nan" and "inf" as numbers.
inline CLI::Validator number_validator(bool positive, const char* expects) {
  return {[=](std::string& text) -> std::string {
            double value = std::numeric_limits<double>::quiet_NaN();
            if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && (!positive || value > 0)) return "";
            return (text.empty() ? "nothing" : text) + " is not " + expects;
          },
          ""};
}
// For files: an empty name is most often a script's unset variable, and not the wish to go without the file.
inline CLI::Validator file_name_validator(const char* stream) {
  return {[=](std::string& text) -> std::string {
            return text.empty() ? std::string{"the name is empty; give a file, or - for standard "} + stream : "";
          },
          ""};
}
inline const CLI::Validator name_to_read = file_name_validator("input");
inline const CLI::Validator name_to_write = file_name_validator("output");
// For seeds: what fits a number of 64 bits.
inline const CLI::Validator whole_number{
    [](std::string& text) -> std::string {
      std::uint64_t value = 0;
      const char* const end = text.data() + text.size();
      const auto read = std::from_chars(text.data(), end, value);
      return read.ec == std::errc{} && read.ptr == end ? "" : text + " is not a whole number, 0 or above";
    },
    ""};
// For counts: CLI::Range says of "1e3" that it is not in the range.
inline CLI::Validator whole_number_between(std::int64_t least, std::int64_t most) {
  const std::string range = std::to_string(least) + " to " + std::to_string(most);
  return {[=](std::string& text) -> std::string {
            std::int64_t value = 0;
            const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return good ? "" : (text.empty() ? "nothing" : text) + " is not a whole number from " + range;
          },
          "from " + range};
}
inline const CLI::Validator positive_number = number_validator(true, "a finite number above 0");
// For times: less is no time of the clock, and more overflows its count.
inline const CLI::Validator number_of_seconds{
    [](std::string& text) -> std::string {
      double value = 0;
      const bool good = CLI::detail::lexical_cast(text, value) && value >= 1e-9 && value <= 1e9;
      return good ? "" : text + " is not a number of seconds from 1e-9 to 1e9";
    },
    ""};
inline const CLI::Validator finite_number = number_validator(false, "a finite number");

}  // namespace breakaway::cli
