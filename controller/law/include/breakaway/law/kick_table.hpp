// KickTable: which pulse moves an axis from rest by at most a given distance, as data for the control loop.
//
// It answers the question that k3 answers for an ideal impulse and a continuous coast, for the loop as it runs:
// sampled, with whole periods of force, the lag of the current loop, a force that comes in steps, and the coast that
// follows. Over s = sqrt|y| the force is smooth at every distance y, so an interval of s that spans a sixteenth of an
// octave holds it as a cubic. The interval is read off the bits of s as a float: its exponent and the first four bits
// of its mantissa. PdCycle gives the root of its distance for y, and so spans twice the octaves.
//
// A drive that knows a few forces only leaves no curve to follow: then the table is a list of the pulses that there
// are, in the order of the distance that each goes at most.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace breakaway::law {

// A constant force towards the target for whole periods, then a cut for whole periods; no pulse where periods is 0.
template <class Scalar>
struct Pulse {
  Scalar force_N{};  // before it is rounded down to a step of the drive
  std::uint8_t periods = 0;
  std::uint8_t cut_periods = 0;
};

// Made by design::design_braked_kicks, and by those of the other coasts. Nothing here can fail, and no argument, not
// even a damaged table, leads to a read outside `entries`.
template <class Scalar>
struct KickTable {
  static constexpr std::size_t most_entries = 118;
  static constexpr int shift = 19;  // of the bits of a float that remain, eight are its exponent and four its mantissa

  // Interval: the force at place t in [0, 1) is a0 + t (a1 + t (a2 + t a3)) [N].
  // Pulse of a list: a0 is the most that it moves the axis [m], a1 its force [N].
  struct Entry {
    Scalar a0, a1, a2, a3;
  };

  // Where the intervals of a curve meet.
  static constexpr float root_at(std::uint32_t high) noexcept { return std::bit_cast<float>(high << shift); }

  std::array<Entry, most_entries> entries{};
  std::array<std::uint8_t, most_entries> periods{};
  std::array<std::uint8_t, most_entries> cut_periods{};
  std::uint16_t first = 0;  // the bits above `shift` of the least s, where there is a curve
  std::uint8_t count = 0;   // entries that are there
  bool list = false;

  constexpr bool is_usable() const noexcept { return count > 0 && count <= most_entries; }

  // The pulse for the distance to the target [m]. Outside the table the answer is that of its nearer end: below it a
  // pulse may go too far, beyond it it stops short. NaN counts as zero.
  Pulse<Scalar> pulse(Scalar distance_m) const noexcept {
    if (!is_usable()) return {};
    return list ? of_list(distance_m) : of_curve(distance_m);
  }

  // The least distance that a curve answers; of a list 0.
  Scalar least_m() const noexcept {
    if (list || count == 0) return 0;
    const float root = root_at(first);
    return static_cast<Scalar>(root) * static_cast<Scalar>(root);
  }

  // The distance up to which a pulse aims at the target; beyond, it goes as far as there.
  Scalar reach_m() const noexcept {
    if (!is_usable()) return 0;
    if (list) return entries[count - 1u].a0;
    const float root = root_at(static_cast<std::uint32_t>(first) + count);
    return static_cast<Scalar>(root) * static_cast<Scalar>(root);
  }

 private:
  Pulse<Scalar> of_curve(Scalar distance_m) const noexcept {
    const float root = distance_m > 0 ? std::sqrt(static_cast<float>(distance_m)) : 0.0F;
    const auto bits = std::bit_cast<std::uint32_t>(root);
    const auto high = static_cast<std::uint32_t>(bits >> shift);
    if (high < first) return at(0, Scalar{0});
    const std::uint32_t index = high - first;
    if (index >= count) return at(count - 1u, Scalar{1});
    constexpr std::uint32_t low = (1U << shift) - 1;
    return at(index, static_cast<Scalar>(bits & low) * (Scalar{1} / static_cast<Scalar>(1U << shift)));
  }

  Pulse<Scalar> at(std::size_t index, Scalar t) const noexcept {
    const Entry& e = entries[index];
    return {e.a0 + t * (e.a1 + t * (e.a2 + t * e.a3)), periods[index], cut_periods[index]};
  }

  // The last pulse that goes no further, or else the first.
  Pulse<Scalar> of_list(Scalar distance_m) const noexcept {
    std::size_t from = 0, to = count;
    while (to - from > 1) {
      const std::size_t middle = (from + to) / 2;
      (entries[middle].a0 <= distance_m ? from : to) = middle;
    }
    return {entries[from].a1, periods[from], cut_periods[from]};
  }
};

}  // namespace breakaway::law
