#include "rbvi/element/scalar_forms.hpp"

#include "rbvi/element/geometry.hpp"
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

} // namespace

Form laplace(const std::string &region) {
  return {region, [](const Mu &, const Cell &cell, double *values) {
            const Simplex s = simplex(cell.dim, cell.mapped);
            for (int i = 0; i <= cell.dim; ++i)
              for (int j = 0; j <= cell.dim; ++j)
                *values++ = s.volume * s.gradients.row(i).dot(s.gradients.row(j));
          }};
}

Form mass(const std::string &region, Domain domain, double factor, bool lumped) {
  return {region, [domain, factor, lumped](const Mu &, const Cell &cell, double *values) {
            const int dim = cell.dim;
            const double scale = factor * simplex(dim, vertices(cell, domain)).volume;
            for (int i = 0; i <= dim; ++i)
              for (int j = 0; j <= dim; ++j)
                *values++ =
                    scale * (lumped ? (i == j ? 1.0 / (dim + 1) : 0) : mass_entry(dim, i, j));
          }};
}

Form h1_product(double length, int components) {
  return {"", [length, components](const Mu &, const Cell &cell, double *values) {
            const Simplex s = simplex(cell.dim, cell.reference);
            const int stride = (cell.dim + 1) * components;
            std::fill_n(values, stride * stride, 0.0);
            for (int i = 0; i <= cell.dim; ++i)
              for (int j = 0; j <= cell.dim; ++j) {
                const double entry =
                    s.volume * (mass_entry(cell.dim, i, j) +
                                length * length * s.gradients.row(i).dot(s.gradients.row(j)));
                for (int c = 0; c < components; ++c)
                  values[(i * components + c) * stride + j * components + c] = entry;
              }
          }};
}

Form constant_load(const std::string &region, double value) {
  return {region, [value](const Mu &, const Cell &cell, double *values) {
            const double share = value * simplex(cell.dim, cell.mapped).volume / (cell.dim + 1);
            for (int i = 0; i <= cell.dim; ++i)
              *values++ = share;
          }};
}

Form function_load(const std::string &region, double factor,
                   const std::function<double(const Mu &, const Point &)> &psi, bool lumped) {
  if (lumped)
    return {region, [factor, psi](const Mu &mu, const Cell &cell, double *values) {
              const double share = factor * simplex(cell.dim, cell.mapped).volume / (cell.dim + 1);
              for (std::size_t i = 0; i <= static_cast<std::size_t>(cell.dim); ++i)
                values[i] = share * psi(mu, cell.mapped[i]);
            }};
  return {region,
          [factor, psi, rule = std::array{simplex_quadrature(2, 5), simplex_quadrature(3, 5)}](
              const Mu &mu, const Cell &cell, double *values) {
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
