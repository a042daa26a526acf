#include "rbvi/element/facet_forms.hpp"

#include "rbvi/element/facets.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr int exact_to = 5; ///< products of two functions of degree 2, or of one and a traction

/// A point of a facet with the values of its Lagrange functions.
struct FacetPoint {
  std::array<double, 4> barycentric;
  double weight; ///< relative to the size of the facet
  std::vector<double> values;
};

std::vector<FacetPoint> facet_points(int dim, int degree) {
  std::vector<FacetPoint> points;
  const auto nodes = static_cast<std::size_t>(nodes_per_cell(dim - 1, degree));
  for (const QuadraturePoint &q : simplex_quadrature(dim - 1, exact_to)) {
    points.push_back({q.barycentric, q.weight, std::vector<double>(nodes)});
    lagrange_values(dim - 1, degree, q.barycentric, points.back().values);
  }
  return points;
}

/// Of edges and of faces.
std::array<std::vector<FacetPoint>, 2> facet_rules(int degree) {
  check_degree(degree);
  return {facet_points(2, degree), facet_points(3, degree)};
}

std::function<Kernel> traction_kernel(const std::function<Traction> &traction, int components,
                                      int degree, bool axisymmetric) {
  return [traction, axisymmetric, count = static_cast<std::size_t>(components),
          rules = facet_rules(degree)](const FullMu &mu, const Cell &cell, double *values) {
    const std::vector<FacetPoint> &rule = rules[static_cast<std::size_t>(cell.dim) - 2];
    const FacetMeasure facet = facet_measure(cell.dim, cell.mapped);
    const std::size_t nodes = rule.front().values.size();
    std::fill_n(values, nodes * count, 0.0);
    for (const FacetPoint &point : rule) {
      const Point x = point_at(cell.mapped, point.barycentric, cell.dim),
                  t = circumference(axisymmetric, x) * traction(mu, x, facet.normal);
      for (std::size_t i = 0; i < nodes; ++i)
        for (std::size_t c = 0; c < count; ++c)
          values[i * count + c] += facet.size * point.weight * point.values[i] * t[c];
    }
  };
}

std::function<Kernel> spring_kernel(double stiffness, int components, int degree) {
  return [stiffness, count = static_cast<std::size_t>(components),
          rules = facet_rules(degree)](const FullMu &, const Cell &cell, double *values) {
    const std::vector<FacetPoint> &rule = rules[static_cast<std::size_t>(cell.dim) - 2];
    const double size = facet_measure(cell.dim, cell.mapped).size;
    const std::size_t nodes = rule.front().values.size(), stride = nodes * count;
    std::fill_n(values, stride * stride, 0.0);
    for (const FacetPoint &point : rule)
      for (std::size_t i = 0; i < nodes; ++i)
        for (std::size_t j = 0; j < nodes; ++j)
          for (std::size_t c = 0; c < count; ++c)
            values[(i * count + c) * stride + j * count + c] +=
                stiffness * size * point.weight * point.values[i] * point.values[j];
  };
}

} // namespace

Form traction_load(const std::string &boundary, const std::function<Traction> &traction,
                   int components, int degree, bool axisymmetric) {
  return {"", traction_kernel(traction, components, degree, axisymmetric), boundary};
}

Form pressure_load(const std::string &boundary, double value, int components, int degree) {
  const auto pressure = [value](const FullMu &, const Point &, const Point &n) -> Point {
    return {-value * n[0], -value * n[1], -value * n[2]};
  };
  return traction_load(boundary, pressure, components, degree);
}

Form spring(const std::string &boundary, double stiffness, int components, int degree) {
  return {"", spring_kernel(stiffness, components, degree), boundary};
}

} // namespace rbvi
