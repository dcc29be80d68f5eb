// FrictionBounds: all that the control law has to know of dry friction, Assumption 1 of van de Wouw & Leine, "Impulsive
// Control of Mechanical Motion Systems with Uncertain Friction": 0 < f_lower <= f <= f_upper, at any position, speed
// and time.
//
// Forces in place of the paper's coefficients: f_lower = m g mu_lower and f_upper = m g mu_upper.
#pragma once

namespace breakaway::law {

template <class Scalar>
struct FrictionBounds {
  Scalar lower_N{};
  Scalar upper_N{};

  constexpr Scalar ratio() const noexcept { return lower_N / upper_N; }            // f_lower / f_upper, in (0, 1]
  constexpr Scalar gap() const noexcept { return (upper_N - lower_N) / upper_N; }  // 1 - ratio, without the subtraction

  friend constexpr bool operator==(const FrictionBounds&, const FrictionBounds&) = default;
};

}  // namespace breakaway::law
