#include "rbvi/model/chebyshev.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

/// The abscissa of point k on [-1, 1].
double abscissa(int k, int points) {
  return points == 1 ? 0 : std::cos(std::numbers::pi * k / (points - 1));
}

double value_at(const Scene &scene, const ChebyshevAxis &axis, int k) {
  const double x =
      (axis.lower + axis.upper) / 2 + (axis.upper - axis.lower) / 2 * abscissa(k, axis.points);
  return value_back(scene, axis.parameter, x);
}

/// Of a modulus on [1, 3] the linear coordinate needs 17 points to 1e-9; beyond that the logarithm
/// needs fewer.
bool is_wide(const Parameter &parameter) {
  return parameter.lower > 0 && parameter.upper > 3 * parameter.lower;
}

Vector axis_weights(const Scene &scene, const ChebyshevAxis &axis, double value) {
  const double coordinate = coordinate_at(scene, axis.parameter, value);
  const double x = (2 * coordinate - axis.lower - axis.upper) / (axis.upper - axis.lower);
  Vector weights = Vector::Zero(axis.points);
  for (int k = 0; k < axis.points; ++k) {
    const double distance = x - abscissa(k, axis.points);
    if (std::abs(distance) < 1e-15 || axis.points == 1) {
      weights.setZero();
      weights[k] = 1;
      return weights;
    }
    const double half = k == 0 || k == axis.points - 1 ? 0.5 : 1;
    weights[k] = (k % 2 == 0 ? half : -half) / distance;
  }
  return weights / weights.sum();
}

/// From values at the points of one axis to Chebyshev coefficients: points x points.
Matrix coefficients_of(int points) {
  Matrix result(points, points);
  if (points == 1) return Matrix::Ones(1, 1);
  const int last = points - 1;
  for (int j = 0; j < points; ++j)
    for (int k = 0; k < points; ++k) {
      const double half = (j == 0 || j == last ? 0.5 : 1) * (k == 0 || k == last ? 0.5 : 1);
      result(j, k) = 2 * half / last * std::cos(std::numbers::pi * j * k / last);
    }
  return result;
}

} // namespace

double coordinate_at(const Scene &scene, int parameter, double value) {
  if (const Coordinate *own = coordinate_of(scene, parameter)) return own->of(value);
  return is_wide(scene.parameters.all[parameter]) ? std::log(value) : value;
}

double value_back(const Scene &scene, int parameter, double coordinate) {
  if (const Coordinate *own = coordinate_of(scene, parameter)) return own->back(coordinate);
  return is_wide(scene.parameters.all[parameter]) ? std::exp(coordinate) : coordinate;
}

Index grid_size(const std::vector<ChebyshevAxis> &axes) {
  Index size = 1;
  for (const ChebyshevAxis &axis : axes)
    size *= axis.points;
  return size;
}

std::vector<FullMu> grid_points(const Scene &scene, const std::vector<ChebyshevAxis> &axes,
                                const FullMu &all_parameters) {
  std::vector<FullMu> points{all_parameters};
  for (const ChebyshevAxis &axis : axes) {
    std::vector<FullMu> finer;
    for (const FullMu &mu : points)
      for (int k = 0; k < axis.points; ++k) {
        finer.push_back(mu);
        finer.back()[axis.parameter] = value_at(scene, axis, k);
      }
    points = std::move(finer);
  }
  return points;
}

Vector grid_weights(const Scene &scene, const std::vector<ChebyshevAxis> &axes,
                    const FullMu &all_parameters) {
  Vector weights = Vector::Ones(1);
  for (const ChebyshevAxis &axis : axes) {
    const Vector own = axis_weights(scene, axis, all_parameters[axis.parameter]);
    weights = (own * weights.transpose()).reshaped().eval();
  }
  return weights;
}

Vector chebyshev_tails(const std::vector<ChebyshevAxis> &axes, const Matrix &values) {
  double largest = 0;
  Vector tails = Vector::Zero(std::ssize(axes));
  Index inner = values.cols(), at = 0;
  for (const ChebyshevAxis &axis : axes) { // lines of the grid along this axis
    double &tail = tails[at++];
    inner /= axis.points;
    const Matrix transform = coefficients_of(axis.points).transpose();
    const Index outer = values.cols() / (inner * axis.points);
    for (Index o = 0; o < outer; ++o)
      for (Index i = 0; i < inner; ++i) {
        const auto line = Eigen::seqN(o * axis.points * inner + i, axis.points, inner);
        const Matrix on_line = values(Eigen::all, line);
        const Matrix coefficients = on_line * transform;
        largest = std::max(largest, coefficients.colwise().norm().maxCoeff());
        if (axis.points > 2)
          tail = std::max(tail, coefficients.rightCols(2).colwise().norm().maxCoeff());
        else
          tail = largest;
      }
  }
  return largest == 0 ? tails : Vector(tails / largest);
}

} // namespace rbvi
