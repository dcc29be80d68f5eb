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

bool take_row(const Entry& entry, Range range, std::vector<std::vector<double>>& rows) {
  return numbers(rows.emplace_back(), "", range).take(entry) && rows.back().size() == rows.front().size();
}

Form matrix_form(Range range) {
  const Form number{.type = Form::Type::number, .range = range};
  const Form row{.type = Form::Type::array, .parts = {number}, .most_entries = most_coordinates};
  return {.type = Form::Type::array, .parts = {row}, .least_entries = 1, .most_entries = most_coordinates};
}

}  // namespace

Value matrix(MatrixXd& to, std::string_view unit, Range range) {
  double ignored = 0;
  const std::string each = number(ignored, unit, range).expects;
  return {.expects = fmt::format("rows of equally many entries, as [[1, 0], [0, 1]], at most {}, each {}",
                                 most_coordinates, each),
          .take =
              [&to, range](const Entry& entry) {
                const toml::array* lines = entry.node.as_array();
                if (lines == nullptr || lines->empty() || lines->size() > most_coordinates) return false;
                std::vector<std::vector<double>> rows;
                for (const toml::node& line : *lines) {
                  if (!take_row({line, entry.parent, entry.key}, range, rows)) return false;
                }
                if (rows.front().size() > most_coordinates) return false;
                to.resize(static_cast<Index>(rows.size()), static_cast<Index>(rows.front().size()));
                for (Index i = 0; i < to.rows(); ++i) {
                  to.row(i) = VectorXd::Map(rows[static_cast<std::size_t>(i)].data(), to.cols());
                }
                return true;
              },
          .form = matrix_form(range)};
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
