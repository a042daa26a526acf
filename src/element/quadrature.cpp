#include "rbvi/element/quadrature.hpp"

#include <cmath>

namespace rbvi {

namespace {

double factorial(int n) {
  return n <= 1 ? 1.0 : n * factorial(n - 1);
}

/// Every multi-index of dim + 1 entries >= 0 (the rest zero) that sum to `total`.
std::vector<std::array<int, 4>> compositions(int dim, int total) {
  std::vector<std::array<int, 4>> all;
  for (int i = 0; i <= total; ++i)
    for (int j = 0; i + j <= total; ++j)
      for (int k = 0; k <= (dim >= 2 ? total - i - j : 0); ++k) {
        const int rest = total - i - j - k;
        if (rest == 0 || dim == 3) all.push_back({i, j, k, rest});
      }
  return all;
}

} // namespace

std::vector<QuadraturePoint> simplex_quadrature(int dim, int degree) {
  const int s = degree <= 1 ? 0 : degree / 2;
  const int d = 2 * s + 1;
  std::vector<QuadraturePoint> points;
  for (int i = 0; i <= s; ++i) {
    const int denominator = d + dim - 2 * i;
    double weight =
        factorial(dim) * (i % 2 == 0 ? 1 : -1) / (factorial(i) * factorial(d + dim - i));
    for (int power = 0; power < 2 * s; ++power)
      weight /= 2;
    for (int power = 0; power < d; ++power)
      weight *= denominator;
    for (const std::array<int, 4> &k : compositions(dim, s - i)) {
      QuadraturePoint point{{0, 0, 0, 0}, weight};
      for (int j = 0; j <= dim; ++j)
        point.barycentric[j] = (2.0 * k[j] + 1) / denominator;
      points.push_back(point);
    }
  }
  return points;
}

std::vector<QuadraturePoint> positive_quadrature(int dim) {
  const double far = (1 - 1 / std::sqrt(dim + 2.0)) / (dim + 1), near = 1 - dim * far;
  std::vector<QuadraturePoint> points;
  for (int i = 0; i <= dim; ++i) {
    QuadraturePoint point{{0, 0, 0, 0}, 1.0 / (dim + 1)};
    for (int j = 0; j <= dim; ++j)
      point.barycentric[j] = i == j ? near : far;
    points.push_back(point);
  }
  return points;
}

std::vector<QuadraturePoint> radon_quadrature() {
  const double root = std::sqrt(15.0);
  std::vector<QuadraturePoint> points{{{1.0 / 3, 1.0 / 3, 1.0 / 3, 0}, 9.0 / 40}};
  for (const double sign : {-1.0, 1.0}) {
    const double near = (6 + sign * root) / 21;
    for (std::size_t i = 0; i < 3; ++i) {
      QuadraturePoint point{{near, near, near, 0}, (155 + sign * root) / 1200};
      point.barycentric[i] = 1 - 2 * near;
      points.push_back(point);
    }
  }
  return points;
}

} // namespace rbvi
