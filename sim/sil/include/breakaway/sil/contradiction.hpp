// What cannot all be true of one machine. A certificate is a proof and a motion is a computation: where they differ,
// one of them is wrong, and a command that has both in hand must not print either.
#pragma once

#include <string>

#include "breakaway/hybrid/types.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::sil {

// The error names both facts and what to do.
class Contradiction : public InputError {
 public:
  explicit Contradiction(const std::string& facts);
};

// The certificates against each other: from inside { V < level_J } every motion comes to rest, so none of it may lie
// beyond a level of escape, of which no motion returns. Throws Contradiction.
void require_consistent(const stability::LinearMachine<>& machine, const Certificates& certificates);

// The certificates against a motion `from` a state, without impulses on the way: one that starts inside { V < level_J }
// must not gain energy, and one that starts beyond a level of escape must not come to rest. Each may differ by 1e-6 of
// itself, far more than a method's rounding. That a motion is not at rest yet, when its time is up, contradicts
// nothing. Throws Contradiction.
void require_consistent(const stability::LinearMachine<>& machine, const Certificates& certificates,
                        const hybrid::MachineState<Eigen::Dynamic>& from,
                        const hybrid::Outcome<Eigen::Dynamic>& outcome);

}  // namespace breakaway::sil
