// Every way to integrate a LinearMachine takes and gives these types.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::hybrid {

using stability::LinearMachine;
using stability::MachineState;

enum class Verdict {
  at_rest,   // v = 0 and static friction holds the machine for ever
  captured,  // proved to come to rest
  lost,      // proved never to come to rest
  undecided  // the time is up
};

enum class EventKind {
  stick,    // the sliding velocity of the direction became zero and stays so
  slip,     // the direction began to slide
  reversal  // the sliding velocity of the direction passed through zero
};

struct Event {
  double time_s;
  EventKind kind;
  int direction;  // column of W_T, from 0
};

template <int N>
struct Outcome {
  Verdict verdict = Verdict::undecided;
  MachineState<N> end;
  double settling_time_s = 0;  // when rest began, if at_rest; else the time of `end`
  std::uint64_t steps = 0;     // closed-form segments, or time steps
  std::uint64_t events = 0;    // entries of the log
  double work = 0;             // that the event-driven method took from its Budget
};

// Says what is known about the future of a state without integrating it: captured or lost if proved, else undecided. It
// is asked at the start and at every event, and at every step of a time-stepping scheme, so it has to be cheap.
template <int N>
using EarlyDecision = std::function<Verdict(const MachineState<N>&)>;

// Called with the states on the way: the start, every event and the end, or every time step.
template <int N>
using Observer = std::function<void(const MachineState<N>&)>;

}  // namespace breakaway::hybrid
