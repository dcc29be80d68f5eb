#include "breakaway/stability/lmi.hpp"

#include <algorithm>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>

#include "breakaway/stability/dense.hpp"
#include "sdpa_program.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

void append_entry(std::string& text, Index variable, Index block, Index row, Index column, double value) {
  if (value == 0) return;
  for (const Index place : {variable, block, row + 1, column + 1}) text += std::to_string(place) + ' ';
  text += to_text(value) + '\n';
}

void append_upper_triangle(std::string& text, Index variable, Index block, const MatrixXd& matrix) {
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (Index j = i; j < matrix.cols(); ++j) append_entry(text, variable, block, i, j, matrix(i, j));
  }
}

// SDPA's sparse format: sum_k x_k F_k - F_0 >= 0, entries as "k block i j value"; the rows are a diagonal block, whose
// size is written with a minus.
std::string sparse_format(const LmiProblem& problem) {
  const Index matrices = static_cast<Index>(problem.matrices.size()), rows = problem.rows.rows();
  std::string text = std::to_string(problem.cost.size()) + '\n' + std::to_string(matrices + (rows > 0 ? 1 : 0)) + '\n';
  for (const MatrixInequality& block : problem.matrices) text += std::to_string(block.constant.rows()) + ' ';
  text += (rows > 0 ? std::to_string(-rows) : "") + '\n';
  for (const double cost : problem.cost) text += to_text(cost) + ' ';
  text += '\n';
  for (Index b = 0; b < matrices; ++b) {
    const MatrixInequality& block = problem.matrices[static_cast<std::size_t>(b)];
    append_upper_triangle(text, 0, b + 1, -block.constant);
    for (const auto& [variable, matrix] : block.terms) append_upper_triangle(text, variable + 1, b + 1, matrix);
  }
  for (Index i = 0; i < rows; ++i) {
    append_entry(text, 0, matrices + 1, i, i, -problem.offsets[i]);
    for (Index k = 0; k < problem.cost.size(); ++k) append_entry(text, k + 1, matrices + 1, i, i, problem.rows(i, k));
  }
  return text;
}

std::string phase(const std::string& result) {
  constexpr std::string_view label = "phase.value  = ";
  const auto at = result.find(label);
  if (at == std::string::npos) return "no result";
  const auto begin = at + label.size();
  return result.substr(begin, result.find_first_of(" \n", begin) - begin);
}

// The numbers behind "xVec =", as {1.0,2.0}.
VectorXd variables(const std::string& result, Index count) {
  std::istringstream text{result.substr(std::min(result.size(), result.find("xVec")))};
  text.ignore(std::numeric_limits<std::streamsize>::max(), '{');
  VectorXd x(count);
  char separator = 0;
  for (double& value : x) text >> value >> separator;
  if (!text || !x.allFinite())
    throw InputError{"the solver sdpa wrote no solution that can be read; ask for less, or use identical gains"};
  return x;
}

}  // namespace

VectorXd minimised(const LmiProblem& problem) {
  const std::string result = sdpa_result(sparse_format(problem));
  // The other answers mean that the problem is infeasible or unbounded, or that SDPA gave up before x was feasible.
  const std::string found = phase(result);
  if (found != "pdOPT" && found != "pdFEAS" && found != "pFEAS") {
    throw InputError{"the solver sdpa found no solution of the linear matrix inequalities (" + found +
                     "); ask for less, or use identical gains"};
  }
  return variables(result, problem.cost.size());
}

double proven_least_eigenvalue(const MatrixXd& symmetric) {
  const double n = static_cast<double>(symmetric.rows()), size = symmetric.norm();
  const double shift = dense::symmetric_eigenvalues(symmetric)[0] - 16 * n * epsilon * size;
  const MatrixXd shifted = symmetric - shift * MatrixXd::Identity(symmetric.rows(), symmetric.rows());
  if (!dense::Cholesky(shifted).succeeded()) return -std::numeric_limits<double>::infinity();
  // The factors' product differs from `shifted` by less than (n + 1) epsilon times its trace (Higham, Accuracy and
  // Stability of Numerical Algorithms, Theorem 10.3), and the shift has been rounded.
  return shift - 2 * (n + 2) * epsilon * (shifted.trace() + size);
}

}  // namespace breakaway::stability
