#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "breakaway/design/k3_table_builder.hpp"
#include "parts.hpp"

namespace breakaway::tradeoff {
namespace {

struct Plant {
  design::KickPlant<double> kick;
  double range_m;  // c_upper
};
const Plant mild{{1, 1, 3, 2.5}, 4.5};
const Plant hard{{1, 1, 20, 0.45}, 4.5};

// R(s) = |k3| / s at the nearest of equidistant roots s = sqrt|y|.
template <class Real, std::size_t Nodes>
struct NearestTable {
  Real nodes_per_root{};
  std::array<Real, Nodes> nodes{};

  static NearestTable make(const design::K3<double>& law, double range_m) {
    NearestTable table;
    const double last = std::sqrt(range_m);
    table.nodes_per_root = static_cast<Real>((Nodes - 1) / last);
    for (std::size_t i = 0; i < Nodes; ++i)
      table.nodes[i] = static_cast<Real>(law.reduced(last * static_cast<double>(i) / (Nodes - 1)));
    return table;
  }
  Real impulse_Ns(Real y) const {
    const Real root = std::sqrt(std::fabs(y));
    const auto i = std::min(static_cast<std::size_t>(root * nodes_per_root + Real(0.5)), Nodes - 1);
    return std::copysign(root * nodes[i], -y);
  }
};

// R linear in s between equidistant roots.
template <class Real, std::size_t Nodes>
struct LinearTable {
  NearestTable<Real, Nodes> table;

  static LinearTable make(const design::K3<double>& law, double range_m) {
    return {NearestTable<Real, Nodes>::make(law, range_m)};
  }
  Real impulse_Ns(Real y) const {
    const Real root = std::sqrt(std::fabs(y)), place = root * table.nodes_per_root;
    const auto i = std::min(static_cast<std::size_t>(place), Nodes - 2);
    const Real left = table.nodes[i], rise = table.nodes[i + 1] - left;
    return std::copysign(root * (left + (place - static_cast<Real>(i)) * rise), -y);
  }
};

// k3 itself linear in y, as one would write it first: wrong near the target, where k3 has an infinite slope.
template <class Real, std::size_t Nodes>
struct LinearInY {
  Real nodes_per_m{};
  std::array<Real, Nodes> nodes{};

  static LinearInY make(const design::K3<double>& law, double range_m) {
    LinearInY table;
    table.nodes_per_m = static_cast<Real>((Nodes - 1) / range_m);
    for (std::size_t i = 0; i < Nodes; ++i)
      table.nodes[i] = static_cast<Real>(law.impulse_Ns(-range_m * static_cast<double>(i) / (Nodes - 1)));
    return table;
  }
  Real impulse_Ns(Real y) const {
    const Real place = std::fabs(y) * nodes_per_m;
    const auto i = std::min(static_cast<std::size_t>(place), Nodes - 2);
    return std::copysign(nodes[i] + (place - static_cast<Real>(i)) * (nodes[i + 1] - nodes[i]), -y);
  }
};

// R as a series of Chebyshev polynomials in s, summed by Clenshaw.
template <class Real, std::size_t Nodes>
struct Chebyshev {
  Real scale{};
  std::array<Real, Nodes> coefficients{};

  static Chebyshev make(const design::K3<double>& law, double range_m) {
    Chebyshev series;
    const double last = std::sqrt(range_m);
    series.scale = static_cast<Real>(4 / last);
    for (std::size_t k = 0; k < Nodes; ++k) {
      double sum = 0;
      for (std::size_t j = 0; j < Nodes; ++j) {
        const double angle = std::numbers::pi * (static_cast<double>(j) + 0.5) / Nodes;
        sum += law.reduced(last * (1 + std::cos(angle)) / 2) * std::cos(static_cast<double>(k) * angle);
      }
      series.coefficients[k] = static_cast<Real>(sum * (k == 0 ? 1 : 2) / Nodes);
    }
    return series;
  }
  Real impulse_Ns(Real y) const {
    const Real root = std::sqrt(std::fabs(y)), twice_x = root * scale - 2;
    Real last = 0, last_but_one = 0;
    for (std::size_t k = Nodes - 1; k > 0; --k) {
      const Real next = coefficients[k] + twice_x * last - last_but_one;
      last_but_one = last;
      last = next;
    }
    return std::copysign(root * (coefficients[0] + twice_x / 2 * last - last_but_one), -y);
  }
};

// The table that is flashed, with the number of nodes free.
template <class Real, std::size_t Nodes>
struct Hermite {
  law::K3Table<Real, Nodes> table;

