#include "checks.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>

namespace rbvi {

void require(bool holds, const std::string &what) {
  if (!holds) throw failure("the reduced model is inconsistent: " + what);
}

void require_shape(const Matrix &matrix, Index rows, Index cols, const std::string &name) {
  require(matrix.rows() == rows && matrix.cols() == cols,
          name + " is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
              " instead of " + std::to_string(rows) + " x " + std::to_string(cols));
  require(matrix.allFinite(), name + " has an entry that is not finite");
}

void require_indices(const std::vector<int> &indices, Index bound, const std::string &name) {
  require(std::all_of(indices.begin(), indices.end(), [&](int i) { return i >= 0 && i < bound; }),
          name + " points outside 0.." + std::to_string(bound - 1));
}

} // namespace rbvi
