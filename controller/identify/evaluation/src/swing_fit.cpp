#include "swing_fit.hpp"

#include <algorithm>
#include <cmath>

namespace breakaway::evaluation {
namespace {

constexpr std::size_t least_on_a_side = 16;
constexpr double longest_s = 0.1;  // on either side of a switch

// Least squares by orthogonal columns, one reading a row.
template <std::size_t N>
class LeastSquares {
 public:
  void add(const std::array<double, N>& row, double value) {
    rows_.push_back(row);
    values_.push_back(value);
  }
  // Returns false where the columns are too much alike.
  bool solve(std::array<double, N>& coefficients, double& residual) {
    std::array<std::array<double, N>, N> r{};
    std::array<double, N> projected{};
    if (rows_.size() < N + 2) return false;
    for (std::size_t k = 0; k < N; ++k) {
      const double before = norm(k);
      for (int twice = 0; twice < 2; ++twice)
        for (std::size_t j = 0; j < k; ++j) {
          const double share = product(j, k);
          r[j][k] += share;
          for (auto& row : rows_) row[k] -= share * row[j];
        }
      r[k][k] = norm(k);
      if (!(r[k][k] > 1e-7 * before)) return false;
      for (auto& row : rows_) row[k] /= r[k][k];
      for (std::size_t i = 0; i < rows_.size(); ++i) projected[k] += rows_[i][k] * values_[i];
      for (std::size_t i = 0; i < rows_.size(); ++i) values_[i] -= projected[k] * rows_[i][k];
    }
    for (std::size_t k = N; k-- > 0;) {
      coefficients[k] = projected[k];
      for (std::size_t j = k + 1; j < N; ++j) coefficients[k] -= r[k][j] * coefficients[j];
      coefficients[k] /= r[k][k];
    }
    double sum = 0;
    for (const double value : values_) sum += value * value;
    residual = std::sqrt(sum / static_cast<double>(rows_.size() - N));
    return std::isfinite(residual);
  }

 private:
  double product(std::size_t j, std::size_t k) const {
    double sum = 0;
    for (const auto& row : rows_) sum += row[j] * row[k];
    return sum;
  }
  double norm(std::size_t k) const { return std::sqrt(product(k, k)); }

