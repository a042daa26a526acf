// Operators on the contact layer by empirical interpolation.
#pragma once

#include "rbvi/model/nitsche_layer_terms.hpp"
#include "rbvi/mor/eim.hpp"
#include "rbvi/sweep/sweep.hpp"

#include <functional>

namespace rbvi {

/// The entries of the lower triangle of a matrix that is made of blocks of the faces.
class LayerPattern {
public:
  explicit LayerPattern(const std::vector<CurveCell> &cells);
  const std::vector<EntryKey> &keys() const { return keys_; }
  /// In the order of keys().
  Vector values(const std::vector<CurveCell> &cells, const std::vector<FaceBlock> &blocks) const;
  /// trace^T M trace, its lower triangle column by column.
  Vector projected(const Vector &values, const Matrix &trace) const;

private:
  std::vector<EntryKey> keys_;
};

struct LayerInterpolation {
  LayerTerms terms;
  Eim eim;
};

/// Of columns of `values` at `keys`, the entries of a matrix or of a vector; `project`: of one
/// column onto the basis.
LayerInterpolation interpolated(const Matrix &values, const std::vector<EntryKey> &keys,
                                bool matrix, double tolerance,
                                const std::function<Vector(const Vector &)> &project);

Matrix side_by_side(const std::vector<Vector> &columns);

/// a_gamma - a over the training parameters, exact but for round-off where it is a sum of few
/// terms. `trace`: contact dofs x n.
LayerTerms interpolate_consistency(const NitscheLayer &layer, const std::vector<Sample> &samples,
                                   const Matrix &trace);

} // namespace rbvi
