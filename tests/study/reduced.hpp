// A reduced model with all that it was made from; of the membrane where no scene is named.
#pragma once

#include "tests/catalogue.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/mor/fields.hpp"
#include "rbvi/mor/reduce.hpp"
#include "rbvi/study/errors.hpp"

namespace rbvi::testing_reduced {

inline std::vector<Sample> solve_all(Problem &problem, const std::vector<Mu> &set) {
  HighFidelity solver(problem, {});
  std::vector<Sample> samples;
  for (const Mu &mu : set)
    samples.push_back(make_sample(mu, solver.solve(mu)));
  return samples;
}

struct Reduced {
  Problem problem;
  std::vector<Sample> samples;
  AffineOperators affine;
  ReducedBases bases;
  ReducedModel model;

  Reduced(const SceneOptions &scene, const std::string &training, const ReduceOptions &options)
      : Reduced(make_scene("membrane_obstacle", scene), training) {
    reduce(options);
  }
  /// The snapshots alone.
  Reduced(const Scene &scene, const std::string &training, MPI_Comm comm = PETSC_COMM_WORLD,
          const MeshOptions &mesh = {})
      : problem(comm, scene, mesh),
        samples(solve_all(problem, parse_set(problem.scene().parameters, training))) {}
  void reduce(const ReduceOptions &options) {
    Reduction made = rbvi::reduce(problem, samples, options);
    affine = std::move(made.affine);
    bases = std::move(made.bases);
    model = std::move(made.model);
    gather_fields(problem, bases.pod.basis, model);
  }
  std::vector<Mu> mus() const {
    std::vector<Mu> set;
    for (const Sample &sample : samples)
      set.push_back(sample.mu);
    return set;
  }
  ModelErrors errors_at(const std::vector<Sample> &truth) {
    return model_errors(model, {}, make_truths(problem, model, truth), problem.w_product());
  }
};

inline ReduceOptions everything() {
  ReduceOptions options;
  options.pod.tolerance = 0;
  options.cone.tolerance = 1e-12;
  options.pga.tolerance = 1e-9;
  options.eim.tolerance = 1e-13;
  return options;
}

} // namespace rbvi::testing_reduced
