#include "rbvi/model/self_check.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/parameter_sets.hpp"

#include <algorithm>

namespace rbvi {

namespace {

void raise(Worst &worst, double value, const Mu &mu) {
  if (worst.at.empty() || !(value <= worst.value)) worst = {value, mu};
}

/// The parameter to the digits that people read.
std::string at(const Worst &worst, const ParameterSpace &space) {
  Mu mu = worst.at;
  for (double &value : mu)
    value = parse_number(short_number(value), "parameter");
  return short_number(worst.value) + " (" + describe(space, mu) + ")";
}

/// Random ones, then those at the boundary of the box.
std::vector<Mu> set_of_check(const ParameterSpace &space, int queries) {
  std::vector<Mu> set = parse_set(space, "random:" + std::to_string(queries) + ":17");
  const std::vector<Mu> boundary = corners_and_faces(space);
  set.insert(set.end(), boundary.begin(), boundary.end());
  return set;
}

} // namespace

std::vector<Mu> parameters_of_check(const ReducedModel &model) {
  return set_of_check(model.scene.parameters, queries_of_check(model));
}

int queries_of_check(const ReducedModel &model) {
  constexpr double most = 200, fewest = 20, quick = 500;
  const double factor = quick / std::max(1, model.primal_size());
  return static_cast<int>(std::clamp(most * factor * factor * factor, fewest, most));
}

SelfCheck self_check(const ReducedModel &model, const Scene &scene, int queries,
                     QueryOptions options, const QueriesAsked &asked) {
  const std::vector<Mu> set = set_of_check(model.scene.parameters, queries);
  SelfCheck check;
  options.only = {"kkt_residual", "max_penetration", "friction_violation", "peak_pressure"};
  OnlineSolver solver(model, scene, options);
  check.queries = static_cast<int>(set.size());
  check.at_boundary = check.queries - queries;
  double peak = 0;
  int done = 0;
  for (const Mu &mu : set) {
    if (asked) asked(done++, check.queries);
    try {
      const ReducedAnswer solution = solver.solve(mu);
      const Outputs outputs = solver.outputs(mu, solution);
      solver.check_forces(solution);
      raise(check.residual, outputs.kkt_residual.value_or(0), mu);
      raise(check.penetration, outputs.max_penetration.value_or(0), mu);
      // By Nitsche's method stresses at nodes exceed the bound by what the mesh leaves of the law.
      if (outputs.friction_violation && model.has_multipliers())
        raise(check.friction, *outputs.friction_violation, mu);
      peak = std::max(peak, outputs.peak_pressure.value_or(0));
      check.scale =
          std::max(check.scale, (model.contact.trace * solution.u).lpNorm<Eigen::Infinity>());
    } catch (const Error &error) {
      if (check.unanswered++ > 0) continue;
      check.unanswered_at = mu;
      check.reason = error.what();
    }
  }
  if (peak > 0) check.friction.value /= peak;
  return check;
}

void print_self_check(std::ostream &out, const SelfCheck &check, const ParameterSpace &space) {
  if (check.queries == 0) {
    out << "not made\n";
    return;
  }
  out << check.queries - check.at_boundary << " random queries and " << check.at_boundary
      << " at corners and faces of the box, ";
  if (check.unanswered == 0)
    out << "all answered";
  else
    out << check.unanswered << " without an answer";
  if (check.unanswered < check.queries)
    out << "; largest residual " << at(check.residual, space) << ", penetration "
        << at(check.penetration, space) << " where displacements of the contact region reach "
        << short_number(check.scale);
  if (!check.friction.at.empty())
    out << ", violation of friction over the peak pressure " << at(check.friction, space);
  out << '\n';
  if (check.unanswered > 0) out << "  no answer at " << check.reason << '\n';
  if (check.unanswered > 0)
    out << "  where rbvi solve has an answer, reduce again with more training parameters (-train); "
           "where it has none either, take a smaller box\n";
  else if (!check.answered())
    out << "  residuals above 1e-10: the laws are met to that only; reduce again with smaller "
           "tolerances, or -multiplier_reduction condensed where the model has another\n";
  if (check.unanswered < check.queries && !check.admissible())
    out << "  bodies penetrate, or friction exceeds its bound, by more than 2 % of these scales: "
           "where rbvi solve does not leave that, too, the model does not know what happens: "
           "reduce "
           "again with more training parameters, or a smaller -eim_tolerance where operators are "
           "interpolated; where it does, refine the mesh\n";
}

} // namespace rbvi
