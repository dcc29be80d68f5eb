#include "breakaway/tradeoff/cost.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <optional>

#include "breakaway/input/input_error.hpp"

namespace breakaway::tradeoff {
namespace {

// Of this thread alone: what else runs on the machine does not count.
double processor_time_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_of(const std::function<void()>& work, std::uint64_t repeats) {
  const double start_s = processor_time_s();
  for (std::uint64_t i = 0; i < repeats; ++i) work();
  return (processor_time_s() - start_s) / static_cast<double>(repeats);
}

constexpr double shortest_timing_s = 2e-3;  // 1e4 times what reading the clock and calling a work cost
constexpr int rounds = 5;

std::vector<double> least_times_s(const std::vector<Work>& works) {
  std::vector<std::function<void()>> ready;
  std::vector<std::uint64_t> repeats;
  for (const Work& work : works) {
    ready.push_back(work.prepare());
    repeats.push_back(1 + static_cast<std::uint64_t>(shortest_timing_s / std::fmax(seconds_of(ready.back(), 1), 1e-9)));
  }
  std::vector<double> least(works.size(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < works.size(); ++i) {
      least[i] = std::min(least[i], seconds_of(ready[i], repeats[i]) / works[i].units);
    }
  }
  return least;
}

struct Ended {
  int exit_code;
  std::string output;  // both streams
};

Ended run(const std::string& command) {
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return {127, ""};
  std::string output;
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), n);
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 127, output};
}

// The line "==pid== I   refs:      1,234,567" of cachegrind.
std::optional<double> instructions_in(const std::string& output) {
  const auto refs = output.find("refs:");
  if (refs == std::string::npos) return std::nullopt;
  std::string digits;
  for (auto i = refs + 5; i < output.size() && output[i] != '\n'; ++i) {
    if (output[i] >= '0' && output[i] <= '9') digits += output[i];
  }
  return digits.empty() ? std::nullopt : std::optional{std::strtod(digits.c_str(), nullptr)};
}

double instructions_of_run(const std::string& program, const std::string& work, std::uint64_t repeats) {
  const std::string command = fmt::format(
      "valgrind --tool=cachegrind --cache-sim=no --cachegrind-out-file=/dev/null '{}' tradeoff --work {} --repeat {}",
      program, work, repeats);
  const auto [exit_code, output] = run(command);
  const auto counted = instructions_in(output);
  if (exit_code != 0 || !counted) {
    throw InputError{fmt::format("valgrind could not count the work {}: {}; try --quick, which does not count", work,
                                 output.substr(0, output.find('\n')))};
  }
  return *counted;
}

// The difference of two runs: what starts and ends the program, and prepare(), cancel.
double instructions_of(const Work& work, const std::string& program) {
  return (instructions_of_run(program, work.name, 2) - instructions_of_run(program, work.name, 1)) / work.units;
}

}  // namespace

bool can_count() { return run("valgrind --version").exit_code == 0; }

volatile double last_result = 0;

std::vector<Cost> measure_costs(const std::vector<Work>& works, const Counting& counting) {
  std::vector<Cost> costs(works.size());
  const auto times_s = least_times_s(works);
  for (std::size_t i = 0; i < works.size(); ++i) {
    costs[i].time_ratio = times_s[i] / times_s.front();
    if (counting.program.empty()) continue;
    if (counting.progress) counting.progress("counting " + works[i].name);
    costs[i].instructions = instructions_of(works[i], counting.program);
  }
  return costs;
}

}  // namespace breakaway::tradeoff
