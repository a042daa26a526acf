#include "rbvi/element/quadrature.hpp"

namespace rbvi {

namespace {

double factorial(int n) {
  return n <= 1 ? 1.0 : n * factorial(n - 1);
}

/// Calls visit(k) for every multi-index of `count` entries >= 0 that sum to `total`.
template <class Visit>
void compositions(std::array<int, 4> &k, int position, int count, int total, Visit &&visit) {
  const auto at = static_cast<std::size_t>(position);
  if (position == count - 1) {
    k[at] = total;
    visit(k);
    return;
  }
  for (k[at] = 0; k[at] <= total; ++k[at])
    compositions(k, position + 1, count, total - k[at], visit);
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
    std::array<int, 4> k{};
    compositions(k, 0, dim + 1, s - i, [&](const std::array<int, 4> &index) {
      QuadraturePoint point{{0, 0, 0, 0}, weight};
      for (int j = 0; j <= dim; ++j)
        point.barycentric[static_cast<std::size_t>(j)] =
            (2.0 * index[static_cast<std::size_t>(j)] + 1) / denominator;
      points.push_back(point);
    });
  }
  return points;
}

} // namespace rbvi
