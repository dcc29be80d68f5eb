#include "tune_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "parallel.hpp"

namespace breakaway::study {
namespace {

constexpr double most_per_mille = 32767;

config::Setting setting(const char* table, const char* key, double value) {
  return {table, key, fmt::format("{}", value)};
}

Improvement stronger(const TunedAxis& axis, double factor) {
  const config::Axis& a = axis.axis();
  const config::Drive& drive = *a.drive;
  const double force_N = config::max_force_N(a);
  Improvement i{"the force", "max_force_N", force_N, force_N * factor, {}};
  const double per_mille = std::ceil(drive.max_torque_per_mille * factor);
  if (per_mille <= most_per_mille)
    i.settings.push_back({"drive", "max_torque_per_mille", fmt::format("{}", static_cast<std::int64_t>(per_mille))});
  else
    i.settings.push_back(setting("drive", "rated_torque_Nm", 1e-3 * std::ceil(drive.rated_torque_mNm * factor)));
  if (drive.peak_force_N) i.settings.push_back(setting("drive", "peak_force_N", *drive.peak_force_N * factor));
  if (std::isfinite(a.controller.max_force_N))
    i.settings.push_back(setting("controller", "max_force_N", a.controller.max_force_N * factor));
  if (std::isfinite(a.limits.force_N)) i.settings.push_back(setting("limits", "force_N", a.limits.force_N * factor));
  return i;
}

std::optional<Improvement> higher_speed(const TunedAxis& axis, double factor) {
  const double allowed_m_s = axis.allowed_m_s();
  if (!(allowed_m_s < axis.fastest_m_s())) return {};  // nothing ever goes that fast
  Improvement i{"the speed limit", "the speed limit", allowed_m_s, allowed_m_s * factor, {}};
  const config::Axis& a = axis.axis();
  if (std::isfinite(a.limits.speed_m_s))
    i.settings.push_back(setting("limits", "speed_m_s", a.limits.speed_m_s * factor));
  if (const double approach = a.controller.max_approach_speed_m_s; std::isfinite(approach))
    i.settings.push_back(setting("controller", "max_approach_speed_m_s", approach * factor));
  if (a.move) i.settings.push_back(setting("move", "speed_m_s", a.move->speed_m_s * factor));
  return i;
}

// In microseconds, in which drives are told of it.
double shortened_s(double period_s, double factor) { return std::round(period_s / factor * 1e6) / 1e6; }

bool certified(const TunedAxis& axis, const std::vector<config::Setting>& settings, const TuneOptions& options) try {
  const TunedAxis better = axis.changed(settings);
  static_cast<void>(Search{better, options, [](double) {}}.tolerance());
  return true;
} catch (const InputError&) {
  return false;
}

}  // namespace

std::vector<Improvement> improvements(const TunedAxis& axis, double factor) {
  std::vector<Improvement> all;
  if (axis.ideal()) return all;
  const config::Axis& a = axis.axis();
  const auto smaller = [&](const char* name, const char* table, const char* key, double value, double better) {
    all.push_back({name, key, value, better, {setting(table, key, better)}});
  };
  const double period_s = axis.scenario().node.period_s();
  smaller("the period", "loop", "period_s", period_s, shortened_s(period_s, factor));
  smaller("the encoder", "drive", "encoder_resolution_m", a.drive->encoder_resolution_m,
          a.drive->encoder_resolution_m / factor);
  all.push_back(stronger(axis, factor));
  if (const double lag_s = a.drive->current_loop_time_constant_s; lag_s > 0)
    smaller("the lag of the current loop", "drive", "current_loop_time_constant_s", lag_s, lag_s / factor);
  if (const std::optional<Improvement> speed = higher_speed(axis, factor)) all.push_back(*speed);
  if (a.move) {
    const double limit = a.move->acceleration_m_s2;
    all.push_back({"the limit of acceleration",
                   "acceleration_m_s2",
                   limit,
                   limit * factor,
                   {setting("move", "acceleration_m_s2", limit * factor)}});
  }
  return all;
}

namespace {

// The least factor, to within a tenth, with which the number of this place among the improvements is good enough.
double enough(const TunedAxis& axis, std::size_t place, const TuneOptions& options) {
  constexpr double most = 1024, fine = 1.1;
  double good = 2;
  while (good <= most && !certified(axis, improvements(axis, good)[place].settings, options)) good *= 2;
  if (good > most) return std::numeric_limits<double>::infinity();
  for (double bad = good / 2; good / bad > fine;) {
    const double middle = std::sqrt(good * bad);
    (certified(axis, improvements(axis, middle)[place].settings, options) ? good : bad) = middle;
  }
  return good;
}

}  // namespace

// The numbers that are to be changed together, rounded to the side that does.
std::string changes(const Improvement& i) {
  const auto rounded = i.after < i.before ? rounded_down : rounded_up;
  std::string text;
  for (const config::Setting& s : i.settings)
    text +=
        fmt::format("{}[{}] {} = {:g}", text.empty() ? "" : " and ", s.table, s.key, rounded(std::stod(s.value), 2));
  return text;
}

std::string remedy(const TunedAxis& axis, const TuneOptions& options) {
  if (certified(axis, {}, options)) return {};  // what it lacks is no number of these
  const std::size_t count = improvements(axis, 2).size();
  std::vector<double> factors(count);
  const unsigned threads = options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  in_parallel(count, static_cast<int>(threads), 1,
              [&](int) { return [&](std::size_t i) { factors[i] = enough(axis, i, options); }; });
  const auto least = std::ranges::min_element(factors);
  if (least == factors.end() || !std::isfinite(*least)) return {};
  const Improvement i = improvements(axis, *least)[static_cast<std::size_t>(least - factors.begin())];
  return fmt::format("{} = {:.4g} makes it impossible; {} would do", i.key, i.before, changes(i));
}

}  // namespace breakaway::study
