// FlashedAxis: one axis as `breakaway design --header` writes it and a controller starts from it: the parameters, the
// k3 table, what they were certified for, and a checksum over all of it.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <type_traits>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/k3_table.hpp"

namespace breakaway::law {

// The limits within which the design was certified. The machine has to keep to them; the parameters are compared.
template <class Scalar>
struct CertifiedLimits {
  bool certified = false;
  Scalar friction_lower_N{};      // dry friction is at least this ...
  Scalar friction_upper_N{};      // ... and at most this, at any position, speed and time
  Scalar max_force_N{};           // the largest force that the controller may ask for
  Scalar period_s{};              // control period
  Scalar position_tolerance_m{};  // the accuracy that is reached
};

template <class Scalar, std::size_t Nodes = 267>
struct FlashedAxis {
  AxisParameters<Scalar> parameters{};
  K3Table<Scalar, Nodes> k3_table{};
  CertifiedLimits<Scalar> limits{};
  std::uint32_t checksum{};  // checksum_of(), made by the generator
};

// CRC-32 of IEEE 802.3 (reflected polynomial EDB88320) over words, least significant byte first.
class Crc32 {
 public:
  constexpr void add(std::uint32_t word) noexcept {
    state_ ^= word;
    for (int bit = 0; bit < 32; ++bit) state_ = (state_ >> 1U) ^ ((state_ & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  template <class Scalar>
  constexpr void add_scalar(Scalar value) noexcept {
    if constexpr (sizeof(Scalar) == sizeof(std::uint32_t)) {
      add(std::bit_cast<std::uint32_t>(value));
    } else {
      const auto bits = std::bit_cast<std::uint64_t>(value);
      add(static_cast<std::uint32_t>(bits));
      add(static_cast<std::uint32_t>(bits >> 32U));
    }
  }
  constexpr std::uint32_t value() const noexcept { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFU;
};

// Over every number but the checksum itself, in the order of declaration.
template <class Scalar, std::size_t Nodes>
constexpr std::uint32_t checksum_of(const FlashedAxis<Scalar, Nodes>& axis) noexcept {
  Crc32 crc;
  const AxisParameters<Scalar>& p = axis.parameters;
  for (const Scalar value : {p.mass_kg, p.stiffness_N_per_m, p.approach_damping_Ns_per_m, p.kick_damping_Ns_per_m,
                             p.friction.lower_N, p.friction.upper_N, p.max_force_N, p.max_approach_speed_m_s,
                             p.position_tolerance_m, p.encoder_resolution_m, p.period_s}) {
    crc.add_scalar(value);
  }
  crc.add(p.latency_periods);
  crc.add(static_cast<std::uint32_t>(p.kick_shape));
  crc.add_scalar(axis.k3_table.root_max);
  crc.add_scalar(axis.k3_table.nodes_per_root);
  for (const auto& node : axis.k3_table.nodes) {
    crc.add_scalar(node.value);
    crc.add_scalar(node.slope);
  }
  const CertifiedLimits<Scalar>& limits = axis.limits;
  crc.add(limits.certified ? 1U : 0U);
  for (const Scalar value : {limits.friction_lower_N, limits.friction_upper_N, limits.max_force_N, limits.period_s,
                             limits.position_tolerance_m}) {
    crc.add_scalar(value);
  }
  return crc.value();
}

enum class FlashedAxisError : std::uint8_t {
  none,
  checksum_differs,
  parameters_invalid,
  not_certified,
  friction_outside_certificate,
  force_outside_certificate,
  period_outside_certificate,
  tolerance_outside_certificate,
};

constexpr std::string_view to_string(FlashedAxisError error) noexcept {
  switch (error) {
    case FlashedAxisError::none:
      return "configuration is intact and certified";
    case FlashedAxisError::checksum_differs:
      return "configuration is damaged or was edited by hand: generate it again with breakaway design --header";
    case FlashedAxisError::parameters_invalid:
      return "a parameter is out of its range: validate() names it";
    case FlashedAxisError::not_certified:
      return "the design is not certified: breakaway design says why";
    case FlashedAxisError::friction_outside_certificate:
      return "friction bounds differ from those that were certified: design the axis again";
    case FlashedAxisError::force_outside_certificate:
      return "force limit is not between the upper friction bound and the certified one: design the axis again";
    case FlashedAxisError::period_outside_certificate:
      return "control period differs from the certified one: design the axis again";
    case FlashedAxisError::tolerance_outside_certificate:
      return "position tolerance is coarser than the accuracy that was certified: design the axis again";
  }
  return "unknown configuration error";
}

// What a controller asks before it moves anything. Written so that a NaN is refused.
template <class Scalar, std::size_t Nodes>
FlashedAxisError verify(const FlashedAxis<Scalar, Nodes>& axis) noexcept {
  const AxisParameters<Scalar>& p = axis.parameters;
  const CertifiedLimits<Scalar>& limits = axis.limits;
  if (checksum_of(axis) != axis.checksum) return FlashedAxisError::checksum_differs;
  if (validate(p) != ParameterError::none) return FlashedAxisError::parameters_invalid;
  if (!limits.certified) return FlashedAxisError::not_certified;
  if (!(p.friction.lower_N == limits.friction_lower_N && p.friction.upper_N == limits.friction_upper_N))
    return FlashedAxisError::friction_outside_certificate;
  if (!(p.max_force_N <= limits.max_force_N)) return FlashedAxisError::force_outside_certificate;
  if (!(p.period_s == limits.period_s)) return FlashedAxisError::period_outside_certificate;
  if (!(p.position_tolerance_m <= limits.position_tolerance_m)) return FlashedAxisError::tolerance_outside_certificate;
  return FlashedAxisError::none;
}

}  // namespace breakaway::law
