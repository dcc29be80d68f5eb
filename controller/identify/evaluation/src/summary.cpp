#include "breakaway/evaluation/summary.hpp"

#include <fmt/format.h>

#include <string>

namespace breakaway::evaluation {
namespace {

std::string latency_text(const Identification& found) {
  const LatencyEstimate& latency = found.latency;
  if (!latency.is_told_apart())
    return fmt::format("{} to {} periods, not told apart from a current loop that makes {:.3g} ms with it",
                       latency.fewest_periods, latency.most_periods, 1e3 * latency.delay_s);
  return fmt::format("{} period{}, and a current loop {}", latency.periods, latency.periods == 1 ? "" : "s",
                     latency.lag_is_seen ? fmt::format("of {:.2g} ms", 1e3 * latency.lag_s) : "too fast to be seen");
}

std::string reasons_of_uncertainty(const Identification& found) {
  const MassEstimate& mass = found.mass;
  if (found.spring) return fmt::format("twice the spread of motor and load, and {:g} %", 100 * found.margins.masses);
  return fmt::format(
      "twice their spread ({:.1f} %), what smaller ones are off in proportion ({:.1f} %), twice what longer and "
      "shorter "
      "looks differ by ({:.1f} %) and {:g} %",
      200 * mass.spread_of_greatest(), 100 * mass.spread, 200 * mass.spread_of_lengths, 100 * found.margins.mass);
}

std::string spring_text(const SpringEstimate& spring, const Margins& margins) {
  return fmt::format(
      "  load           swings on a spring, {:.4g} to {:.4g} times a second: motor {:.4g} kg, load {:.4g} kg\n"
      "  stiffness      {:.3g} N/m at least: {:.4g} to {:.4g} N/m in {} switches of the force, less {:g} %; another "
      "switch shows less than any of them with a chance of at most {:.2g} %\n"
      "  damping        {:.2g} N s/m at least, {:g} % of what was seen\n"
      "  motor alone    {:.4g} to {:.4g} N, and load alone {:.4g} to {:.4g} N, in {} bends of the spring, with a "
      "margin "
      "of {:g} % on either side\n",
      spring.resonance_Hz.least, spring.resonance_Hz.most, spring.motor_kg, spring.load_kg, spring.stiffness_N_per_m,
      spring.stiffness_seen_N_per_m.least, spring.stiffness_seen_N_per_m.most, spring.switches, 100 * margins.stiffness,
      100 * spring.chance_softer(), spring.damping_Ns_per_m, 100 * (1 - margins.damping), spring.motor_N.least,
      spring.motor_N.most, spring.load_N.least, spring.load_N.most, spring.bends, 100 * margins.side);
}

}  // namespace

std::string summary(const Identification& found) {
  const MassEstimate& mass = found.mass;
  const Margins& margins = found.margins;
  return fmt::format(
             "  mass           {:.4g} kg +- {:.1f} %: {:.4g} to {:.4g} kg in {} switches of the force; the most of {}\n"
             "  friction seen  {:.4g} to {:.4g} N in {} motions, from {:.4g} to {:.4g} m\n"
             "  bounds         {:.4g} to {:.4g} N, with a margin of {:g} % on either side\n",
             mass.mass_kg, 100 * found.mass_uncertainty, mass.seen_kg.least, mass.seen_kg.most, mass.switches,
             reasons_of_uncertainty(found), found.friction_seen_N.least, found.friction_seen_N.most, found.motions,
             found.travel_seen_m.least, found.travel_seen_m.most, found.bounds_N.least, found.bounds_N.most,
             100 * margins.friction) +
         (found.spring ? spring_text(*found.spring, margins) : std::string{}) +
         (found.presliding_N_per_m
              ? fmt::format("  before sliding it bends: {:.2g} N/m at least\n", *found.presliding_N_per_m)
              : std::string{}) +
         fmt::format(
             "  latency        {}\n"
             "  confidence     whatever its distribution, the friction of another motion is outside what was seen with "
             "a "
             "chance of at most {:.2g} %\n",
             latency_text(found), 100 * found.chance_outside());
}

}  // namespace breakaway::evaluation
