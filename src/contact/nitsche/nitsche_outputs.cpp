#include "rbvi/contact/nitsche/nitsche_curve.hpp"
#include "rbvi/contact/support/support_outputs.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Force on the body, and lengths of contact and of stick.
struct Sums {
  double normal = 0, tangential = 0, vertical = 0, contact = 0, stick = 0;
  /// Contact pressure averaged over each edge. It balances the other forces there, whereas sigma_n
  /// overshoots beside a kink.
  Vector edge_pressures;
};

/// The y component of a unit vector, from the functionals of the displacement along it: shape
/// functions sum to one.
double vertical(const NitschePoint::Row &row) {
  double sum = 0;
  for (Index i = 1; i < row.size(); i += 2)
    sum += row[i];
  return sum;
}

Sums integrate(const std::vector<NitscheFace> &faces, const Matrix &pressures,
               const Vector &bounds) {
  Sums sums;
  sums.edge_pressures.resize(static_cast<Index>(faces.size()));
  Index number = 0, edge = 0;
  for (const NitscheFace &face : faces) {
    double force = 0, length = 0;
    for (const NitschePoint &point : face.points) {
      const double pressure = std::max(0.0, -pressures(number, 0)), shear = pressures(number, 1);
      const double bound = bounds.size() > 0 ? bounds[number] : 0;
      const double held = std::clamp(shear, -bound, bound);
      force += point.weight * pressure;
      sums.tangential += point.weight * std::abs(held);
      sums.vertical += point.weight * (held * vertical(point.tau) - pressure * vertical(point.n));
      if (pressure > 0) sums.contact += point.weight;
      if (pressure > 0 && std::abs(shear) < bound) sums.stick += point.weight;
      length += point.weight;
      ++number;
    }
    sums.normal += force;
    sums.edge_pressures[edge++] = force / length;
  }
  return sums;
}

double ratio(double value, double scale) {
  return scale > 0 ? value / scale : value;
}

} // namespace

void nitsche_outputs(const std::vector<NitscheFace> &faces, const Matrix &pressures,
                     const CurveFields &fields, const NitscheLaw &law, Outputs &outputs) {
  const Sums sums = integrate(faces, pressures, nitsche_bounds(pressures, law));
  outputs.normal_force = sums.normal;
  outputs.reaction = sums.vertical;
  outputs.contact_measure = sums.contact;
  outputs.contact_half_width = sums.contact / 2;
  outputs.peak_pressure = std::max(0.0, -fields.sigma_n.minCoeff());
  const Index edges = fields.arc_length.size() - 1;
  outputs.centre_pressure = centre_pressure(
      sums.edge_pressures, (fields.arc_length.head(edges) + fields.arc_length.tail(edges)) / 2,
      sums.contact / 2);
  outputs.max_penetration = std::max(0.0, fields.excess.maxCoeff());
  outputs.contact_nodes = static_cast<double>((fields.p_n.array() < 0).count());
  const double normal = fields.sigma_n.norm();
  outputs.law_error_normal = ratio((fields.sigma_n - fields.p_n.cwiseMin(0)).norm(), normal);
  if (law.law == FrictionLaw::none) return;

  Matrix at_vertices(fields.p_n.size(), 2);
  at_vertices << fields.p_n, fields.p_tau;
  const Vector bounds = nitsche_bounds(at_vertices, law);
  const Vector held = fields.p_tau.cwiseMax(-bounds).cwiseMin(bounds);
  const double error = (fields.sigma_tau - held).norm();
  outputs.tangential_force = sums.tangential;
  outputs.stick_half_width = sums.stick / 2;
  outputs.stick_nodes = static_cast<double>(
      (fields.p_n.array() < 0 && fields.p_tau.array().abs() < bounds.array()).count());
  outputs.friction_violation = std::max(0.0, (fields.sigma_tau.cwiseAbs() - bounds).maxCoeff());
  outputs.law_error_tangential = ratio(error, fields.sigma_tau.norm());
  outputs.law_error_tau_over_n = ratio(error, normal);
}

} // namespace rbvi
