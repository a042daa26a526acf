// How HighFidelity solves contact at one mu: a class for each way, chosen once, with what it keeps
// from one mu to the next.
#pragma once

#include "rbvi/par/groups.hpp"
#include "rbvi/solve/methods.hpp"

#include <memory>
#include <vector>

namespace rbvi {

/// An earlier solution.
struct Solved {
  Start start{};
  Vector beta{};      ///< HfSolution::beta
  Handle<Vec> u{};    ///< Nitsche's method, as the pressures
  Matrix pressures{}; ///< NitscheSolution::pressures
};

/// A problem, and where to start.
struct ContactTask {
  const Mu &mu;
  const Operators &op;
  const Vector &slip;           ///< the history of friction
  const Starts<Solved> &starts; ///< all earlier solutions
  const Solved *near;           ///< the nearest one; null: there is none
  bool continues; ///< it is of the same mu and other springs, and its answer is continued
};

/// All are collective.
class ContactMethod {
public:
  virtual ~ContactMethod() = default;
  /// Before the problem is assembled: the rows of B that this rank wants. Throws bad_input for a
  /// history that it cannot start from.
  virtual ContactRows begin(const Vector &slip) = 0;
  /// A of the next calls.
  virtual void set(const Operators &op) = 0;
  virtual MethodResult solve(const ContactTask &task) = 0;
  /// Throws failure, saying what to try, where more is left of the laws than a solution leaves.
  virtual void check(const MethodResult &) const {}
  /// What later solves start from.
  virtual Solved kept(MethodResult &result) const;
  /// As HighFidelity::share_columns().
  virtual void share_columns(const Groups &, const std::vector<Mu> &) {}
};

/// Throws bad_input for options that do not suit the scene. `ksp`: solves with A, without a matrix.
/// All must outlive it. Collective.
std::unique_ptr<ContactMethod> make_contact_method(Problem &problem, const HfOptions &options,
                                                   KSP ksp);
std::unique_ptr<ContactMethod> make_nitsche_method(Problem &problem, const HfOptions &options);
/// Uzawa's method, or SNES with its VI extension.
std::unique_ptr<ContactMethod> make_distributed_method(Problem &problem, const HfOptions &options,
                                                       KSP ksp);
/// Active sets on the displacement; where that fails, `otherwise`.
std::unique_ptr<ContactMethod> make_elimination(Problem &problem, const HfOptions &options,
                                                std::unique_ptr<ContactMethod> otherwise);

/// `first`; where that leaves more of the laws than a solution does, active sets on the
/// displacement. Multipliers alone place a body that a soft spring holds only as well as their
/// round-off lets the spring.
std::unique_ptr<ContactMethod> make_rescued(Problem &problem, const HfOptions &options,
                                            std::unique_ptr<ContactMethod> first);

/// Sets the outputs, but for what the method itself knows. `weights`: of all normal multipliers.
void measure(const Problem &problem, const Operators &op, const Vector &weights,
             MethodResult &result);
/// Of active sets. Throws failure, saying what to try, where the residual is larger.
void require_residual(const MethodResult &result, double allowed);

} // namespace rbvi
