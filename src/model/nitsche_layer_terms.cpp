#include "rbvi/model/nitsche_layer_terms.hpp"

#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>

namespace rbvi {

Vector point_abscissae(const std::vector<CurveCell> &cells) {
  Vector x(4 * static_cast<Index>(cells.size()));
  Index next = 0;
  for (const CurveCell &cell : cells) {
    const auto [i, j] = simplex_edges[cell.edge];
    const double a = cell.cell.reference[i][0], b = cell.cell.reference[j][0];
    for (const EdgePoint &point : edge_quadrature)
      x[next++] = (1 - point.s) * a + point.s * b;
  }
  return x;
}

SampledLayer::SampledLayer(const LayerTerms &terms, const std::vector<CurveCell> &cells)
    : terms_(terms) {
  const bool matrix = !terms.columns.empty();
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto &dofs = cells[k].dofs;
    const auto place_of = [&](int dof) { // 12: the cell does not have it
      return static_cast<int>(std::find(dofs.begin(), dofs.end(), dof) - dofs.begin());
    };
    bool touched = false;
    for (std::size_t e = 0; e < terms.rows.size(); ++e) {
      const int row = place_of(terms.rows[e]), column = matrix ? place_of(terms.columns[e]) : 0;
      if (row == 12 || column == 12) continue;
      if (!touched) cells_.push_back(static_cast<int>(k));
      touched = true;
      contributions_.push_back(
          {static_cast<int>(e), static_cast<int>(cells_.size()) - 1, row, column});
    }
  }
}

Vector SampledLayer::coefficients(Vector entries) const {
  terms_.interpolation.triangularView<Eigen::UnitLower>().solveInPlace(entries);
  return entries;
}

Vector SampledLayer::of_blocks(const std::vector<FaceBlock> &blocks) const {
  Vector entries = Vector::Zero(terms_.size());
  for (const Contribution &c : contributions_)
    entries[c.entry] += blocks[c.cell](c.row, c.column);
  return coefficients(std::move(entries));
}

Vector SampledLayer::of_vector(const Vector &layer) const {
  return coefficients(layer(terms_.rows));
}

} // namespace rbvi
