#include "breakaway/config/matrix_values.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <vector>

namespace breakaway::config {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t most_coordinates = 64;  // the closed forms of a segment cost the cube of it

bool take_row(const Entry& entry, std::vector<std::vector<double>>& rows) {
  return numbers(rows.emplace_back(), "").take(entry) && rows.back().size() == rows.front().size();
}

Form matrix_form() {
  const Form row{.type = Form::Type::array, .parts = {{.type = Form::Type::number}}, .most_entries = most_coordinates};
  return {.type = Form::Type::array, .parts = {row}, .least_entries = 1, .most_entries = most_coordinates};
}

}  // namespace

Value matrix(MatrixXd& to, std::string_view unit) {
  const std::string expects = fmt::format("rows of equally many finite numbers{}{}, as [[1, 0], [0, 1]], at most {}",
                                          unit.empty() ? "" : " in ", unit, most_coordinates);
  return {.expects = expects,
          .take =
              [&to](const Entry& entry) {
                const toml::array* lines = entry.node.as_array();
                if (lines == nullptr || lines->empty() || lines->size() > most_coordinates) return false;
                std::vector<std::vector<double>> rows;
                for (const toml::node& line : *lines) {
                  if (!take_row({line, entry.parent, entry.key}, rows)) return false;
                }
                if (rows.front().size() > most_coordinates) return false;
                to.resize(static_cast<Index>(rows.size()), static_cast<Index>(rows.front().size()));
                for (Index i = 0; i < to.rows(); ++i) {
                  to.row(i) = VectorXd::Map(rows[static_cast<std::size_t>(i)].data(), to.cols());
                }
                return true;
              },
          .form = matrix_form()};
}

Value vector(VectorXd& to, std::string_view unit, Range range) {
  std::vector<double> ignored;
  Value value = numbers(ignored, unit, range);
  value.take = [&to, range](const Entry& entry) {
    std::vector<double> values;
    if (!numbers(values, "", range).take(entry)) return false;
    to = VectorXd::Map(values.data(), static_cast<Index>(values.size()));
    return true;
  };
  return value;
}

}  // namespace breakaway::config
