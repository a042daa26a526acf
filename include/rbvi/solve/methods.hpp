// The methods behind HighFidelity, each on one assembled problem.
#pragma once

#include "rbvi/law/nonlinear/nonlinear.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "rbvi/solve/linear/linear.hpp"
#include "rbvi/solve/linear/scaled_part.hpp"

namespace rbvi {

/// "active_set", "uzawa", "vi".
const std::vector<std::string> &hf_method_names();
/// "auto", "condensed", "eliminated".
const std::vector<std::string> &hf_contact_names();

/// What a method returns: the free displacement over the ranks in place of u, without what is
/// measured on it.
struct MethodResult : HfSolution {
  Handle<Vec> free_u;
  bool converged = false;
};

/// At all dofs in natural order, the imposed values among them. Collective.
Vector whole_displacement(const Problem &problem, const Mu &mu, Vec u);

/// F - B^T lambda. Collective.
Handle<Vec> reaction_rhs(const Trace &trace, const Operators &op, const Vector &lambda);

/// B A^-1 B^T(:, which), dual x which.size(), on every rank: the constraint values that unit
/// multipliers cause. `ksp`: with op.a as its operator. Collective.
Matrix condensed_columns(KSP ksp, const Trace &trace, const Operators &op,
                         const std::vector<Index> &which);

/// E^T A^-1 E of one A, column by column when a contact dof is first asked for, and kept: one
/// factorisation and at most n_c solves for a whole sweep in which B alone changes.
class Compliance {
public:
  /// As condensed_columns. Collective.
  Matrix condensed_columns(KSP ksp, const Trace &trace, const Operators &op,
                           const std::vector<Index> &which);

  Index count() const { return count_; } ///< of the columns that are kept
  /// Makes these columns exist. Collective; with `groups`, which all ask for the same ones, on all
  /// of them, and each solves for its share.
  void require(KSP ksp, const Trace &trace, Mat a, const std::vector<Index> &contact_dofs,
               const Groups *groups = nullptr);
  /// Makes all of them exist, by A's Schur complement on the contact dofs. Collective; with
  /// `groups`, the first makes them for all.
  void require_all(const Trace &trace, Mat a, const Groups *groups = nullptr);
  /// One that was required.
  Eigen::Map<const Vector> column(Index contact_dof) const {
    return {columns_.col(slot_[contact_dof]).data(), columns_.rows()};
  }

  /// For contact that is nodal (contact/interface.hpp).
  std::optional<NodalCompliance> nodal{};

private:
  Matrix columns_; ///< n_c x room
  Index count_ = 0;
  std::vector<Index> slot_; ///< per contact dof: its column, -1 if it has none yet
};

/// `kept`: for a sweep in which A stays the same. Friction by its rule (friction_answer).
MethodResult solve_active_set(KSP ksp, const Trace &trace, const Operators &op, const Start &start,
                              Compliance *kept = nullptr);

/// Active set on a body with a scaled part, set to `op`.
MethodResult solve_active_set(ScaledPart &part, const Operators &op, const Start &start);

/// Contact that follows the displacement: Kacanov's or Newton's iteration on the condensed problem,
/// every step on every rank. `op`: at mu; its contact operators become those of the solution.
/// `steps` tells how it went; `slip`: the history of friction. Throws failure where it does not
/// converge. Collective.
MethodResult solve_following(KSP ksp, const Problem &problem, Compliance &compliance, Operators &op,
                             const Vector &slip, const NonlinearStart &start,
                             const NonlinearOptions &options, NonlinearResult &steps);

/// `f`: the load; `w_product`: over the ranks. Collective.
MethodResult solve_uzawa(KSP ksp, const DualLayout &layout, const DistributedContact &contact,
                         Vec f, Mat w_product, const HfOptions &options);

/// Throws bad_input, saying what to set, unless every interface bounds single nodes (vertex
/// quadrature) without friction.
void require_bounds_at_nodes(const Scene &scene);

/// Needs bounds at nodes, else throws bad_input. Where the displacement is no scalar, the unknowns
/// are those of local frames. Collective.
MethodResult solve_vi(Problem &problem, const DistributedContact &contact, const Operators &op);

/// With all rows of B on every rank, or distributed. Collective.
KktResidual kkt_residual(const Trace &trace, const Operators &op, Vec u, const Vector &lambda);
KktResidual kkt_residual(const DistributedContact &contact, const Operators &op, Vec u, Vec lambda);

/// The nodes with a positive normal multiplier.
std::vector<Index> in_contact(const NodeLaws &laws, const Vector &lambda);

} // namespace rbvi
