// Operators on the contact layer by empirical interpolation (B.36), from a few of their entries.
#pragma once

#include "rbvi/contact/nitsche_curve.hpp"
#include "rbvi/model/model.hpp"

namespace rbvi {

/// Reference abscissa of each Gauss point of the curve: 4 * cells.
Vector point_abscissae(const std::vector<CurveCell> &cells);

/// The sampled entries of one operator, with the cells that they come from.
class SampledLayer {
public:
  /// `terms` must outlive it.
  SampledLayer(const LayerTerms &terms, const std::vector<CurveCell> &cells);
  /// The numbers of the cells that touch the entries: the next two are given the faces of these.
  const std::vector<int> &cells() const { return cells_; }
  /// The J coefficients theta, from the operator on these cells.
  Vector of_blocks(const std::vector<FaceBlock> &blocks) const;
  /// The J coefficients, from a vector on the whole layer to which these cells have contributed.
  Vector of_vector(const Vector &layer) const;

private:
  struct Contribution {
    int entry, cell, row, column;
  };
  /// The J coefficients of J sampled entries.
  Vector coefficients(Vector entries) const;
  const LayerTerms &terms_;
  std::vector<int> cells_;
  std::vector<Contribution> contributions_;
};

/// The items of `all` with these numbers.
template <class Item>
std::vector<Item> selected(const std::vector<Item> &all, const std::vector<int> &numbers) {
  std::vector<Item> result;
  for (const int number : numbers)
    result.push_back(all[number]);
  return result;
}

} // namespace rbvi
