#include "rbvi/core/local_fit.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <numeric>
#include <vector>

namespace rbvi {

Vector parts_of_box(const ParameterSpace &space, const FullMu &all_parameters) {
  Vector values(space.size());
  for (int i = 0; i < space.size(); ++i)
    values[i] = all_parameters[space.free[i]];
  return parts_of_box(space, Matrix(values));
}

Matrix parts_of_box(const ParameterSpace &space, Matrix free) {
  for (int i = 0; i < space.size() && free.size() > 0; ++i)
    free.row(i) /= space.at(i).upper - space.at(i).lower;
  return free;
}

Vector local_fit(const Matrix &values, const Matrix &points, const Vector &here) {
  constexpr double largest_weights = 3; // their sum of sizes; 1 inside the samples
  const Index d = points.rows(), count = std::min<Index>(points.cols(), 2 * (d + 1));
  const Vector distances = (points.colwise() - here).colwise().squaredNorm();
  std::vector<Index> order(points.cols());
  std::iota(order.begin(), order.end(), 0);
  std::partial_sort(order.begin(), order.begin() + count, order.end(),
                    [&](Index a, Index b) { return distances[a] < distances[b]; });
  order.resize(count);
  const Index nearest = order.front();
  if (count <= d || !(distances[nearest] > 0)) return values.col(nearest);

  Matrix functions(d + 1, count); // 1 and the coordinates from here, at each sample
  functions.row(0).setOnes();
  functions.bottomRows(d) = points(Eigen::all, order).colwise() - here;
  const Vector weights = distances(order).cwiseInverse();
  const Matrix weighted = functions * weights.asDiagonal();
  Matrix normal = weighted * functions.transpose();
  normal.diagonal().tail(d).array() += 1e-10 * normal.diagonal().tail(d).sum();
  Vector factors = weighted.transpose() * normal.llt().solve(Vector::Unit(d + 1, 0));
  factors /= factors.sum();
  if (!(factors.lpNorm<1>() <= largest_weights)) return values.col(nearest);
  return values(Eigen::all, order) * factors;
}

} // namespace rbvi
