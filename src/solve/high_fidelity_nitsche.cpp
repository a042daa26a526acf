// HighFidelity by Nitsche's method.
#include "rbvi/solve/high_fidelity.hpp"

#include "rbvi/core/local_fit.hpp"
#include "rbvi/solve/methods.hpp"

namespace rbvi {

Matrix HighFidelity::predicted_pressures(const Mu &mu) const {
  const ParameterSpace &space = problem_.scene().parameters;
  const auto count = std::ssize(solved_);
  Matrix pressures(solved_.front().pressures.size(), count), points(space.size(), count);
  for (Index p = 0; p < count; ++p) {
    const Solved &solved = solved_[p];
    pressures.col(p) = solved.pressures.reshaped();
    points.col(p) = parts_of_box(space, expand(space, solved.mu));
  }
  return local_fit(pressures, points, parts_of_box(space, expand(space, mu)))
      .reshaped(pressures.rows() / 2, 2);
}

HfSolution HighFidelity::solve_nitsche(const Mu &mu, const Operators &op) {
  NitscheStart start{};
  if (!solved_.empty()) start = {nearest(mu)->u.get(), predicted_pressures(mu)};
  NitscheSolution found = nitsche_->solve(op, solved_.empty() ? nullptr : &start);
  const Scene &scene = problem_.scene();
  const NitscheLayer layer = layer_of(problem_.contact());
  HfSolution solution;
  solution.u = whole_displacement(problem_, mu, found.u.get());
  solution.lambda = nitsche_multiplier(layer, op.mu, found.layer);
  nitsche_outputs(layer, op.mu, nitsche_faces(layer, op.mu, layer.cells, found.layer), found.layer,
                  found.pressures, solution.outputs);
  add_named_outputs(problem_, op.mu, solution.u, solution.lambda, solution.outputs);
  solution.kkt.stationarity = found.residual;
  solution.outputs.energy = scene.mirror_images * (found.energy + op.imposed_energy);
  solution.residual = *(solution.outputs.kkt_residual = found.residual);
  solution.outputs.iterations = solution.iterations = found.iterations;
  solution.reason = found.reason + ", " + std::to_string(found.iterations) + " Newton steps in " +
                    std::to_string(found.outer_iterations) + " loops, " +
                    std::to_string(found.factorisations) + " factorisations";
  solved_.push_back({mu, {}, std::move(found.u), std::move(found.pressures)});
  return solution;
}

} // namespace rbvi
