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

const Maker<Traction> pressure_maker{
    "pressure", 1, [](const Record &record) -> std::function<Traction> {
      return [value = number(record, "value")](const FullMu &, const Point &,
                                               const Point &n) -> Point {
        return {-value * n[0], -value * n[1], -value * n[2]};
      };
    }};

const Maker<Kernel> traction_maker{
    "traction_load", 1, [](const Stored &of) {
      return traction_kernel(made<Traction>(part(of, "traction")), integer(of, "components"),
                             integer(of, "degree"), is_set(of, "axisymmetric"));
    }};

const Maker<Kernel> spring_maker{"spring", 1, [](const Record &record) {
                                   return spring_kernel(number(record, "stiffness"),
                                                        integer(record, "components"),
                                                        integer(record, "degree"));
                                 }};

} // namespace

FunctionLibrary facet_functions() {
  return {pressure_maker, traction_maker, spring_maker};
}

Form traction_load(const std::string &boundary, const Named<Traction> &traction, int components,
                   int degree, bool axisymmetric) {
  Form form{
      "",
      traction_maker.named(traction_kernel(traction, components, degree, axisymmetric),
                           {{"components", {double(components)}}, {"degree", {double(degree)}}},
                           {{"traction", traction.record}}),
      boundary};
  if (axisymmetric) form.kernel.record.numbers["axisymmetric"] = {1};
  return form;
}

Form pressure_load(const std::string &boundary, double value, int components, int degree) {
  return traction_load(boundary, pressure_maker({{"value", {value}}}), components, degree);
}

Form spring(const std::string &boundary, double stiffness, int components, int degree) {
  return {"",
          spring_maker({{"stiffness", {stiffness}},
                        {"components", {double(components)}},
                        {"degree", {double(degree)}}}),
          boundary};
}

} // namespace rbvi
