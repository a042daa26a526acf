// Niakh (2022): (4.71)-(4.78).
#include "../nitsche_layer.hpp"
#include "rbvi/solve/nitsche.hpp"
#include "reductions.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Adds e_EIM along the terms over other columns, and over those that are the last steps: each term
/// removes what is left at its entry.
void add_errors_over(Matrix others, const std::vector<Index> &converged, const Matrix &values,
                     const std::vector<EntryKey> &keys, const Eim &found, EimErrors &errors) {
  if (others.size() == 0 || found.size() == 0) return;
  const auto largest = [](const auto &columns) { return columns.cwiseAbs().maxCoeff(); };
  const double scale = largest(others), last_scale = largest(others(Eigen::all, converged));
  if (scale == 0) return;
  const Matrix functions =
      values(Eigen::all, found.snapshots) * found.combination.triangularView<Eigen::Upper>();
  errors.validation = {1};
  if (last_scale > 0) errors.converged = {1};
  for (int j = 0; j < found.size(); ++j) {
    const auto entry = std::lower_bound(keys.begin(), keys.end(), found.entries[j]);
    const Eigen::RowVectorXd left = others.row(entry - keys.begin());
    others.noalias() -= functions.col(j) * left;
    errors.validation.push_back(largest(others) / scale);
    if (last_scale > 0)
      errors.converged.push_back(largest(others(Eigen::all, converged)) / last_scale);
  }
}

/// Which steps of Newton's method are taken, and of which operators.
struct Pairs {
  bool ends = false;  ///< of its loops alone
  bool joint = false; ///< B^n + B^tau in place of either
};

/// The operators at each of them.
struct States {
  const Pairs pairs;
  std::array<std::vector<Vector>, 4> values{}; ///< B^n, Theta^n, B^tau, Theta^tau
  std::vector<Index> converged{};              ///< the last steps
};

void add_state(const LayerPattern &pattern, const std::vector<CurveCell> &cells,
               const std::vector<NitscheFace> &faces, const Vector &layer, const Vector &bounds,
               States &states) {
  const Matrix pressures = nitsche_pressures(faces, layer);
  const Vector matrix = pattern.values(cells, nitsche_tangent(faces, pressures, {}));
  const Vector vector = nitsche_residual(faces, layer, {});
  if (!states.pairs.joint) states.values[0].push_back(matrix);
  states.values[1].push_back(vector);
  if (bounds.size() == 0) return;
  states.values[2].push_back(pattern.values(cells, nitsche_tangent(faces, pressures, bounds)));
  if (!states.pairs.joint) states.values[2].back() -= matrix;
  states.values[3].push_back(nitsche_residual(faces, layer, bounds) - vector);
}

States states_at(Problem &problem, NitscheSolver &solver, const LayerPattern &pattern,
                 const std::vector<Mu> &all_mu, const Pairs &pairs) {
  const NitscheLayer layer = layer_of(problem.contact());
  const std::vector<CurveCell> &cells = layer.cells;
  States states{pairs};
  for (const Mu &mu : all_mu) {
    const Operators &op = problem.assemble(mu);
    const std::vector<NitscheFace> faces = nitsche_faces(layer, op.mu, cells);
    (pairs.ends ? solver.loop_end : solver.watch) = [&](const Vector &on_layer,
                                                        const Vector &bounds) {
      add_state(pattern, cells, faces, on_layer, bounds, states);
    };
    const NitscheSolution last = solver.solve(op);
    if (!pairs.ends) add_state(pattern, cells, faces, last.layer, last.bounds, states);
    states.converged.push_back(std::ssize(states.values[1]) - 1);
  }
  return states;
}

} // namespace

void interpolate_terms(Problem &problem, const std::vector<Sample> &samples,
                       const CurveOptions &options, ReducedModel &model, CurveReport &report) {
  NitscheModel &nitsche = *model.contact.nitsche;
  const Matrix &trace = model.contact.trace;
  // The steps as printed; where bounds follow u they cycle without line search, and the end of a
  // loop is the same by any steps.
  const NitscheLayer layer = layer_of(problem.contact());
  const bool friction = layer.friction(), published = friction && options.published_pairs;
  const FullMu first = expand(layer.scene.parameters, samples.front().mu);
  const bool moves = bounds_move(nitsche_faces(layer, first, layer.cells));
  const Pairs pairs{.ends = published && moves, .joint = published && !moves};
  NitscheSolver solver(problem, {.plain_steps = !friction || pairs.joint});
  const LayerPattern pattern(layer.cells);
  const std::vector<Mu> training = parameters_of(samples);
  const States states = states_at(problem, solver, pattern, training, pairs);
  const States others = states_at(problem, solver, pattern, options.eim_validation, pairs);
  report.states = static_cast<int>(states.values[1].size());
  std::vector<EntryKey> dofs;
  for (PetscInt i = 0; i < problem.trace().size; ++i)
    dofs.push_back({i, 0});
  const std::array<LayerTerms *, 4> terms{&nitsche.contact_matrix, &nitsche.contact_vector,
                                          &nitsche.friction_matrix, &nitsche.friction_vector};
  for (std::size_t k = 0; k < (friction ? 4 : 2); ++k) {
    if (states.values[k].empty()) continue; // B^n, where it is in B^tau
    const bool matrix = k % 2 == 0;
    const std::vector<EntryKey> &keys = matrix ? pattern.keys() : dofs;
    const Matrix values = side_by_side(states.values[k]);
    LayerInterpolation found =
        interpolated(values, keys, matrix, options.eim_tolerance, [&](const Vector &column) {
          return matrix ? pattern.projected(column, trace) : Vector(trace.transpose() * column);
        });
    *terms[k] = std::move(found.terms);
    report.eim_errors[k].training = found.eim.error;
    add_errors_over(side_by_side(others.values[k]), others.converged, values, keys, found.eim,
                    report.eim_errors[k]);
  }
}

} // namespace rbvi
