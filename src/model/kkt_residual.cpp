#include "rbvi/method/residual.hpp"
#include "rbvi/model/cone_solver.hpp"

namespace rbvi {

double kkt_residual(const KktTerms &answer) {
  const auto &[au, btx, f, bu, g, x, equations, displacement, stiffness] = answer;
  const NodeLaws laws = uniform_laws(x.size(), 1, {});
  const Vector weights = Vector::Ones(x.size()), excess = bu - g;
  return residual_of(sums_of({laws, weights, g, x, excess, displacement, 0, equations}), false,
                     {(au + btx - f).norm(), f.norm() + btx.norm(), stiffness})
      .largest();
}

} // namespace rbvi
