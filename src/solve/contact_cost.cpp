#include "rbvi/solve/contact_cost.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/complement.hpp"
#include "rbvi/solve/scaled_part.hpp"

#include <cmath>

namespace rbvi {

namespace {

// In linear solves with one right-hand side and a factor that is there. Measured at f974b3f, by
// -hf_contact condensed and eliminated on membranes, disks on a support and two disks of 4 000 to
// 230 000 dofs.
constexpr double one_column = 0.4;        ///< a column of A^-1, many being solved for at once
constexpr double factorisation = 75;      ///< a sparse Cholesky factorisation in two dimensions
constexpr double krylov_steps = 60;       ///< all sets of a solve that starts from a neighbour
constexpr double steps_of_a_set = 20;     ///< one set of a solve that starts from nothing
constexpr double first_uzawa_steps = 400; ///< the steps that first tell where contact is
constexpr double worth_changing = 0.6;    ///< elimination is taken below this part of condensation
constexpr PetscInt small = 10000;         ///< dofs: smaller problems are condensed in any case

} // namespace

namespace {

bool by_complement(const Problem &problem) {
  return constant_stiffness(problem.scene()) &&
         takes_complement(problem, problem.trace().size / 2.0);
}

/// Which the first rank makes, where factors are those of all.
double complement(const Problem &problem) {
  const double ranks = ranks_of(problem.comm());
  return complement_cost(problem.dofs().total_free, problem.trace().size) * 2 * ranks / (1 + ranks);
}

} // namespace

ContactCost contact_cost(const Problem &problem, int samples) {
  const auto nodes = static_cast<double>(problem.contact().nodes());
  const auto dofs = static_cast<double>(problem.dofs().total_free);
  const double count = std::max(1, samples);
  const double columns = one_column * nodes / 2; // a half of them touches
  const double dense = std::pow(nodes / 3, 3) / (160 * dofs);
  const bool kept = constant_stiffness(problem.scene());
  // From nothing, the sets move by a layer of nodes a step.
  const double first = problem.refinements() > 0 ? 40 : steps_of_a_set * std::sqrt(nodes);
  ContactCost cost;
  if (by_complement(problem))
    cost.condensed = (factorisation + complement(problem)) / count + dense;
  else
    cost.condensed = (kept ? columns / count : columns) + first_uzawa_steps / count + dense;
  cost.eliminated = factorisation + krylov_steps + first / count;
  return cost;
}

bool takes_complement(const Problem &problem, double columns) {
  return complement_pays(problem.dofs().total_free, problem.trace().size, columns, true) &&
         solves_directly("hf_");
}

bool eliminates(const Problem &problem, const HfOptions &options) {
  if (options.method != HfMethod::active_set || follows_state(problem.contact()) ||
      !has_multipliers(problem.scene()))
    return false;
  if (options.contact != HfContact::automatic) return options.contact == HfContact::eliminated;
  if (problem.dofs().total_free < small) return false;
  if (options.samples > 2 && ScaledPart::fits(problem.scene())) return false;
  const ContactCost cost = contact_cost(problem, options.samples);
  return cost.eliminated < (by_complement(problem) ? 1 : worth_changing) * cost.condensed;
}

std::string contact_cost_text(const Problem &problem, const HfOptions &options) {
  if (options.contact == HfContact::automatic && problem.dofs().total_free < small)
    return "condensed: there are fewer than " + std::to_string(small) + " dofs (-hf_contact)";
  const ContactCost cost = contact_cost(problem, options.samples);
  const std::string how = eliminates(problem, options) ? "eliminated"
                          : by_complement(problem)     ? "condensed by a Schur complement"
                                                       : "condensed";
  return how + (": an estimate of " + formatted("%.0f", cost.condensed) +
                " solves with A for a sample condensed, of " + formatted("%.0f", cost.eliminated) +
                " eliminated (-hf_contact)");
}

} // namespace rbvi
