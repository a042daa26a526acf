#include "rbvi/core/box.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <vector>

namespace rbvi {

namespace {

constexpr int all_corners = 5; ///< of so many parameters

/// Parameter i has its upper bound at corner k where an odd number of the bits of k & mask are set.
/// The masks of the first parameters are single bits, those of the others sums of them, which
/// differ: a fractional factorial design.
std::vector<unsigned> masks(int parameters) {
  std::vector<unsigned> result;
  for (int i = 0; i < std::min(parameters, all_corners); ++i)
    result.push_back(1U << i);
  for (unsigned sum = (1U << all_corners) - 1; std::ssize(result) < parameters;
       sum = sum > 1 ? sum - 1 : (1U << all_corners) - 1)
    if (!std::has_single_bit(sum)) result.push_back(sum);
  return result;
}

} // namespace

Mu corner(const ParameterSpace &space, unsigned long bits) {
  Mu mu;
  for (int i = 0; i < space.size(); ++i)
    mu.push_back((bits >> i & 1U) != 0 ? space.at(i).upper : space.at(i).lower);
  return mu;
}

std::vector<Mu> corners_and_faces(const ParameterSpace &space) {
  const int size = space.size();
  const std::vector<unsigned> of = masks(size);
  std::vector<Mu> set;
  for (unsigned k = 0; k < 1U << std::min(size, all_corners); ++k) {
    unsigned long bits = 0;
    for (int i = 0; i < size; ++i)
      bits |= (std::popcount(k & of[i]) % 2UL) << i;
    set.push_back(corner(space, bits));
  }
  if (size == 1) return set; // its two faces are the corners
  const Mu low = corner(space, 0), high = corner(space, ~0UL);
  for (std::size_t i = 0; i < low.size(); ++i)
    for (const Mu *side : {&low, &high}) {
      Mu mu;
      for (std::size_t j = 0; j < low.size(); ++j)
        mu.push_back(
            j == i ? (*side)[j] // as a grid
                   : taken(space.at(static_cast<int>(j)), std::fma(0.5, high[j] - low[j], low[j])));
      set.push_back(mu);
    }
  return set;
}

bool nearer_to_boundary(const ParameterSpace &space, const Matrix &set, const Mu &mu) {
  constexpr double round_off = 1e-12;
  const Vector here = parts_of_box(space, expand(space, mu)), zero = Vector::Zero(here.size()),
               lower = parts_of_box(space, expand(space, corner(space, 0)));
  const Matrix others = parts_of_box(space, set).colwise() - lower;
  const Vector part = here - lower;
  for (Index i = 0; i < part.size(); ++i)
    if (part[i] < others.row(i).minCoeff() - round_off ||
        part[i] > others.row(i).maxCoeff() + round_off)
      return true;
  const Vector at = (part.array() < 0.5).select(zero, 1.0);
  return (part - at).norm() < (others.colwise() - at).colwise().norm().minCoeff() - round_off;
}

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
