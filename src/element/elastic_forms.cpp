#include "rbvi/element/elastic_forms.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>

namespace rbvi {

namespace {

using Rule = std::vector<QuadraturePoint>;

void linear_stiffness(const Cell &cell, const Lame &material, double *values) {
  const auto [lambda, shear] = material;
  const int dim = cell.dim;
  const Simplex s = simplex(dim, cell.mapped);
  const auto &g = s.gradients;
  for (int i = 0; i <= dim; ++i)
    for (int c = 0; c < dim; ++c)
      for (int j = 0; j <= dim; ++j) {
        const double both = shear * g.row(i).dot(g.row(j));
        for (int d = 0; d < dim; ++d)
          *values++ = s.volume * (lambda * g(i, c) * g(j, d) + shear * g(i, d) * g(j, c) +
                                  (c == d ? both : 0));
      }
}

/// The gradients are linear: the dim + 1 points of equal weights, exact for their products.
template <int dim>
void quadratic_stiffness(const Cell &cell, const Lame &material, const Rule &rule, double *values) {
  constexpr int nodes = (dim + 1) * (dim + 2) / 2, size = nodes * dim;
  const Simplex s = simplex(dim, cell.mapped);
  Eigen::Matrix<double, size, dim + 1> gradients; // node and direction x point
  std::array<std::array<double, 3>, nodes> at_point;
  for (int q = 0; q <= dim; ++q) {
    lagrange_gradients(dim, 2, rule[q].barycentric, s, at_point);
    for (int i = 0; i < nodes; ++i)
      for (int c = 0; c < dim; ++c)
        gradients(i * dim + c, q) = at_point[i][c];
  }
  const Eigen::Matrix<double, size, size> products = gradients.lazyProduct(gradients.transpose());
  const double weight = s.volume / (dim + 1);
  const double lambda = weight * material.lambda, shear = weight * material.shear;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j) {
      const Eigen::Matrix<double, dim, dim> p = products.template block<dim, dim>(i * dim, j * dim);
      const double both = shear * p.trace();
      for (int c = 0; c < dim; ++c)
        for (int d = 0; d < dim; ++d)
          values[(i * dim + c) * size + j * dim + d] =
              lambda * p(c, d) + shear * p(d, c) + (c == d ? both : 0);
    }
}

std::function<Kernel> elastic_kernel(const std::function<Material> &material, int degree) {
  check_degree(degree);
  if (degree == 1)
    return [material](const FullMu &mu, const Cell &cell, double *values) {
      linear_stiffness(cell, material(mu, reference_centre(cell)), values);
    };
  return [material, triangle = positive_quadrature(2), tetrahedron = positive_quadrature(3)](
             const FullMu &mu, const Cell &cell, double *values) {
    const Lame at_centre = material(mu, reference_centre(cell));
    if (cell.dim == 2)
      quadratic_stiffness<2>(cell, at_centre, triangle, values);
    else
      quadratic_stiffness<3>(cell, at_centre, tetrahedron, values);
  };
}

Lame in_plane_stress(Lame material) {
  auto &[lambda, shear] = material;
  lambda *= 2 * shear / (lambda + 2 * shear);
  return material;
}

Lame lame_of(double young, double poisson, bool plane_stress) {
  const Lame material = lame(young, poisson);
  return plane_stress ? in_plane_stress(material) : material;
}

struct Isotropic {
  std::function<PointValue> young, poisson;
  bool plane_stress;
  Lame operator()(const FullMu &mu, const Point &x) const {
    return lame_of(young(mu, x), poisson(mu, x), plane_stress);
  }
};

struct OfConstants {
  std::function<PointValue> lambda, shear;
  bool plane_stress;
  Lame operator()(const FullMu &mu, const Point &x) const {
    const Lame material{lambda(mu, x), shear(mu, x)};
    if (!(material.shear > 0 && swelling_modulus(material, false) > 0))
      throw bad_input("Lame's constants are lambda = " + short_number(material.lambda) +
                      " and mu = " + short_number(material.shear) +
                      ": mu and 3 lambda + 2 mu must be positive");
    return plane_stress ? in_plane_stress(material) : material;
  }
};

std::function<Kernel> strain_kernel(const std::function<PointValue> &modulus,
                                    const std::function<PointValue> &strain, int dim, int degree,
                                    bool axisymmetric) {
  check_degree(degree);
  return [=, rule = dim == 2 ? radon_quadrature() : simplex_quadrature(3, 5)](
             const FullMu &mu, const Cell &cell, double *values) {
    const Simplex geometry = simplex(dim, cell.mapped);
    const double stiffness = geometry.volume * modulus(mu, reference_centre(cell));
    const int nodes = nodes_per_cell(dim, degree);
    std::fill_n(values, dim * nodes, 0.0);
    std::array<double, most_nodes> functions{};
    std::array<std::array<double, 3>, most_nodes> gradients{};
    for (const QuadraturePoint &at : rule) {
      lagrange_values(dim, degree, at.barycentric, functions);
      lagrange_gradients(dim, degree, at.barycentric, geometry, gradients);
      const Point x = point_at(cell.mapped, at.barycentric, dim + 1);
      const double stress = stiffness * at.weight * circumference(axisymmetric, x) *
                            strain(mu, point_at(cell.reference, at.barycentric, dim + 1));
      for (int i = 0; i < nodes; ++i) {
        if (axisymmetric) gradients[i][0] += functions[i] / x[0];
        for (int c = 0; c < dim; ++c)
          values[dim * i + c] += stress * gradients[i][c];
      }
    }
  };
}

} // namespace

