#include "nitsche_layer.hpp"

#include "rbvi/model/packed.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr double sum_tolerance = 1e-12; ///< tolerance for what is a sum of few terms

template <class Visit> void visit(const std::array<int, 12> &dofs, const Visit &at) {
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = 0; j < 12; ++j)
      if (dofs[j] >= 0 && dofs[i] >= dofs[j])
        at(dofs[i], dofs[j], static_cast<Index>(i), static_cast<Index>(j));
}

} // namespace

LayerPattern::LayerPattern(const std::vector<CurveCell> &cells) {
  for (const CurveCell &cell : cells)
    visit(cell.dofs, [&](int row, int column, Index, Index) { keys_.push_back({row, column}); });
  std::sort(keys_.begin(), keys_.end());
  keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
}

Vector LayerPattern::values(const std::vector<CurveCell> &cells,
                            const std::vector<FaceBlock> &blocks) const {
  Vector result = Vector::Zero(std::ssize(keys_));
  for (std::size_t k = 0; k < cells.size(); ++k)
    visit(cells[k].dofs, [&](int row, int column, Index i, Index j) {
      const auto found = std::lower_bound(keys_.begin(), keys_.end(), EntryKey{row, column});
      result[found - keys_.begin()] += blocks[k](i, j);
    });
  return result;
}

Vector LayerPattern::projected(const Vector &values, const Matrix &trace) const {
  SparseMatrix lower(trace.rows(), trace.rows());
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < keys_.size(); ++k)
    entries.emplace_back(keys_[k].row, keys_[k].column, values[k]);
  lower.setFromTriplets(entries.begin(), entries.end());
  return pack(trace.transpose() * (lower.selfadjointView<Eigen::Lower>() * trace));
}

LayerInterpolation interpolated(const Matrix &values, const std::vector<EntryKey> &keys,
                                bool matrix, double tolerance,
                                const std::function<Vector(const Vector &)> &project) {
  LayerInterpolation result{{}, eim(MPI_COMM_SELF, values, keys, {.tolerance = tolerance})};
  const Eim &found = result.eim;
  LayerTerms &terms = result.terms;
  terms.interpolation = found.interpolation;
  terms.error = found.error.empty() ? 0 : found.error.back();
  for (const EntryKey &entry : found.entries) {
    terms.rows.push_back(static_cast<int>(entry.row));
    if (matrix) terms.columns.push_back(static_cast<int>(entry.column));
  }
  Matrix taken;
  for (int i = 0; i < found.size(); ++i) {
    const Vector column = project(values.col(found.snapshots[i]));
    if (i == 0) taken.resize(column.size(), found.size());
    taken.col(i) = column;
  }
  if (found.size() > 0) terms.reduced = taken * found.combination.triangularView<Eigen::Upper>();
  return result;
}

Matrix side_by_side(const std::vector<Vector> &columns) {
  Matrix result(columns.empty() ? 0 : columns.front().size(), std::ssize(columns));
  for (std::size_t k = 0; k < columns.size(); ++k)
    result.col(k) = columns[k];
  return result;
}

LayerTerms interpolate_consistency(const NitscheLayer &layer, const std::vector<Sample> &samples,
                                   const Matrix &trace) {
  const LayerPattern pattern(layer.cells);
  std::vector<Vector> values;
  for (const Sample &sample : samples) {
    const auto faces = nitsche_faces(layer, expand(layer.scene.parameters, sample.mu), layer.cells);
    values.push_back(pattern.values(layer.cells, nitsche_consistency(faces)));
  }
  return interpolated(side_by_side(values), pattern.keys(), true, sum_tolerance,
                      [&](const Vector &column) { return pattern.projected(column, trace); })
      .terms;
}

} // namespace rbvi
