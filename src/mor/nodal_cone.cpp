#include "cone_tools.hpp"

namespace rbvi {

Cone nodal_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options) {
  const Matrix factor = product_factor(product);
  std::vector<bool> inside = ever_in_contact(snapshots);
  for (int layer = 0; layer < options.ring; ++layer)
    add_neighbours(inside, product);

  std::vector<Index> nodes;
  Matrix outside = snapshots;
  for (Index i = 0; i < snapshots.rows(); ++i)
    if (inside[i]) {
      nodes.push_back(i);
      outside.row(i).setZero();
    }
  const auto count = std::ssize(nodes);
  Cone cone;
  cone.basis.generators = Matrix::Zero(snapshots.rows(), count);
  for (Index k = 0; k < count; ++k) {
    const Index i = nodes[k];
    cone.basis.generators(i, k) = 1 / factor.col(i).norm();
  }
  cone.history.size = {0, static_cast<int>(count)};
  // The snapshots without what is outside lie in the cone: a bound, 0 or next to it.
  const double left = (factor * outside).colwise().norm().maxCoeff();
  cone.history.error = {1, left / (factor * snapshots).colwise().norm().maxCoeff()};
  cone.history.gram_condition = {gram_condition(factor * cone.basis.generators)};
  cone.history.reason = "round-off reached";
  return cone;
}

} // namespace rbvi
