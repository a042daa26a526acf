#include "rbvi/element/scalar_forms.hpp"

#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// A matrix of the nodes of a cell, without a heap.
using CellMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, most_nodes, most_nodes>;

/// What a form needs of triangles and of tetrahedra, made once: make(dim).
template <class Make> auto of_both(const Make &make) {
  return std::array{make(2), make(3)};
}

template <class Data> const Data &of(const std::array<Data, 2> &both, const Cell &cell) {
  return both[static_cast<std::size_t>(cell.dim) - 2];
}

/// int psi_i phi_j over a simplex, relative to its volume: psi of degree `rows`, phi of `columns`.
CellMatrix products(int dim, int rows, int columns) {
  Vector psi(nodes_per_cell(dim, rows)), phi(nodes_per_cell(dim, columns));
  CellMatrix sum = CellMatrix::Zero(psi.size(), phi.size());
  for (const QuadraturePoint &q : simplex_quadrature(dim, rows + columns)) {
    lagrange_values(dim, rows, q.barycentric, {psi.data(), psi.data() + psi.size()});
    lagrange_values(dim, columns, q.barycentric, {phi.data(), phi.data() + phi.size()});
    sum += q.weight * (psi * phi.transpose());
  }
  return sum;
}

/// Exact for products of gradients.
std::vector<QuadraturePoint> gradient_rule(int dim, int degree) {
  return degree == 1 ? simplex_quadrature(dim, 1) : positive_quadrature(dim);
}

/// int grad phi_i . grad phi_j over a simplex, relative to its volume.
CellMatrix stiffness(int dim, int degree, const std::vector<QuadraturePoint> &rule,
                     const Simplex &geometry) {
  std::array<std::array<double, 3>, most_nodes> gradients;
  const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> g(gradients[0].data(), 3,
                                                                     nodes_per_cell(dim, degree));
  CellMatrix sum = CellMatrix::Zero(g.cols(), g.cols());
  for (const QuadraturePoint &q : rule) {
    lagrange_gradients(dim, degree, q.barycentric, geometry, gradients);
    sum += q.weight * g.transpose().lazyProduct(g);
  }
  return sum;
}

void fill(double *values, double scale, const CellMatrix &matrix) {
  for (Index i = 0; i < matrix.size(); ++i)
    values[i] = scale * matrix.data()[i];
}

/// A quadrature point of a cell with the values of its Lagrange functions.
struct LoadPoint {
  QuadraturePoint at;
  Vector values;
};

std::vector<LoadPoint> load_points(int dim, int degree) {
  std::vector<LoadPoint> points;
  for (const QuadraturePoint &q : simplex_quadrature(dim, 5)) {
    points.push_back({q, Vector(nodes_per_cell(dim, degree))});
    Vector &values = points.back().values;
    lagrange_values(dim, degree, q.barycentric, {values.data(), values.data() + values.size()});
  }
  return points;
}

Point mapped_point(const Cell &cell, const QuadraturePoint &point) {
  return point_at(cell.mapped, point.barycentric, cell.dim + 1);
}

std::function<Kernel> body_kernel(const std::function<PointMap> &force, int components, int degree,
                                  bool axisymmetric) {
  check_degree(degree);
  return [=, points = of_both([&](int dim) { return load_points(dim, degree); })](
             const FullMu &mu, const Cell &cell, double *values) {
    const double volume = volume_of(cell.dim, cell.mapped);
    const Index nodes = of(points, cell).front().values.size();
    std::fill_n(values, nodes * components, 0.0);
    for (const LoadPoint &point : of(points, cell)) {
      const Point x = mapped_point(cell, point.at);
      const double weight = volume * point.at.weight * circumference(axisymmetric, x);
      const Point f = weight * force(mu, x);
      for (Index i = 0; i < nodes; ++i)
        for (int c = 0; c < components; ++c)
          values[i * components + c] += point.values[i] * f[c];
    }
  };
}

} // namespace

Form body_load(const std::string &region, const std::function<PointMap> &force, int components,
               int degree, bool axisymmetric) {
  return {region, body_kernel(force, components, degree, axisymmetric)};
}

