#include "rbvi/mor/other_answers.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/self_check.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/progress.hpp"

namespace rbvi {

void look_for_other_answers(MPI_Comm comm, ReducedModel &model, const Scene &scene,
                            std::vector<Mu> set) {
  if (!has_friction(scene) || !model.contact.law) return;
  if (set.empty()) set = parameters_of_check(model);
  Vector distances = Vector::Zero(std::ssize(set));
  std::optional<OnlineSolver> solver;
  std::optional<Progress> progress;
  take_turns(comm, set.size(), [&](std::size_t p) {
    if (!solver) solver.emplace(model, scene, QueryOptions{.looks_for_others = true});
    if (rank_of(comm) == 0) {
      if (!progress) progress.emplace("queries for other answers", std::ssize(set), true);
      progress->update(static_cast<int>(p));
    }
    try {
      distances[static_cast<Index>(p)] = solver->solve(set[p]).to_other;
    } catch (const Error &) { // has none
    }
  });
  over_ranks(comm, MPI_SUM, distances);
  Index farthest = 0;
  if (set.empty() || !(distances.maxCoeff(&farthest) > 0)) return;
  std::vector<double> &known = model.made.histories["self_check/other"];
  const Mu &at = set[static_cast<std::size_t>(farthest)];
  known.assign(1, distances[farthest]);
  known.insert(known.end(), at.begin(), at.end());
}

} // namespace rbvi
