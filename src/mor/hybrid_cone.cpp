#include "cone_tools.hpp"

#include "rbvi/core/error.hpp"

namespace rbvi {

Cone hybrid_cone(const Matrix &, const SparseMatrix &, const ConeOptions &, const ColumnSource &) {
  throw failure("not built yet");
}

} // namespace rbvi
