// The reduced system of Nitsche's method at one mu: a quadratic part and pressures that are affine
// in the coefficients.
#pragma once

#include "rbvi/model/nitsche_solver.hpp"

#include <optional>

namespace rbvi {

constexpr const char *tangent_not_definite = "the reduced tangent is not positive definite: raise "
                                             "-nitsche_gamma0, or reduce again with more "
                                             "training parameters";

/// The rows of the trace for the dofs of a cell, 12 x n.
Matrix basis_on(const CurveCell &cell, const Matrix &trace);

struct ReducedNitsche::System {
  /// A cell with some of its points.
  struct Part {
    int cell;
    std::vector<std::pair<int, double>> points; ///< Gauss point, factor of its weight
    Matrix basis;                               ///< n x 12
  };
  std::vector<Part> parts;
  Index points = 0;

  /// A point of contact that follows the displacement, at rest.
  struct AtRest {
    const Facing *facing;
    PlacedPoint place;
    Point normal;
  };

  // At mu.
  FullMu mu;
  Quadratic quadratic;
  NitscheTerms terms;          ///< of the points
  Matrix functionals;          ///< n x 2 points: of P_n, then (with friction) of P_tau
  Vector offsets;              ///< 2 points
  std::vector<AtRest> at_rest; ///< empty: contact at rest
  Matrix axes_at_rest;         ///< n x 4 points: of P_n and P_tau without the gap, of u_n, of u_tau

  // The last iterate. Where contact follows it, functionals, offsets and turning are of its axes.
  Vector u;
  Matrix along_tau; ///< n x points: of u_tau
  Matrix pressures; ///< points x 2
  Vector bounds;
  double relative = 0; ///< residual

  /// Points of the curve (4 * cell + Gauss point, in order) with factors of their weights.
  using ChosenPoints = std::vector<std::pair<int, double>>;
  System(const ReducedModel &model, const std::vector<CurveCell> &cells,
         const ChosenPoints &chosen);
  /// `whole`: the faces of all cells at rest, where they are known.
  void set_points(const NitscheLayer &layer, const FullMu &all_parameters,
                  const std::vector<NitscheFace> &whole = {});
  void set_offsets(Index point, const FacedPoint &facing);
  void set(const Vector &coefficients);
  void set_bounds() { bounds = terms.bounds_at(pressures); }
  void turn_to(const Vector &coefficients);
  Vector residual();
  Matrix tangent_at(const Matrix &at) const;
  void predict(const Vector &start, const Vector &state);
  int minimise();
  std::optional<int> follow_bound();
  int settle();
};

} // namespace rbvi
