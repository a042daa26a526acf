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

/// One of Lame's constants.
Maker<Coefficient> lame_maker(const std::string &name, double Lame::*constant) {
  return {name, 1, [constant](const Record &record) -> std::function<Coefficient> {
            const double young = number(record, "young");
            const auto index = static_cast<std::size_t>(integer(record, "poisson_ratio"));
            return [=](const FullMu &mu) { return lame(young, mu.at(index)).*constant; };
          }};
}

const Maker<Coefficient> lambda_maker = lame_maker("lame_lambda", &Lame::lambda),
                         shear_maker = lame_maker("lame_shear", &Lame::shear);

Named<Coefficient> lame_of(const Maker<Coefficient> &maker, double young, int poisson_ratio) {
  return maker({{"young", {young}}, {"poisson_ratio", {double(poisson_ratio)}}});
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

Form elasticity(const std::string &region, const Named<Material> &material, int degree) {
  return {region,
          elasticity_maker.named(elastic_kernel(material, degree), {{"degree", {double(degree)}}},
                                 {{"material", material.record}})};
}

Named<Coefficient> lame_lambda(double young, int poisson_ratio) {
  return lame_of(lambda_maker, young, poisson_ratio);
}

Named<Coefficient> lame_shear(double young, int poisson_ratio) {
  return lame_of(shear_maker, young, poisson_ratio);
}

FunctionLibrary elastic_functions() {
  return {elasticity_maker, lambda_maker, shear_maker};
}

} // namespace rbvi
