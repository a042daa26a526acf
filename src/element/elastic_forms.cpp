#include "rbvi/element/elastic_forms.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

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

const Maker<Kernel> elasticity_maker{"elasticity", 1, [](const Stored &of) {
                                       return elastic_kernel(made<Material>(part(of, "material")),
                                                             integer(of, "degree"));
                                     }};

Lame lame_of(double young, double poisson, bool plane_stress) {
  Lame material = lame(young, poisson);
  auto &[lambda, shear] = material;
  if (plane_stress) lambda *= 2 * shear / (lambda + 2 * shear);
  return material;
}

const Maker<Material> isotropic_maker{
    "isotropic", 1, [](const Stored &of) -> std::function<Material> {
      return [young = made<PointValue>(part(of, "young")),
              poisson = made<PointValue>(part(of, "poisson")),
              plane_stress = number(of, "plane_stress") != 0](const FullMu &mu, const Point &x) {
        return lame_of(young(mu, x), poisson(mu, x), plane_stress);
      };
    }};

std::function<Material> alone(const std::function<PointValue> &factor, bool shear) {
  return [=](const FullMu &mu, const Point &x) {
    const double value = factor(mu, x);
    return shear ? Lame{0, value} : Lame{value, 0};
  };
}

const Maker<Material> alone_maker{"lame_alone", 1, [](const Stored &of) {
                                    return alone(made<PointValue>(part(of, "factor")),
                                                 number(of, "shear") != 0);
                                  }};

Named<Material> named_alone(const Named<PointValue> &factor, bool shear) {
  return alone_maker.named(alone(factor, shear), {{"shear", {double(shear)}}},
                           {{"factor", factor.record}});
}

/// One of Lame's constants.
Maker<Coefficient> lame_maker(const std::string &name, double Lame::*constant) {
  return {name, 2, [constant](const Stored &of) -> std::function<Coefficient> {
            return [=, poisson = made<Coefficient>(part(of, "poisson")),
                    plane_stress = number(of, "plane_stress") != 0](const FullMu &mu) {
              return lame_of(1, poisson(mu), plane_stress).*constant;
            };
          }};
}

const Maker<Coefficient> lambda_maker = lame_maker("lame_lambda", &Lame::lambda),
                         shear_maker = lame_maker("lame_shear", &Lame::shear);

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

Form elasticity(const std::string &region, const Named<Material> &material, int degree) {
  return {region,
          elasticity_maker.named(elastic_kernel(material, degree), {{"degree", {double(degree)}}},
                                 {{"material", material.record}})};
}

Named<Material> isotropic(const Named<PointValue> &young, const Named<PointValue> &poisson,
                          bool plane_stress) {
  return isotropic_maker.named(
      [=](const FullMu &mu, const Point &x) {
        return lame_of(young(mu, x), poisson(mu, x), plane_stress);
      },
      {{"plane_stress", {double(plane_stress)}}},
      {{"young", young.record}, {"poisson", poisson.record}});
}

bool is_plane_stress(const Named<Material> &material) {
  const auto found = material.record.numbers.find("plane_stress");
  return found != material.record.numbers.end() && found->second.front() != 0;
}

Named<Material> lambda_alone(const Named<PointValue> &factor) {
  return named_alone(factor, false);
}

Named<Material> shear_alone(const Named<PointValue> &factor) {
  return named_alone(factor, true);
}

Named<Coefficient> lame_lambda(const Named<Coefficient> &poisson, bool plane_stress) {
  return lambda_maker.named(
      [=](const FullMu &mu) { return lame_of(1, poisson(mu), plane_stress).lambda; },
      {{"plane_stress", {double(plane_stress)}}}, {{"poisson", poisson.record}});
}

Named<Coefficient> lame_shear(const Named<Coefficient> &poisson) {
  return shear_maker.named([=](const FullMu &mu) { return lame_of(1, poisson(mu), false).shear; },
                           {{"plane_stress", {0}}}, {{"poisson", poisson.record}});
}

FunctionLibrary elastic_functions() {
  return {elasticity_maker, isotropic_maker, alone_maker, lambda_maker, shear_maker};
}

} // namespace rbvi
