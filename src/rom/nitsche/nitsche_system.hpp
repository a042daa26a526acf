// The reduced system of Nitsche's method at one mu: a quadratic part and pressures that are affine
// in the coefficients.
#pragma once

#include "rbvi/rom/nitsche/nitsche_solver.hpp"

#include <optional>

namespace rbvi {

constexpr const char *tangent_not_definite = "the reduced tangent is not positive definite: raise "
                                             "-nitsche_gamma0, or reduce again with more "
                                             "training parameters";

struct ReducedNitsche::System {
  /// A cell with some of its points.
  struct Part {
    int cell;
    std::vector<std::pair<int, double>> points; ///< Gauss point, factor of its weight
    Matrix basis;                               ///< n x 12
  };
  std::vector<Part> parts;
  Index points = 0;

  /// Of contact that follows the displacement: the points at rest.
  struct AtRest {
    std::vector<const NitscheFacing *> facing; ///< empty: contact at rest
    FullMu mu;
    std::vector<Point> x, normal;
    Matrix functionals; ///< n x 4 points: of P_n and P_tau without the gap, of u_n, of u_tau
  };

  // At mu.
  Quadratic quadratic;
  std::vector<NitscheLaw> laws; ///< of the points
  bool friction = false;        ///< of some of them
  Matrix functionals;           ///< n x 2 points: of P_n, then (with friction) of P_tau
  Vector offsets;               ///< 2 points
  Vector weights, gamma;
  AtRest at_rest;

  // The last iterate. Where contact follows it, functionals and offsets are of its axes.
  Vector u;
  Matrix along_tau; ///< n x points: of u_tau
  Vector turning;   ///< NitschePoint::turning with the weights
  Matrix pressures; ///< points x 2
  Vector bounds;
  double relative = 0; ///< residual

  /// Points of the curve (4 * cell + Gauss point, in order) with factors of their weights.
  using ChosenPoints = std::vector<std::pair<int, double>>;
  System(const ReducedModel &model, const std::vector<CurveCell> &cells,
         const ChosenPoints &chosen);
  void set_points(const NitscheLayer &layer, const FullMu &all_parameters);
  void set_at_rest(const NitscheLayer &layer, const FullMu &all_parameters);
  void set(const Vector &coefficients);
  void turn_to(const Vector &coefficients);
  /// A derivative of the terms at these pressures, with the weights: of contact, then of friction.
  Vector weighted(double PointTerm::*part, const Matrix &at) const;
  /// Of friction, at these pressures; empty without.
  Vector bounds_at(const Matrix &at) const;
  Vector residual();
  Matrix tangent_at(const Matrix &at) const;
  Vector turning_at(const Matrix &at) const;
  void predict(const Vector &start, const Vector &state);
  int minimise();
  std::optional<int> follow_bound();
  int settle();
};

} // namespace rbvi
