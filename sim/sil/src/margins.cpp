#include "breakaway/sil/margins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "breakaway/config/axis_parameters.hpp"

namespace breakaway::sil {

double most_true_N(const config::Axis& axis) { return config::max_force_N(axis) / config::told_force_gain(axis); }

std::vector<Margin> margins(const config::Axis& axis, const Excursions& e, double max_force_N) {
  const config::Limits& limits = axis.limits;
  std::vector<Margin> all{
      {"position_m", "m", std::min(e.lowest_m - limits.position_min_m, limits.position_max_m - e.highest_m)},
      {"speed_m_s", "m/s", limits.speed_m_s - e.peak_speed_m_s},
      {"force_N", "N", most_true_N(axis) - max_force_N}};
  std::erase_if(all, [](const Margin& margin) { return !std::isfinite(margin.left); });
  return all;
}

std::string to_text(const std::vector<Margin>& margins) {
  std::string text;
  for (const Margin& margin : margins) {
    const std::string_view name = margin.name;
    // What rounding leaves of a limit that is used up is nothing.
    const double left = std::abs(margin.left) < 1e-9 ? 0 : margin.left;
    text += fmt::format("{}{} {:.3g} {}", text.empty() ? "" : ", ", name.substr(0, name.find('_')), left, margin.unit);
  }
  return text;
}

}  // namespace breakaway::sil