Lame lame(double young, double poisson) {
  if (!(young > 0)) throw bad_input("Young's modulus must be positive, not " + short_number(young));
  if (!(poisson > -1 && poisson < 0.5))
    throw bad_input("Poisson's ratio must lie between -1 and 0.5, not " + short_number(poisson));
  return {young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))};
}

Form elasticity(const std::string &region, const Lame &material, int degree) {
  return elasticity(region, everywhere(material), degree);
}

Form elasticity(const std::string &region, const std::function<Material> &material, int degree) {
  return {region, elastic_kernel(material, degree)};
}

std::function<Material> isotropic(const std::function<PointValue> &young,
                                  const std::function<PointValue> &poisson, bool plane_stress) {
  return Isotropic{young, poisson, plane_stress};
}

std::function<Material> of_lame(const std::function<PointValue> &lambda,
                                const std::function<PointValue> &shear, bool plane_stress) {
  return OfConstants{lambda, shear, plane_stress};
}

double swelling_modulus(const Lame &material, bool plane_stress) {
  return (plane_stress ? 2 : 3) * material.lambda + 2 * material.shear;
}

bool is_plane_stress(const std::function<Material> &material) {
  const auto *isotropic = material.target<Isotropic>();
  const auto *constants = material.target<OfConstants>();
  return (isotropic != nullptr && isotropic->plane_stress) ||
         (constants != nullptr && constants->plane_stress);
}

Form strain_load(const std::string &region, const std::function<PointValue> &modulus,
                 const std::function<PointValue> &strain, int dim, int degree, bool axisymmetric) {
  return {region, strain_kernel(modulus, strain, dim, degree, axisymmetric)};
}

std::function<Material> lambda_alone(const std::function<PointValue> &factor) {
  return [factor](const FullMu &mu, const Point &x) { return Lame{factor(mu, x), 0}; };
}

std::function<Material> shear_alone(const std::function<PointValue> &factor) {
  return [factor](const FullMu &mu, const Point &x) { return Lame{0, factor(mu, x)}; };
}

std::function<Coefficient> lame_lambda(const std::function<Coefficient> &poisson,
                                       bool plane_stress) {
  return [=](const FullMu &mu) { return lame_of(1, poisson(mu), plane_stress).lambda; };
}

std::function<Coefficient> lame_shear(const std::function<Coefficient> &poisson) {
  return [poisson](const FullMu &mu) { return lame_of(1, poisson(mu), false).shear; };
}

} // namespace rbvi