Form laplace(const std::string &region, int degree) {
  check_degree(degree);
  return {region, [degree, rules = of_both([&](int dim) { return gradient_rule(dim, degree); })](
                      const FullMu &, const Cell &cell, double *values) {
            const Simplex s = simplex(cell.dim, cell.mapped);
            fill(values, s.volume, stiffness(cell.dim, degree, of(rules, cell), s));
          }};
}

Form weighted_product(const std::string &region, const std::function<PointValue> &c, int degree) {
  check_degree(degree);
  return {region, [c, points = of_both([&](int dim) { return load_points(dim, degree); })](
                      const FullMu &mu, const Cell &cell, double *values) {
            const double volume = volume_of(cell.dim, cell.mapped);
            const Index nodes = of(points, cell).front().values.size();
            CellMatrix sum = CellMatrix::Zero(nodes, nodes);
            for (const LoadPoint &point : of(points, cell))
              sum += point.at.weight * c(mu, mapped_point(cell, point.at)) *
                     (point.values * point.values.transpose());
            fill(values, volume, sum);
          }};
}

Form h1_product(double length, int components, int degree) {
  check_degree(degree);
  const auto mass = of_both([&](int dim) { return products(dim, degree, degree); });
  const auto rules = of_both([&](int dim) { return gradient_rule(dim, degree); });
  return {"", [=](const FullMu &, const Cell &cell, double *values) {
            const Simplex s = simplex(cell.dim, cell.reference);
            const CellMatrix product =
                s.volume * (of(mass, cell) +
                            length * length * stiffness(cell.dim, degree, of(rules, cell), s));
            const Index nodes = product.rows(), stride = nodes * components;
            std::fill_n(values, stride * stride, 0.0);
            for (Index i = 0; i < nodes; ++i)
              for (Index j = 0; j < nodes; ++j)
                for (int c = 0; c < components; ++c)
                  values[(i * components + c) * stride + j * components + c] = product(i, j);
          }};
}

Form constant_load(const std::string &region, double value, int degree) {
  check_degree(degree);
  const auto shares = of_both([&](int dim) -> CellMatrix {
    return products(dim, 1, degree).colwise().sum(); // the hats sum to 1
  });
  return {region, [=](const FullMu &, const Cell &cell, double *values) {
            fill(values, value * volume_of(cell.dim, cell.mapped), of(shares, cell));
          }};
}

Form l2_product(const std::string &region) {
  return {region, [mass = of_both([](int dim) { return products(dim, 1, 1); })](
                      const FullMu &, const Cell &cell, double *values) {
            fill(values, volume_of(cell.dim, cell.reference), of(mass, cell));
          }};
}

Form hat_coupling(const std::string &region, double factor, int degree, bool lumped) {
  check_degree(degree);
  const auto entries = of_both([&](int dim) -> CellMatrix {
    if (!lumped) return products(dim, 1, degree);
    return CellMatrix::Identity(dim + 1, nodes_per_cell(dim, degree)) / (dim + 1);
  });
  return {region, [=](const FullMu &, const Cell &cell, double *values) {
            fill(values, factor * volume_of(cell.dim, cell.mapped), of(entries, cell));
          }};
}

Form function_load(const std::string &region, double factor,
                   const std::function<double(const FullMu &, const Point &)> &psi, bool lumped) {
  if (lumped)
    return {region, [factor, psi](const FullMu &mu, const Cell &cell, double *values) {
              const double share = factor * volume_of(cell.dim, cell.mapped) / (cell.dim + 1);
              for (int i = 0; i <= cell.dim; ++i)
                values[i] = share * psi(mu, cell.mapped[i]);
            }};
  return {region,
          [factor, psi, rule = std::array{simplex_quadrature(2, 5), simplex_quadrature(3, 5)}](
              const FullMu &mu, const Cell &cell, double *values) {
            const auto count = static_cast<std::size_t>(cell.dim) + 1;
            const double scale = factor * volume_of(cell.dim, cell.mapped);
            std::fill_n(values, count, 0.0);
            for (const QuadraturePoint &q : rule[count - 3]) {
              const double value = scale * q.weight * psi(mu, mapped_point(cell, q));
              for (std::size_t i = 0; i < count; ++i)
                values[i] += value * q.barycentric[i];
            }
          }};
}

} // namespace rbvi
