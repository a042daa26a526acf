// High-fidelity solvers at one mu. One result type. Scenes with Nitsche's method:
// solve/nitsche.hpp; the multipliers are then minus the stress at the vertices of the
// curve. The mixed problem: three methods that agree,
//
//   active_set  semismooth Newton on the condensed problem, B A^-1 B^T asked for column by column,
//               with B on every rank: the truth
//   uzawa       lambda <- Proj(lambda + rho (B u - G)), fixed step or accelerated: the baseline
//   vi          SNES with its VI extension on the bound-constrained primal problem, on a support in
//               local frames (scenes with vertex quadrature in b and g: there the constraint is a
//               bound at each node; without friction; never two bodies, whose constraints couple
//               the nodes of both)
//
// Where contact follows the displacement (large deformations), active_set solves each linearised
// problem of Kacanov's or Newton's iteration (method/nonlinear.hpp), which share the columns of
// A^-1.
//
// B, G and the multipliers of uzawa, vi and of active sets by elimination are distributed over the
// ranks; the condensed problem, and with it what reductions need, has them on every rank.
#pragma once

#include "rbvi/core/outputs.hpp"
#include "rbvi/fem/problem.hpp"
#include "rbvi/method/answer.hpp"
#include "rbvi/method/nonlinear.hpp"
#include "rbvi/method/residual.hpp"
#include "rbvi/method/uzawa.hpp"
#include "rbvi/par/groups.hpp"
#include "rbvi/solve/nitsche.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rbvi {

enum class HfMethod { active_set, uzawa, vi };

/// How active_set solves the systems of its sets.
enum class HfContact {
  automatic, ///< by the estimate of solve/contact_cost.hpp; where elimination fails, condensed
  condensed, ///< on the multipliers: columns of B A^-1 B^T
  eliminated ///< on the displacement, without the dofs of the active constraints
};

struct HfOptions {
  HfMethod method = HfMethod::active_set;
  HfContact contact = HfContact::automatic;
  int samples = 1; ///< that are to be solved: what can be kept for them is shared
  UzawaOptions uzawa;
  NonlinearOptions nonlinear; ///< where contact follows the displacement
  NitscheOptions nitsche;
  /// HfSolution::to_other, from further starts: by active sets on the multipliers, at small
  /// deformations.
  bool looks_for_others = false;
};

/// u: in natural order, on every rank, without the motion, with the values that boundaries impose;
/// residual: kkt.largest().
struct HfSolution : Answer {
  Vector slip; ///< the history of friction that it leaves (contact/history.hpp); empty without any
  std::vector<Index> active; ///< normal multipliers in contact
  double to_other = 0; ///< largest distance to another answer that was seen, relative; 0: none
  KktResidual kkt;
  Outputs outputs;
  int columns = 0; ///< active_set: columns of the condensed operator
  /// Where contact follows the displacement: the states at the contact dofs at which its condition
  /// was linearised, that of the solution last.
  std::vector<Vector> states;
  Vector beta; ///< of bodies that contact alone holds: what their springs are relaxed at
};

/// Of bodies that contact alone holds, orthonormal combinations of the free motions that no contact
/// and no friction resists at the mu of `op`: motions x any number. Without a solve. Throws failure
/// where loads push along motions that these cannot hold. `op`: as Problem::assemble() left it,
/// with all rows of B. Collective.
Matrix unresisted_motions(const Problem &problem, const Operators &op);

struct MethodResult;
struct Solved;
class ContactMethod;

/// Solves at many mu; remembers the active sets it has met (with friction the multipliers) and
/// starts from those of the nearest mu, the first time from where a few accelerated Uzawa steps see
/// contact.
class HighFidelity {
public:
  /// Collective. KSP options under -hf_, SNES options under -vi_. Throws bad_input for `vi` with
  /// two bodies, and on a support with friction or without vertex quadrature; for elimination where
  /// contact follows the displacement.
  HighFidelity(Problem &problem, const HfOptions &options);
  ~HighFidelity();
  /// Collective. `mu`: the free parameters. Throws failure, saying what to try, if the method does
  /// not converge; throws bad_input for `vi` on a scene without vertex quadrature. `slip`: the
  /// history of friction that the step starts from, HfSolution::slip of the step before; throws
  /// bad_input where it does not fit, and by Nitsche's method.
  HfSolution solve(const Mu &mu, const Vector &slip = {});
  /// Where A is the same for all mu and several groups of ranks are to solve at those of `set`: the
  /// columns of A^-1 at the nodes that the undeformed bodies do not keep apart there, each group
  /// its share. Does nothing where solves do not keep columns. Collective on all groups.
  void share_columns(const Groups &groups, const std::vector<Mu> &set);
  /// Forgets earlier solutions: the next solve starts cold.
  void forget();

private:
  MethodResult run(const Mu &mu, const Operators &op, const Vector &slip, const Solved *near,
                   bool continues);
  MethodResult run_free(const Mu &mu, const Operators &op, const Vector &slip, const Solved *near);

  Problem &problem_;
  HfOptions options_;
  Handle<KSP> ksp_;
  std::unique_ptr<ContactMethod> method_;
  std::unique_ptr<Starts<Solved>> solved_;
};

} // namespace rbvi
