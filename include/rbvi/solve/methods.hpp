// The methods behind HighFidelity, each on one assembled problem.
#pragma once

#include "rbvi/method/nonlinear.hpp"
#include "rbvi/solve/full_body.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "rbvi/solve/linear.hpp"

namespace rbvi {

/// "active_set", "uzawa", "vi".
const std::vector<std::string> &hf_method_names();
/// "auto", "condensed", "eliminated".
const std::vector<std::string> &hf_contact_names();

/// What a method returns: the free displacement over the ranks in place of u, without what is
/// measured on it.
struct MethodResult : HfSolution {
  Handle<Vec> free_u;
  Vector w;           ///< of solve_active_set: H lambda + q
  Matrix pressures;   ///< of Nitsche's method: NitscheSolution::pressures
  double u_error = 0; ///< FullBody::displacement
  /// Of solve_active_set: how far loads and multipliers move a node apart, |B u_0| + |B (u - u_0)|
  /// over its weight, the largest, with u_0 without multipliers.
  double moved = 0;
  bool converged = false;
};

/// At all dofs in natural order, the imposed values among them. Collective.
Vector whole_displacement(const Problem &problem, const Mu &mu, Vec u);

struct ActiveSetOptions {
  bool by_rule = true;           ///< friction: friction_answer
  bool looks_for_others = false; ///< of HfOptions
  Vector correction{};           ///< is added to q; empty: nothing is
  /// With it, the answer that it is of: the change of its multipliers moves its displacement.
  const MethodResult *refined = nullptr;
  Matrix held{}; ///< with looks_for_others, of bodies that contact alone holds: distance_seen_from
};
/// Active sets on the multipliers of a body that is set to `op`. `start`: FrictionResult::start of
/// a nearby problem; empty: cold. Collective.
MethodResult solve_active_set(FullBody &body, const Operators &op, const Vector &start,
                              const ActiveSetOptions &options = {});

struct FollowingResult {
  MethodResult result;
  NonlinearResult steps; ///< how it went
};
/// Contact that follows the displacement: Kacanov's or Newton's iteration on the condensed problem,
/// every step on every rank. `op`: at mu; its contact operators become those of the solution.
/// `slip`: the history of friction. Throws failure where it does not converge. Collective.
FollowingResult solve_following(FactoredBody &body, const Problem &problem, Operators &op,
                                const Vector &slip, const Start &start,
                                const NonlinearOptions &options);

/// `f`: the load; `w_product`: over the ranks. Collective.
MethodResult solve_uzawa(KSP ksp, const DualLayout &layout, const DistributedContact &contact,
                         Vec f, Mat w_product, const UzawaOptions &options);

/// Throws bad_input, saying what to set, unless every interface bounds single nodes (vertex
/// quadrature) without friction.
void require_bounds_at_nodes(const Scene &scene);

/// Needs bounds at nodes, else throws bad_input. Where the displacement is no scalar, the unknowns
/// are those of local frames. Collective.
MethodResult solve_vi(Problem &problem, const DistributedContact &contact, const Operators &op);

/// With all rows of B on every rank, or distributed. `moved`: MethodResult::moved, where it is
/// known. Collective.
KktResidual kkt_residual(const Trace &trace, const Operators &op, Vec u, const Vector &lambda,
                         double moved = 0);
KktResidual kkt_residual(const DistributedContact &contact, const Operators &op, Vec u, Vec lambda);

/// The nodes with a positive normal multiplier.
std::vector<Index> in_contact(const NodeLaws &laws, const Vector &lambda);

} // namespace rbvi
