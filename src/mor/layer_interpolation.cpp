#include "layer_interpolation.hpp"

#include "rbvi/rom/packed.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr double exact = 1e-12; ///< tolerance for what is a sum of few terms

/// The entries of the lower triangle of a matrix that is made of blocks of the faces.
class LayerPattern {
public:
  explicit LayerPattern(const std::vector<CurveCell> &cells) {
    for (const CurveCell &cell : cells)
      visit(cell.dofs, [&](int row, int column, Index, Index) { keys_.push_back({row, column}); });
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
  }
  const std::vector<EntryKey> &keys() const { return keys_; }

  Vector values(const std::vector<CurveCell> &cells, const std::vector<FaceBlock> &blocks) const {
    Vector result = Vector::Zero(static_cast<Index>(keys_.size()));
    for (std::size_t k = 0; k < cells.size(); ++k)
      visit(cells[k].dofs, [&](int row, int column, Index i, Index j) {
        const auto found = std::lower_bound(keys_.begin(), keys_.end(), EntryKey{row, column});
        result[found - keys_.begin()] += blocks[k](i, j);
      });
    return result;
  }

  /// trace^T M trace, its lower triangle column by column.
  Vector projected(const Vector &values, const Matrix &trace) const {
    SparseMatrix lower(trace.rows(), trace.rows());
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t k = 0; k < keys_.size(); ++k)
      entries.emplace_back(keys_[k].row, keys_[k].column, values[static_cast<Index>(k)]);
    lower.setFromTriplets(entries.begin(), entries.end());
    return pack(trace.transpose() * (lower.selfadjointView<Eigen::Lower>() * trace));
  }

private:
  template <class Visit> static void visit(const std::array<int, 12> &dofs, const Visit &at) {
    for (std::size_t i = 0; i < 12; ++i)
      for (std::size_t j = 0; j < 12; ++j)
        if (dofs[j] >= 0 && dofs[i] >= dofs[j])
          at(dofs[i], dofs[j], static_cast<Index>(i), static_cast<Index>(j));
  }
  std::vector<EntryKey> keys_;
};

/// `project`: of one column of `values` onto the basis.
template <class Project>
LayerTerms interpolated(const Matrix &values, const std::vector<EntryKey> &keys, bool matrix,
                        const EimOptions &options, const Project &project,
                        std::vector<double> *errors = nullptr) {
  const Eim found = eim(MPI_COMM_SELF, values, keys, options);
  LayerTerms terms;
  terms.interpolation = found.interpolation;
  terms.error = found.error.empty() ? 0 : found.error.back();
  if (errors != nullptr) *errors = found.error;
  for (const EntryKey &entry : found.entries) {
    terms.rows.push_back(static_cast<int>(entry.row));
    if (matrix) terms.columns.push_back(static_cast<int>(entry.column));
  }
  Matrix taken;
  for (int i = 0; i < found.size(); ++i) {
    const Vector column = project(values.col(found.snapshots[static_cast<std::size_t>(i)]));
    if (i == 0) taken.resize(column.size(), found.size());
    taken.col(i) = column;
  }
  terms.reduced = taken * found.combination.triangularView<Eigen::Upper>();
  return terms;
}

/// The states of a sweep from u = 0, and the operators of contact and friction there.
struct Snapshots {
  std::vector<Vector> contact_matrix, contact_vector, friction_matrix, friction_vector;
};

Matrix side_by_side(const std::vector<Vector> &columns) {
  Matrix result(columns.empty() ? 0 : columns.front().size(), static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k)
    result.col(static_cast<Index>(k)) = columns[k];
  return result;
}

/// Adds the operators at one state.
void add_state(const LayerPattern &pattern, const std::vector<CurveCell> &cells,
               const std::vector<NitscheFace> &faces, const Vector &layer, const Vector &bounds,
               Snapshots &snapshots) {
  const Matrix pressures = nitsche_pressures(faces, layer);
  const Vector matrix = pattern.values(cells, nitsche_tangent(faces, pressures, {}));
  const Vector vector = nitsche_residual(faces, layer, {});
  snapshots.contact_matrix.push_back(matrix);
  snapshots.contact_vector.push_back(vector);
  if (bounds.size() == 0) return;
  snapshots.friction_matrix.push_back(
      pattern.values(cells, nitsche_tangent(faces, pressures, bounds)) - matrix);
  snapshots.friction_vector.push_back(nitsche_residual(faces, layer, bounds) - vector);
}

} // namespace

LayerTerms interpolate_consistency(const Scene &scene, const ContactLayer &layer,
                                   const std::vector<Sample> &samples, const Matrix &trace) {
  const LayerPattern pattern(layer.cells);
  const bool friction = scene.support->friction.law != FrictionLaw::none;
  std::vector<Vector> values;
  for (const Sample &sample : samples) {
    const auto faces = nitsche_faces(scene, expand(scene.parameters, sample.mu), layer.cells);
    values.push_back(pattern.values(layer.cells, nitsche_consistency(faces, friction)));
  }
  return interpolated(side_by_side(values), pattern.keys(), true, {.tolerance = exact},
                      [&](const Vector &column) { return pattern.projected(column, trace); });
}

int interpolate_terms(Problem &problem, const std::vector<Sample> &samples,
                      const EimOptions &options, NitscheModel &nitsche,
                      std::array<std::vector<double>, 4> &errors) {
  const Scene &scene = problem.scene();
  // The steps that the reduced solve will take; with friction they can cycle without line search.
  const bool friction = scene.support->friction.law != FrictionLaw::none;
  NitscheSolver solver(problem, {.full_steps = !friction});
  const std::vector<CurveCell> &cells = solver.layer().cells;
  const LayerPattern pattern(cells);
  Snapshots snapshots;
  for (const Sample &sample : samples) {
    const Operators &op = problem.assemble(sample.mu);
    const std::vector<NitscheFace> faces = nitsche_faces(scene, op.mu, cells);
    solver.watch = [&](const Vector &layer, const Vector &bounds) {
      add_state(pattern, cells, faces, layer, bounds, snapshots);
    };
    const NitscheSolution last = solver.solve(op);
    add_state(pattern, cells, faces, last.layer, last.bounds, snapshots);
  }
  std::vector<EntryKey> dofs;
  for (PetscInt i = 0; i < solver.layer().trace.size; ++i)
    dofs.push_back({i, 0});
  const auto matrix = [&](const std::vector<Vector> &values, std::vector<double> &history) {
    if (values.empty()) return LayerTerms{};
    return interpolated(
        side_by_side(values), pattern.keys(), true, options,
        [&](const Vector &column) { return pattern.projected(column, nitsche.trace); }, &history);
  };
  const auto vector = [&](const std::vector<Vector> &values, std::vector<double> &history) {
    if (values.empty()) return LayerTerms{};
    return interpolated(
        side_by_side(values), dofs, false, options,
        [&](const Vector &column) { return Vector(nitsche.trace.transpose() * column); }, &history);
  };
  nitsche.contact_matrix = matrix(snapshots.contact_matrix, errors[0]);
  nitsche.contact_vector = vector(snapshots.contact_vector, errors[1]);
  nitsche.friction_matrix = matrix(snapshots.friction_matrix, errors[2]);
  nitsche.friction_vector = vector(snapshots.friction_vector, errors[3]);
  return static_cast<int>(snapshots.contact_vector.size());
}

} // namespace rbvi