  std::vector<std::array<double, N>> rows_;
  std::vector<double> values_;
};

struct Phase {
  double cosine, sine;  // damped
};
Phase phase_at(double t, const Swing& swing) {
  const double envelope = std::exp(-swing.decay_1_s * t), angle = swing.rate_rad_s * t;
  return {envelope * std::cos(angle), envelope * std::sin(angle)};
}

// Readings in which the motor goes on before it is at two fifths of the speed that it has when a steady force begins to
// stop it.
std::size_t fast_part(std::size_t readings) { return readings * 3 / 5; }

}  // namespace

double SwingFit::stiffness_N_per_m(double rate_rad_s) const {
  const double rho = mass_ratio(rate_rad_s);
  return rate_rad_s * rate_rad_s * mass_kg() * rho / ((1 + rho) * (1 + rho));
}

std::vector<SwitchInMotion> switches_in_motion(const Record& record, const std::vector<Stretch>& stretches) {
  constexpr std::size_t settled = 6;  // readings from a command on that do not show it wholly
  const auto longest = static_cast<std::size_t>(std::max(longest_s / record.period_s, 40.0));
  std::vector<SwitchInMotion> found;
  for (std::size_t i = 1; i < stretches.size(); ++i) {
    const Stretch &a = stretches[i - 1], &b = stretches[i];
    if (a.last != b.first || a.last - a.first < settled + least_on_a_side) continue;
    const Motion before = motion_in(record, a.first + settled, a.last), after = motion_in(record, b.first, b.last);
    if (before.direction == 0 || before.direction != after.direction) continue;
    if (before.last + 2 < a.last) continue;
    const std::size_t n_before = std::min(a.last - before.first, longest);
    const std::size_t n_after = std::min(fast_part(after.last - b.first), longest);
    if (std::min(n_before, n_after) < least_on_a_side) continue;
    found.push_back({.first = a.last - n_before,
                     .at = b.first,
                     .last = b.first + n_after,
                     .before_N = a.command_N,
                     .after_N = b.command_N,
                     .direction = before.direction});
  }
  return found;
}

std::optional<SwingFit> fit_swing(const Record& record, const SwitchInMotion& one, const Swing& swing) {
  LeastSquares<8> fit;
  const double T = record.period_s, step_N = one.after_N - one.before_N;
  const double origin_m = record.readings[one.at].position_m;
  // Columns of about one size: time by the length of the window.
  const double unit_s = static_cast<double>(one.readings()) * T / 2;
  for (std::size_t i = one.first; i < one.last; ++i) {
    const double t = (static_cast<double>(i) - static_cast<double>(one.at)) * T - swing.delay_s, s = t / unit_s;
    const Phase ringing = phase_at(t, swing);
    std::array<double, 8> row{1, s, s * s, s * s * s, ringing.cosine, ringing.sine, 0, 0};
    if (t > 0) {
      const double damped = swing.decay_1_s / swing.rate_rad_s;
      row[6] = s * s / 2;
      row[7] = 1 - ringing.cosine - damped * ringing.sine;
    }
    fit.add(row, record.readings[i].position_m - origin_m);
  }
  std::array<double, 8> c{};
  SwingFit found;
  if (!fit.solve(c, found.residual_m)) return {};
  const double square_s2 = unit_s * unit_s;
  found.cubic = {c[0], c[1] / unit_s, c[2] / square_s2, c[3] / (square_s2 * unit_s)};
  found.ringing = {c[4], c[5]};
  found.per_kg = c[6] / square_s2 / step_N;
  found.swing_m_per_N = c[7] / step_N;
  return found;
}

bool both_slide(const SwingFit& fit, const SwitchInMotion& one, const Swing& swing, double period_s) {
  const double rho = fit.mass_ratio(swing.rate_rad_s), step_N = one.after_N - one.before_N;
  if (!(fit.per_kg > 0 && rho > 0)) return false;
  const double w = swing.rate_rad_s, decay = swing.decay_1_s;
  for (std::size_t i = one.first; i < one.last; ++i) {
    const double t = (static_cast<double>(i) - static_cast<double>(one.at)) * period_s - swing.delay_s;
    const Phase phase = phase_at(t, swing);
    double both_m_s = fit.cubic[1] + (2 * fit.cubic[2] + 3 * fit.cubic[3] * t) * t;
    double swing_m_s = fit.ringing[0] * (-decay * phase.cosine - w * phase.sine) +
                       fit.ringing[1] * (w * phase.cosine - decay * phase.sine);
    if (t > 0) {
      both_m_s += step_N * fit.per_kg * t;
      swing_m_s += step_N * fit.swing_m_per_N * (w + decay * decay / w) * phase.sine;
    }
    const double slower_m_s =
        std::min(one.direction * (both_m_s + swing_m_s), one.direction * (both_m_s - swing_m_s / rho));
    if (!(slower_m_s > 0)) return false;
  }
  return true;
}

std::optional<MeanMotion> mean_motion(const Record& record, std::size_t first, std::size_t last, const Swing& swing) {
  LeastSquares<5> fit;
  const double T = record.period_s, half_s = static_cast<double>(last - first) * T / 2;
  const double middle = static_cast<double>(first + last - 1) / 2, origin_m = record.readings[first].position_m;
  for (std::size_t i = first; i < last; ++i) {
    const double t = (static_cast<double>(i) - middle) * T, s = t / half_s;
    const Phase phase = phase_at(t, {swing.rate_rad_s, 0, 0});
    fit.add({1, s, s * s, phase.cosine, phase.sine}, record.readings[i].position_m - origin_m);
  }
  std::array<double, 5> c{};
  MeanMotion found;
  if (!fit.solve(c, found.residual_m)) return {};
  found.position_m = origin_m + c[0];
  found.speed_m_s = c[1] / half_s;
  found.acceleration_m_s2 = 2 * c[2] / (half_s * half_s);
  return found;
}

}  // namespace breakaway::evaluation
