// What supports along a curve share: the integrals over its edges, which ask at each of their
// points for the normal, the gap and the slip, and the outputs.
#pragma once

#include "rbvi/contact/support/support.hpp"

namespace rbvi {

/// A quadrature point of every edge; the weights sum to 1.
struct TracePoint {
  double s; ///< along the edge, 0 ... 1
  double weight;
  std::array<double, 2> eta; ///< of both multipliers: 1 - s and s
  std::array<double, 3> phi; ///< of the displacements: vertices, middle
};

/// The point of an edge, reference coordinates.
inline Point point_on(const Cell &edge, const TracePoint &at) {
  const Point &begin = edge.reference[0], &end = edge.reference[1];
  return {at.eta[0] * begin[0] + at.eta[1] * end[0], at.eta[0] * begin[1] + at.eta[1] * end[1], 0};
}

/// Length of a mapped edge.
double length_of(const Cell &edge);

class CurveSupport : public EntitySum {
public:
  void integrate(const FullMu &mu, const Cell &edge, EntityValues &values) const override;
  void weigh(const FullMu &, const Cell &edge, EntityValues &values) const override {
    values.weights.setConstant(length_of(edge) / 2);
  }
  FrictionBound bound(const FullMu &mu) const override { return friction_bound(friction_, mu); }
  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override;
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda) override {
    return support_fields(scene_, mu, *this, u, lambda);
  }

protected:
  /// Throws bad_input unless the mesh is a curve with displacements of two components.
  CurveSupport(const Scene &scene, InterfaceMesh mesh, Friction friction, bool lumped);
  /// On which side of the curve the body ends, as the normal of the edge that is nearest to the
  /// support at the values of the scene's parameters says. For the constructors of what has normals.
  void find_side();
  /// At a quadrature point of an edge, x in reference coordinates. `edge`: with its displacement.
  virtual SupportPoint support_at(const FullMu &mu, const Cell &edge, const TracePoint &at,
                                  const Point &x) const = 0;
  /// Its normal alone.
  virtual Point normal_at(const FullMu &mu, const Cell &edge, const TracePoint &at,
                          const Point &x) const = 0;
  /// Whether outputs say if contact reaches the ends of the curve.
  virtual bool counts_ends() const { return true; }
  const std::vector<TracePoint> &points() const { return points_; }

private:
  struct Lift {
    Vector horizontal, vertical; ///< B e_x and B e_y
  };
  Lift lift(const FullMu &mu, const ContactState &state, const Matrix &mapped,
            const Vector &lambda) const;

  Friction friction_;
  std::vector<TracePoint> points_;
  double side_ = 0; ///< 1: the body is above the curve, -1: below, 0: not known
};

} // namespace rbvi
