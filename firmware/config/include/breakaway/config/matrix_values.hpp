// Matrices and vectors of numbers as a file writes them, row by row.
#pragma once

#include <Eigen/Core>
#include <string_view>

#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// [[...], ...], rows of equally many numbers; at most 64 of each.
Value matrix(Eigen::MatrixXd& to, std::string_view unit, Range range = {});

Value vector(Eigen::VectorXd& to, std::string_view unit, Range range = {});

}  // namespace breakaway::config
