#include "rbvi/mor/reduced_balance.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/fem/body_balance.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

void compare_balance(const Problem &problem, ReducedModel &model) {
  constexpr double allowed = 1e-8; // the residual of a query
  const Scene &scene = problem.scene();
  model.made.histories.erase("self_check/balance");
  if (std::ranges::none_of(scene.outputs, [](const OutputForm &output) {
        return output.kind == OutputForm::Kind::reaction;
      }))
    return;
  std::vector<Mu> set = parse_set(scene.parameters, "random:10:17");
  const std::vector<Mu> boundary = corners_and_faces(scene.parameters);
  set.insert(set.end(), boundary.begin(), boundary.end());
  std::optional<OnlineSolver> solver;
  double worst = 0, largest = 0;
  Mu at;
  for (const Mu &mu : set) {
    const auto forces = forces_on_bodies(problem, expand(scene.parameters, mu));
    collectively(problem.comm(), [&] {
      if (rank_of(problem.comm()) != 0 || forces.empty()) return;
      if (!solver) solver.emplace(model, scene);
      Outputs outputs;
      try {
        outputs = solver->outputs(mu, solver->solve(mu));
      } catch (const Error &) { // as the self-check says
        return;
      }
      for (const BodyForces &one : forces) {
        const auto [left, sizes] = left_of(one, outputs);
        largest = std::max(largest, sizes);
        if (std::abs(left) <= worst) continue;
        worst = std::abs(left);
        at = mu;
      }
    });
  }
  if (worst <= allowed * largest) return;
  std::vector<double> &known = model.made.histories["self_check/balance"];
  known.assign(1, worst / largest);
  known.insert(known.end(), at.begin(), at.end());
}

} // namespace rbvi
