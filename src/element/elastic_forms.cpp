#include "rbvi/element/elastic_forms.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/geometry.hpp"

namespace rbvi {

Form elasticity(const std::string &region, double young, double poisson) {
  if (!(young > 0)) throw bad_input("Young's modulus must be positive, not " + short_number(young));
  if (!(poisson > -1 && poisson < 0.5))
    throw bad_input("Poisson's ratio must lie between -1 and 0.5, not " + short_number(poisson));
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const double shear = young / (2 * (1 + poisson));
  return {region, [lambda, shear](const Mu &, const Cell &cell, double *values) {
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
          }};
}

} // namespace rbvi
