#include "rbvi/par/collective.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/vectors.hpp"

namespace rbvi {

namespace {

double largest(Vec u) {
  PetscReal value = 0;
  RBVI_CALL(VecNorm(u, NORM_INFINITY, &value));
  return value;
}

/// At the free dofs of all ranks.
struct Equilibrium {
  Remainder remainder;
  double displacement = 0; ///< ContactRemainders::displacement
};

/// `reaction`: B^T lambda.
Equilibrium equilibrium(const Operators &op, Vec u, Vec reaction) {
  const Handle<Vec> left = like(op.f), diagonal = like(op.f), terms = like(op.f);
  RBVI_CALL(MatMult(op.a, u, left.get()));
  RBVI_CALL(VecAXPY(left.get(), 1, reaction));
  RBVI_CALL(VecAXPY(left.get(), -1, op.f));
  RBVI_CALL(MatGetDiagonal(op.a, diagonal.get()));
  RBVI_CALL(VecPointwiseMult(terms.get(), diagonal.get(), u));
  Equilibrium result{{norm(left.get()), norm(op.f) + norm(reaction), norm(terms.get())}};
  {
    const LocalValues moved(u), load(op.f), force(reaction), stiffness(diagonal.get());
    LocalValues(terms.get()).get() =
        moved.get().array().abs() +
        (load.get().array().abs() + force.get().array().abs()) / stiffness.get().array().abs();
  }
  result.displacement = largest(terms.get());
  return result;
}

} // namespace

KktResidual kkt_residual(const Trace &trace, const Operators &op, Vec u, const Vector &lambda,
                         double moved) {
  const Handle<Vec> reaction = like(op.f);
  RBVI_CALL(VecZeroEntries(reaction.get()));
  const Vector bt_lambda = op.b.transpose() * lambda;
  add_extension(trace, bt_lambda, reaction.get());
  const auto [stationarity, displacement] = equilibrium(op, u, reaction.get());
  const Vector excess = op.b * restrict_to(trace, u) - op.g;
  const double stress = lambda.size() > 0 ? lambda.lpNorm<Eigen::Infinity>() : 0;
  return residual_of(
      {op.laws, op.weights, op.g, lambda, excess, std::max(displacement, moved), stress},
      stationarity);
}

KktResidual kkt_residual(const DistributedContact &contact, const Operators &op, Vec u,
                         Vec lambda) {
  const Handle<Vec> excess = like(lambda), reaction = like(op.f);
  RBVI_CALL(MatMultTranspose(contact.b.get(), lambda, reaction.get()));
  const auto [stationarity, displacement] = equilibrium(op, u, reaction.get());
  RBVI_CALL(MatMult(contact.b.get(), u, excess.get()));
  RBVI_CALL(VecAXPY(excess.get(), -1, contact.g.get()));
  const Vector weights = LocalValues(contact.weights.get()).get()(contact.laws.normal);
  ContactSums sums =
      sums_of({contact.laws, weights, LocalValues(contact.g.get()).get(), LocalValues(lambda).get(),
               LocalValues(excess.get()).get(), displacement, largest(lambda)});
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(lambda));
  over_ranks(comm, MPI_MAX, sums.largest);
  over_ranks(comm, MPI_SUM, sums.sums);
  return residual_of(sums, op.laws.has_tangents(), stationarity);
}

} // namespace rbvi
