#include "rbvi/element/scalar_forms.hpp"

#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

const std::array<Point, 4> &vertices(const Cell &cell, Domain domain) {
  return domain == Domain::mapped ? cell.mapped : cell.reference;
}

/// int phi_i phi_j over a simplex, relative to its volume (P1).
double mass_entry(int dim, int i, int j) {
  return (i == j ? 2.0 : 1.0) / ((dim + 1) * (dim + 2));
}

/// A matrix of all nodes of a cell, without a heap.
using CellMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_nodes, most_nodes>;

/// What the H1 product needs of every simplex of one dimension.
struct ScalarCell {
  int dim, degree;
  CellMatrix mass;                   ///< relative to the volume
  std::vector<QuadraturePoint> rule; ///< for products of gradients
};

ScalarCell scalar_cell(int dim, int degree) {
  const Index nodes = nodes_per_cell(dim, degree);
  ScalarCell cell{dim, degree, CellMatrix::Zero(nodes, nodes),
                  degree == 1 ? simplex_quadrature(dim, 1) : positive_quadrature(dim)};
  if (degree == 1) {
    for (int i = 0; i <= dim; ++i)
      for (int j = 0; j <= dim; ++j)
        cell.mass(i, j) = mass_entry(dim, i, j);
    return cell;
  }
  Vector phi(nodes);
  for (const QuadraturePoint &q : simplex_quadrature(dim, 5)) {
    lagrange_values(dim, degree, q.barycentric, {phi.data(), phi.data() + nodes});
    cell.mass += q.weight * phi * phi.transpose();
  }
  return cell;
}

/// int grad phi_i . grad phi_j over a simplex, relative to its volume.
CellMatrix stiffness(const ScalarCell &cell, const Simplex &geometry) {
  std::array<std::array<double, 3>, most_nodes> gradients;
  const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> g(gradients[0].data(), 3,
                                                                     cell.mass.rows());
  CellMatrix sum = CellMatrix::Zero(g.cols(), g.cols());
  for (const QuadraturePoint &q : cell.rule) {
    lagrange_gradients(cell.dim, cell.degree, q.barycentric, geometry, gradients);
    sum += q.weight * g.transpose().lazyProduct(g);
  }
  return sum;
}

} // namespace

Form laplace(const std::string &region) {
  return {region, [](const FullMu &, const Cell &cell, double *values) {
            const Simplex s = simplex(cell.dim, cell.mapped);
            for (int i = 0; i <= cell.dim; ++i)
              for (int j = 0; j <= cell.dim; ++j)
                *values++ = s.volume * s.gradients.row(i).dot(s.gradients.row(j));
          }};
}

Form mass(const std::string &region, Domain domain, double factor, bool lumped) {
  return {region, [domain, factor, lumped](const FullMu &, const Cell &cell, double *values) {
            const int dim = cell.dim;
            const double scale = factor * simplex(dim, vertices(cell, domain)).volume;
            for (int i = 0; i <= dim; ++i)
              for (int j = 0; j <= dim; ++j)
                *values++ =
                    scale * (lumped ? (i == j ? 1.0 / (dim + 1) : 0) : mass_entry(dim, i, j));
          }};
}

Form h1_product(double length, int components, int degree) {
  check_degree(degree);
  return {
      "", [length, components, cells = std::array{scalar_cell(2, degree), scalar_cell(3, degree)}](
              const FullMu &, const Cell &cell, double *values) {
        const ScalarCell &scalar = cells[static_cast<std::size_t>(cell.dim) - 2];
        const Simplex s = simplex(cell.dim, cell.reference);
        const CellMatrix gradients = stiffness(scalar, s);
        const Index nodes = gradients.rows(), stride = nodes * components;
        std::fill_n(values, stride * stride, 0.0);
        for (Index i = 0; i < nodes; ++i)
          for (Index j = 0; j < nodes; ++j) {
            const double entry = s.volume * (scalar.mass(i, j) + length * length * gradients(i, j));
            for (int c = 0; c < components; ++c)
              values[(i * components + c) * stride + j * components + c] = entry;
          }
      }};
}

Form constant_load(const std::string &region, double value) {
  return {region, [value](const FullMu &, const Cell &cell, double *values) {
            const double share = value * simplex(cell.dim, cell.mapped).volume / (cell.dim + 1);
            for (int i = 0; i <= cell.dim; ++i)
              *values++ = share;
          }};
}

Form function_load(const std::string &region, double factor,
                   const std::function<double(const FullMu &, const Point &)> &psi, bool lumped) {
  if (lumped)
    return {region, [factor, psi](const FullMu &mu, const Cell &cell, double *values) {
              const double share = factor * simplex(cell.dim, cell.mapped).volume / (cell.dim + 1);
              for (std::size_t i = 0; i <= static_cast<std::size_t>(cell.dim); ++i)
                values[i] = share * psi(mu, cell.mapped[i]);
            }};
  return {region,
          [factor, psi, rule = std::array{simplex_quadrature(2, 5), simplex_quadrature(3, 5)}](
              const FullMu &mu, const Cell &cell, double *values) {
            const auto count = static_cast<std::size_t>(cell.dim) + 1;
            const double scale = factor * simplex(cell.dim, cell.mapped).volume;
            std::fill_n(values, count, 0.0);
            for (const QuadraturePoint &q : rule[count - 3]) {
              Point x{};
              for (std::size_t i = 0; i < count; ++i)
                for (std::size_t c = 0; c < 3; ++c)
                  x[c] += q.barycentric[i] * cell.mapped[i][c];
              const double value = scale * q.weight * psi(mu, x);
              for (std::size_t i = 0; i < count; ++i)
                values[i] += value * q.barycentric[i];
            }
          }};
}

} // namespace rbvi
