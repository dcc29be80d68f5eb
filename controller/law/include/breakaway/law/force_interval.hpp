// ForceInterval: within which bounds the force behind a current loop is, while its time constant is known in bounds
// only.
//
// The force u follows the command U as u(t + T) = U + (u(t) - U) e^(-T/tau). Away from the command the slowest loop is
// the bound, towards it the fastest. Waiting until the slowest loop has settled would cost many periods a kick; the
// interval tells when the force is known well enough, mostly at once.
#pragma once

namespace breakaway::law {

template <class Scalar>
struct ForceInterval {
  Scalar lower_N{};
  Scalar upper_N{};

  // A period passes under the command. 0 <= fast <= slow < 1: the shares of a change that are left after a period.
  constexpr void follow(Scalar command_N, Scalar fast, Scalar slow) noexcept {
    const Scalar above = upper_N - command_N, below = lower_N - command_N;
    upper_N = command_N + above * (above > 0 ? slow : fast);
    lower_N = command_N + below * (below > 0 ? fast : slow);
  }

  // The interval as seen along a direction, +1 or -1.
  constexpr ForceInterval along(Scalar direction) const noexcept {
    return direction < 0 ? ForceInterval{-upper_N, -lower_N} : *this;
  }
  constexpr Scalar middle_N() const noexcept { return (lower_N + upper_N) / 2; }
};

}  // namespace breakaway::law