  static Hermite make(const design::K3<double>& law, double range_m) {
    // Without the builder's proof, which takes longer than all evaluators together.
    Hermite hermite;
    const double last = std::sqrt(range_m), spacing = last / (Nodes - 1);
    hermite.table.root_max = static_cast<Real>(last);
    hermite.table.nodes_per_root = static_cast<Real>(1 / spacing);
    for (std::size_t i = 0; i < Nodes; ++i) {
      const double root = static_cast<double>(i) * spacing;
      hermite.table.nodes[i] = {static_cast<Real>(law.reduced(root)),
                                static_cast<Real>(spacing * law.reduced_slope(root))};
    }
    return hermite;
  }
  Real impulse_Ns(Real y) const { return table.impulse_Ns(y); }
};

template <class Real>
struct Exact {
  design::K3<Real> law;
  Real impulse_Ns(Real y) const { return law.impulse_Ns(y); }
};

template <class Real>
constexpr const char* scalar_name = sizeof(Real) == sizeof(float) ? "float" : "double";

template <class Law>
Law make(const Plant& plant) {
  return Law::make(design::K3<double>::make(plant.kick), plant.range_m);
}
template <class Law>
requires std::is_same_v<Law, Exact<float>> || std::is_same_v<Law, Exact<double>> Law make(const Plant& plant) {
  using Real = std::conditional_t<std::is_same_v<Law, Exact<float>>, float, double>;
  const auto& [m, k1, k22, f] = plant.kick;
  return {design::K3<Real>::make(
      {static_cast<Real>(m), static_cast<Real>(k1), static_cast<Real>(k22), static_cast<Real>(f)})};
}

// Errors from 1e-12 of the range on, spread evenly over roots and over orders of magnitude, against the exact law with
// 64 bits of significand for the argument as it was rounded.
template <class Real, class Law>
double largest_error(const Plant& plant, int samples) {
  const auto& [m, k1, k22, f] = plant.kick;
  const auto exact = design::K3<long double>::make({m, k1, k22, f});
  const auto law = make<Law>(plant);
  double worst = 0;
  const auto look = [&](double y_m) {
    const auto y = static_cast<Real>(y_m);
    const auto error = static_cast<double>(std::fabs(law.impulse_Ns(y) / exact.impulse_Ns(y) - 1));
    worst = std::fmax(worst, error);
  };
  for (int i = 1; i <= samples; ++i) {
    const double share = static_cast<double>(i) / samples;
    look(plant.range_m * share * share);
    look(plant.range_m * std::pow(10, -12 * (1 - share)));
  }
  return worst;
}

constexpr std::size_t arguments = 512;

template <class Real, class Law>
std::function<void()> calls(Law law) {
  const auto y = std::make_shared<std::array<Real, arguments>>();
  for (std::size_t i = 0; i < arguments; ++i) {  // in an order that no branch can learn
    const double share = static_cast<double>((i * 197) % arguments + 1) / arguments;
    (*y)[i] = static_cast<Real>(mild.range_m * share * share);
  }
  return [y, law] {
    for (const Real each : *y) keep(static_cast<double>(law.impulse_Ns(each)));
  };
}

// What a loop over the arguments costs without any law.
template <class Real>
struct Nothing {
  Real impulse_Ns(Real y) const { return y; }
};

struct Evaluator {
  EvaluatorRow row;
  double (*error)(const Plant&, int samples);
  Work work;
};

template <class Real, class Law>
Evaluator evaluator(const std::string& method, std::size_t nodes) {
  std::string work = fmt::format("k3-{}-{}-{}", method.substr(0, method.find(' ')), scalar_name<Real>, nodes);
  for (char& c : work) c = c == ',' ? '-' : c;
  return {{.method = method, .scalar = scalar_name<Real>, .nodes = nodes, .bytes = sizeof(Law)},
          largest_error<Real, Law>,
          {work, [] { return calls<Real>(make<Law>(mild)); }, arguments}};
}

template <class Real>
void add_all(std::vector<Evaluator>& all) {
  all.push_back(evaluator<Real, LinearInY<Real, 4096>>("naive: k3 linear in y", 4096));
  all.push_back(evaluator<Real, NearestTable<Real, 1024>>("nearest node", 1024));
  all.push_back(evaluator<Real, LinearTable<Real, 64>>("linear", 64));
  all.push_back(evaluator<Real, LinearTable<Real, 1024>>("linear", 1024));
  all.push_back(evaluator<Real, Hermite<Real, 17>>("cubic Hermite", 17));
  all.push_back(evaluator<Real, Hermite<Real, 65>>("cubic Hermite", 65));
  all.push_back(evaluator<Real, Hermite<Real, 267>>("cubic Hermite", 267));
  all.push_back(evaluator<Real, Chebyshev<Real, 9>>("Chebyshev", 9));
  all.push_back(evaluator<Real, Chebyshev<Real, 17>>("Chebyshev", 17));
  all.push_back(evaluator<Real, Chebyshev<Real, 33>>("Chebyshev", 33));
  all.push_back(evaluator<Real, Exact<Real>>("exact", 0));
}

std::vector<Evaluator> all_evaluators() {
  std::vector<Evaluator> all;
  add_all<float>(all);
  add_all<double>(all);
  return all;
}

const char* const flashed = "k3-cubic-float-267";

}  // namespace

std::vector<Work> evaluator_works() {
  std::vector<Work> works{{"k3-none-float", [] { return calls<float>(Nothing<float>{}); }, arguments},
                          {"k3-none-double", [] { return calls<double>(Nothing<double>{}); }, arguments}};
  for (const Evaluator& e : all_evaluators()) works.push_back(e.work);
  return works;
}

std::vector<EvaluatorRow> measure_evaluators(const Options& options) {
  const auto works = evaluator_works();
  const auto costs = measure_costs(works, options.counting);
  const auto less_nothing = [&](std::size_t i, bool is_float) {
    const Cost &cost = costs[i], &nothing = costs[is_float ? 0 : 1];
    return Cost{cost.instructions - nothing.instructions, cost.time_ratio - nothing.time_ratio};
  };
  double unit = 1;
  for (std::size_t i = 0; i < works.size(); ++i) {
    if (works[i].name == flashed) unit = less_nothing(i, true).time_ratio;
  }
  std::vector<EvaluatorRow> rows;
  const auto all = all_evaluators();
  for (std::size_t i = 0; i < all.size(); ++i) {
    EvaluatorRow row = all[i].row;
    const int samples = options.quick ? 300 : 20000;
    row.mild_error = all[i].error(mild, samples);
    row.hard_error = all[i].error(hard, samples);
    row.call = less_nothing(i + 2, row.scalar == scalar_name<float>);
    row.call.time_ratio /= unit;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace breakaway::tradeoff
