// One machine by every method, and each answer held against the reference.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
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
  sensitive,   // within what rounding of the input or the state, or the width of a tie, makes of this machine
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
  double most_work = 1.4e7;           // of the reference: multiplications
  double tolerance = 1e-10;           // of the adaptive method
  std::uint64_t most_steps = 20'000;  // of a method, between the start and the end
  long most_cpu_s = 0;                // of a method, not of its judge: the process ends there; 0: no end
};

// A method's answer is first held against the reference on the processor's own numbers. Where the two agree within a
// quarter of what is allowed, two independent computations say the same, and the answer is right. Wherever they do not,
// and for every finding but this one, the reference on numbers of 113 bits decides.
class Comparison {
 public:
  Comparison(const RandomMachine& random, ComparisonOptions options);

  Judgement judge(Method method);

 private:
  const ReferenceRun& fast();
  const ReferenceRun& exact();
  Judgement judge_event_driven();
  Judgement judge_adaptive();
  Judgement judge_time_stepping();

  RandomMachine random_;
  ComparisonOptions options_;
  std::optional<ReferenceRun> fast_, exact_;  // computed when a method has answered
};

}  // namespace breakaway::campaign
