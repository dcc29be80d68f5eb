#include "breakaway/design/k3.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace {

using breakaway::design::K3;
using breakaway::design::KickPlant;

struct Row {
  KickPlant<double> plant;
  double distance_m, impulse_Ns, time_to_go_s;
};

// tests/reference/k3.csv, made by tests/reference/k3.py.
std::vector<Row> reference_rows() {
  std::ifstream file(BREAKAWAY_SOURCE_DIR "/tests/reference/k3.csv");
  std::string line;
  std::getline(file, line);
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    std::array<double, 7> v{};
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    for (double& value : v) {
      std::string word;
      words >> word;
      value = std::stod(word);
    }
    rows.push_back({{v[0], v[1], v[2], v[3]}, v[4], v[5], v[6]});
  }
  return rows;
}

double relative_error(double value, double reference) { return std::fabs(value / reference - 1); }

constexpr KickPlant<double> example{1.0, 1.0, 3.0, 2.5};  // section V of [I]

TEST(K3, AgreesWithHighPrecisionReferenceTo1em14) {
  const auto rows = reference_rows();
  ASSERT_GT(rows.size(), 1500U);
  double worst_impulse = 0, worst_time = 0, worst_speed = 0;
  for (const Row& row : rows) {
    const auto law = K3<double>::make(row.plant);
    ASSERT_TRUE(law) << law.error().message;
    worst_impulse = std::max(worst_impulse, relative_error(law->impulse_Ns(-row.distance_m), row.impulse_Ns));
    worst_speed =
        std::max(worst_speed, relative_error(law->speed_m_s(row.distance_m) * row.plant.mass_kg, row.impulse_Ns));
    worst_time = std::max(worst_time, relative_error(law->time_to_go_s(row.distance_m), row.time_to_go_s));
    ASSERT_FALSE(std::isnan(worst_impulse + worst_time));
  }
  RecordProperty("worst_impulse", std::to_string(worst_impulse * 1e15) + "e-15");
  RecordProperty("worst_time", std::to_string(worst_time * 1e15) + "e-15");
  std::cout << "worst relative error: impulse " << worst_impulse << ", speed " << worst_speed << ", time to go "
            << worst_time << '\n';
  EXPECT_LE(worst_impulse, 1e-14);
  EXPECT_LE(worst_speed, 1e-14);
  EXPECT_LE(worst_time, 1e-14);
}
}  // namespace
