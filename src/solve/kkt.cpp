#include "rbvi/core/largest.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/vectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

/// Of the largest displacement: where B u and G are both less, they may be of its round-off.
constexpr double share_of_u = 1e-3;

double largest(Vec u) {
  PetscReal value = 0;
  RBVI_CALL(VecNorm(u, NORM_INFINITY, &value));
  return value;
}

double ratio(double value, double scale) {
  return scale > 0 ? value / scale : value;
}

/// What the residuals of the multipliers are made of, over some nodes or all.
struct DualMeasures {
  /// Largest: penetration; s over the weight; -l_n, |l_n| and |l|; (|l_tau| - bound)_+.
  std::array<double, 6> largest{0, 0, -std::numeric_limits<double>::infinity(), 0, 0, 0};
  /// Sums: |l_n (B u - G)|; |l|^2; s^2; |bound |slip| - l_tau . slip|.
  std::array<double, 4> sums{};
};

/// What both are made of, the largest over all nodes of all ranks.
struct Sizes {
  double displacement, stress;
};

/// `weights`: per node; `excess`: B u - G, in its tangential rows the slip. A bound far above all
/// stresses is as good as glue: it would turn the round-off of the slip into a violation.
DualMeasures measure_dual(const NodeLaws &laws, const Vector &weights, const Vector &g,
                          const Vector &lambda, const Vector &excess, const Sizes &sizes) {
  DualMeasures result;
  auto &[penetration, gap, negative, pressure, stress, above] = result.largest;
  auto &[idle, lambda_squared, terms_squared, idle_friction] = result.sums;
  const Vector bounds = bounds_of(laws, lambda);
  Vector terms = g.cwiseAbs().cwiseMax((excess + g).cwiseAbs());
  for (Index i = 0; i < laws.nodes(); ++i) {
    const Index row = laws.normal[i];
    if (weights[i] > 0) { // a multiplier without weight has no constraint
      penetration = std::max(penetration, excess[row] / weights[i]);
      terms[row] = std::max(terms[row], share_of_u * sizes.displacement * weights[i]);
      gap = std::max(gap, terms[row] / weights[i]);
    }
    negative = std::max(negative, -lambda[row]);
    pressure = std::max(pressure, std::abs(lambda[row]));
    idle += std::abs(lambda[row] * excess[row]);
    if (!laws.has_tangent(i)) continue;
    const Index first = laws.tangent[i];
    const auto traction = lambda.segment(first, laws.tangents);
    const auto slip = excess.segment(first, laws.tangents);
    above = std::max(above, traction.norm() - bounds[i]);
    const double bound = sizes.stress > 0 ? std::min(bounds[i], 2 * sizes.stress) : bounds[i];
    idle_friction += std::abs(bound * slip.norm() - traction.dot(slip));
  }
  stress = lambda.size() > 0 ? lambda.cwiseAbs().maxCoeff() : 0;
  lambda_squared = lambda.squaredNorm();
  terms_squared = terms.squaredNorm();
  return result;
}

KktResidual residual_of(const DualMeasures &dual, bool tangents) {
  const auto &[penetration, gap, negative, pressure, stress, above] = dual.largest;
  const auto &[idle, lambda_squared, terms_squared, idle_friction] = dual.sums;
  const double scale = std::sqrt(lambda_squared) * std::sqrt(terms_squared);
  KktResidual kkt;
  kkt.feasibility = ratio(penetration, gap);
  kkt.complementarity = ratio(idle, scale);
  kkt.sign = std::max(0.0, ratio(negative, pressure));
  if (tangents) kkt.friction = larger(ratio(above, stress), ratio(idle_friction, scale));
  return kkt;
}

/// KktResidual::stationarity. `reaction`: B^T lambda.
double stationarity(const Operators &op, Vec u, Vec reaction) {
  const Handle<Vec> r = like(op.f);
  RBVI_CALL(MatMult(op.a, u, r.get()));
  RBVI_CALL(VecAXPY(r.get(), 1, reaction));
  RBVI_CALL(VecAXPY(r.get(), -1, op.f));
  return ratio(norm(r.get()), norm(op.f) + norm(reaction));
}

} // namespace

double KktResidual::largest() const {
  return rbvi::largest({stationarity, feasibility, complementarity, sign, friction});
}

KktResidual kkt_residual(const Trace &trace, const Operators &op, Vec u, const Vector &lambda) {
  const Vector excess = op.b * restrict_to(trace, u) - op.g;
  const double stress = lambda.size() > 0 ? lambda.lpNorm<Eigen::Infinity>() : 0;
  KktResidual kkt =
      residual_of(measure_dual(op.laws, op.weights, op.g, lambda, excess, {largest(u), stress}),
                  op.laws.has_tangents());
  const Handle<Vec> reaction = like(op.f);
  RBVI_CALL(VecZeroEntries(reaction.get()));
  const Vector bt_lambda = op.b.transpose() * lambda;
  add_extension(trace, bt_lambda, reaction.get());
  kkt.stationarity = stationarity(op, u, reaction.get());
  return kkt;
}

KktResidual kkt_residual(const DistributedContact &contact, const Operators &op, Vec u,
                         Vec lambda) {
  const Handle<Vec> excess = like(lambda), reaction = like(op.f);
  RBVI_CALL(MatMult(contact.b.get(), u, excess.get()));
  RBVI_CALL(VecAXPY(excess.get(), -1, contact.g.get()));
  const Vector weights = LocalValues(contact.weights.get()).get()(contact.laws.normal);
  DualMeasures dual = measure_dual(contact.laws, weights, LocalValues(contact.g.get()).get(),
                                   LocalValues(lambda).get(), LocalValues(excess.get()).get(),
                                   {largest(u), largest(lambda)});
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(lambda));
  over_ranks(comm, MPI_MAX, dual.largest);
  over_ranks(comm, MPI_SUM, dual.sums);
  KktResidual kkt = residual_of(dual, op.laws.has_tangents());
  RBVI_CALL(MatMultTranspose(contact.b.get(), lambda, reaction.get()));
  kkt.stationarity = stationarity(op, u, reaction.get());
  return kkt;
}

} // namespace rbvi
