#include "rbvi/element/axisymmetric_forms.hpp"

#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// What a form sees at a point of a triangle.
struct TurnedPoint {
  std::array<double, most_nodes> values{}; ///< of the nodes
  std::array<std::array<double, 3>, most_nodes> gradients{};
  double radius;

  /// The hoop strain by component c of a node.
  double hoop(int node, int c) const { return c == 0 ? values[node] / radius : 0; }
  /// grad u : grad v by components c and d, the hoop strain among them.
  double gradient_product(int i, int c, int j, int d) const {
    const auto &g = gradients[i], &h = gradients[j];
    return (c == d ? g[0] * h[0] + g[1] * h[1] : 0) + hoop(i, c) * hoop(j, d);
  }
};

/// Integrates density(point, node i, component c, node j, component d). Throws bad_input for a
/// degree other than 1 and 2.
template <class Density> auto turned_integral(int degree, const Density &density) {
  check_degree(degree);
  return [=, rule = radon_quadrature()](const std::array<Point, 4> &vertices, double *values,
                                        const auto &...of_cell) {
    const Simplex geometry = simplex(2, vertices);
    const int nodes = nodes_per_cell(2, degree), dofs = 2 * nodes;
    std::fill_n(values, dofs * dofs, 0.0);
    for (const QuadraturePoint &at : rule) {
      TurnedPoint point;
      const Point x = point_at(vertices, at.barycentric, 3);
      point.radius = x[0];
      lagrange_values(2, degree, {at.barycentric.data(), 3}, point.values);
      lagrange_gradients(2, degree, {at.barycentric.data(), 3}, geometry, point.gradients);
      const double weight = geometry.volume * at.weight * circumference(true, x);
      for (int k = 0; k < dofs; ++k)
        for (int l = 0; l < dofs; ++l)
          values[k * dofs + l] += weight * density(point, k / 2, k % 2, l / 2, l % 2, of_cell...);
    }
  };
}

std::function<Kernel> turned_kernel(const std::function<Material> &material, int degree) {
  const auto integral = turned_integral(degree, [](const TurnedPoint &at, int i, int c, int j,
                                                   int d, const Lame &of_cell) {
    const double divergences =
                     (at.gradients[i][c] + at.hoop(i, c)) * (at.gradients[j][d] + at.hoop(j, d)),
                 crossed = at.gradients[i][d] * at.gradients[j][c] + at.hoop(i, c) * at.hoop(j, d);
    return of_cell.lambda * divergences +
           of_cell.shear * (at.gradient_product(i, c, j, d) + crossed);
  });
  return [=](const FullMu &mu, const Cell &cell, double *values) {
    integral(cell.mapped, values, material(mu, reference_centre(cell)));
  };
}

} // namespace

Form axisymmetric_elasticity(const std::string &region, const std::function<Material> &material,
                             int degree) {
  return {region, turned_kernel(material, degree)};
}

Form axisymmetric_h1_product(double length, int degree) {
  const auto integral =
      turned_integral(degree, [length](const TurnedPoint &at, int i, int c, int j, int d) {
        return (c == d ? at.values[i] * at.values[j] : 0) +
               length * length * at.gradient_product(i, c, j, d);
      });
  return {"", [=](const FullMu &, const Cell &cell, double *values) {
            integral(cell.reference, values);
          }};
}

Sum h1_product_of(const Scene &scene, double length) {
  return {exact_term(scene.axisymmetric ? axisymmetric_h1_product(length, scene.degree)
                                        : h1_product(length, scene.components, scene.degree))};
}

} // namespace rbvi
