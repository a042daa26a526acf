#include "checks.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>

namespace rbvi {

void require(bool holds, const std::string &what) {
  if (!holds) throw failure("the reduced model is inconsistent: " + what);
}

void FieldChecker::operator()(const std::string &name, const Matrix &matrix, Shape shape) const {
  const Index rows = shape.rows == any_size ? matrix.rows() : shape.rows,
              columns = shape.columns == any_size ? matrix.cols() : shape.columns;
  require(matrix.rows() == rows && matrix.cols() == columns,
          name + " is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
              " instead of " + std::to_string(rows) + " x " + std::to_string(columns));
  require(matrix.allFinite(), name + " has an entry that is not finite");
}

void FieldChecker::operator()(const std::string &name, const std::vector<int> &indices,
                              Indices said) const {
  require(said.count == any_size || std::ssize(indices) == said.count,
          name + " has " + std::to_string(indices.size()) + " entries instead of " +
              std::to_string(said.count));
  require(std::ranges::all_of(indices, [&](int i) { return i >= said.lowest && i < said.bound; }),
          name + " points outside " + std::to_string(said.lowest) + ".." +
              std::to_string(said.bound - 1));
}

void FieldChecker::operator()(const std::string &name, int value, Between said) const {
  require(value >= said.lowest && value <= said.highest,
          name + " is " + std::to_string(value) + " and not in " + std::to_string(said.lowest) +
              ".." + std::to_string(said.highest));
}

} // namespace rbvi
