// One machine by every method, and each answer held against the reference.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "random_machine.hpp"
#include "reference_run.hpp"

namespace breakaway::campaign {

enum class Method { event_driven, adaptive, time_stepping };
inline constexpr int methods = 3;

enum class Finding {
  right,       // within what is promised
  agreed,      // with each other to 100 times the tolerance, where the reference was not given enough work
  sensitive,   // within what rounding of the input, or the width of a tie, makes of this machine
  refused,     // by name: an InputError with a sentence
  unjudged,    // the reference was not given enough work, or the step of time stepping is too long for the machine
  wrong,       // another state at the end
  other_rest,  // the right state, but rest is missed, invented, or begins at another instant
  not_a_number,
  endless,  // more events than any of these machines has
  crashed   // in a process of its own: killed after BREAKAWAY_CPU_S, or ended by a signal
};
inline constexpr int findings = 10;

std::string_view to_string(Method method);
std::string_view to_string(Finding finding);
constexpr bool is_defect(Finding finding) { return finding >= Finding::wrong; }

struct Judgement {
  Finding finding = Finding::unjudged;
  double error = 0;  // at the end, as a share of the greatest coordinate and speed met on the way
  std::string note;
};

struct ComparisonOptions {
  double most_work = 2e6;             // of the reference: multiplications of 113 bits
  double tolerance = 1e-10;           // of the adaptive method
  std::uint64_t most_steps = 20'000;  // of a method, between the start and the end
};

class Comparison {
 public:
  Comparison(const RandomMachine& random, ComparisonOptions options);

  const ReferenceRun& reference() const { return reference_; }
  Judgement judge(Method method);

 private:
  RandomMachine random_;
  ComparisonOptions options_;
  ReferenceRun reference_;
};

}  // namespace breakaway::campaign
