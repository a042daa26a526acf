#include "rbvi/method/residual.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double share_of_terms = 1e-5;        ///< round-off of A u: 1e-16 of its terms
constexpr double share_of_displacement = 1e-3; ///< of B u and g: of its terms and what they move

} // namespace

double relative(const Remainder &remainder) {
  if (remainder.left == 0) return 0;
  return remainder.left / larger(remainder.parts, share_of_terms * remainder.terms);
}

double KktResidual::largest() const {
  return rbvi::largest({stationarity, feasibility, complementarity, sign, friction});
}

// A bound far above all stresses is as good as glue: it would turn the round-off of the slip into a
// violation.
ContactSums sums_of(const ContactRemainders &rows) {
  const auto &[laws, weights, g, lambda, excess, displacement, of_all, equations] = rows;
  ContactSums result;
  auto &[penetration, gap, negative, pressure, stress, above] = result.largest;
  auto &[idle, lambda_squared, terms_squared, idle_friction] = result.sums;
  const Vector bounds = bounds_of(laws, lambda);
  Vector terms = g.cwiseAbs().cwiseMax((excess + g).cwiseAbs());
  for (Index i = 0; i < laws.nodes(); ++i) {
    const Index row = laws.normal[i];
    const bool equation = i >= laws.nodes() - equations;
    if (weights[i] > 0) {
      const double beyond = equation ? std::abs(excess[row]) : excess[row];
      penetration = larger(penetration, beyond / weights[i]);
      terms[row] = std::max(terms[row], share_of_displacement * displacement * weights[i]);
      gap = larger(gap, terms[row] / weights[i]);
    }
    if (!equation) negative = larger(negative, -lambda[row]);
    pressure = larger(pressure, std::abs(lambda[row]));
    idle += std::abs(lambda[row] * excess[row]);
    if (!laws.has_tangent(i)) continue;
    const Index first = laws.tangent[i];
    const auto traction = lambda.segment(first, laws.tangents);
    const auto slip = excess.segment(first, laws.tangents);
    above = larger(above, traction.norm() - bounds[i]);
    const double bound = of_all > 0 ? std::min(bounds[i], 2 * of_all) : bounds[i];
    idle_friction += std::abs(bound * slip.norm() - traction.dot(slip));
  }
  stress = lambda.size() > 0 ? lambda.cwiseAbs().maxCoeff() : 0;
  lambda_squared = lambda.squaredNorm();
  terms_squared = terms.squaredNorm();
  return result;
}

KktResidual residual_of(const ContactSums &contact, bool tangents, const Remainder &stationarity) {
  const auto &[penetration, gap, negative, pressure, stress, above] = contact.largest;
  const auto &[idle, lambda_squared, terms_squared, idle_friction] = contact.sums;
  const double scale = std::sqrt(lambda_squared) * std::sqrt(terms_squared);
  KktResidual kkt;
  kkt.stationarity = relative(stationarity);
  kkt.feasibility = relative({penetration, gap});
  kkt.complementarity = relative({idle, scale});
  kkt.sign = relative({larger(0, negative), pressure});
  if (tangents) kkt.friction = larger(relative({above, stress}), relative({idle_friction, scale}));
  return kkt;
}

void check_residual(double residual, double limit, const std::string &advice) {
  if (!(residual <= limit))
    throw failure("the KKT residual is " + short_number(residual) + ", above " +
                  short_number(limit) + advice);
}

double residual_of_laws(const NodeLaws &laws, const Vector &g, const Vector &lambda,
                        const Vector &w, double displacement) {
  if (lambda.size() == 0) return 0;
  const Vector weights = Vector::Ones(laws.nodes()), excess = -w;
  const double stress = lambda.lpNorm<Eigen::Infinity>();
  return residual_of({laws, weights, g, lambda, excess, displacement, stress}, {0, 0}).largest();
}

} // namespace rbvi
