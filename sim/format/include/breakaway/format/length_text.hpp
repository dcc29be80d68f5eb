// Lengths as an engineer writes them.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>

namespace breakaway::format {

struct LengthUnit {
  double per_metre;
  std::string_view name;
};

// The unit in which a length has one to three digits before the point; metres for 0 and above 1 m.
inline LengthUnit length_unit(double length_m) {
  const double size_m = std::abs(length_m);
  if (!(size_m > 0 && size_m < 1)) return {1, "m"};
  if (size_m < 1e-6) return {1e9, "nm"};
  return size_m < 1e-3 ? LengthUnit{1e6, "µm"} : LengthUnit{1e3, "mm"};
}

// "1.413 µm", to four digits; a dash unless finite.
inline std::string length_text(double length_m) {
  if (!std::isfinite(length_m)) return "–";
  const LengthUnit unit = length_unit(length_m);
  return fmt::format("{:.4g} {}", length_m * unit.per_metre, unit.name);
}

}  // namespace breakaway::format
