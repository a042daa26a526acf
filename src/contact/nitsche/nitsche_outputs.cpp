#include "rbvi/contact/nitsche/nitsche_curve.hpp"
#include "rbvi/contact/support/support_outputs.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Force on the body, and lengths of contact and of stick.
struct Sums {
  double normal = 0, tangential = 0, contact = 0, stick = 0;
  std::array<double, 2> force{}; ///< its components
  /// Contact pressure averaged over each edge. It balances the other forces there, whereas sigma_n
  /// overshoots beside a kink.
  Vector edge_pressures;
};

/// A component of a unit vector, from the functionals of the displacement along it: shape functions
/// sum to one.
double component(const NitschePoint::Row &row, Index c) {
  double sum = 0;
  for (Index i = c; i < row.size(); i += 2)
    sum += row[i];
  return sum;
}

Sums integrate(std::span<const NitscheFace> faces, const Matrix &pressures, const Vector &bounds) {
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
      for (Index c = 0; c < 2; ++c)
        sums.force[static_cast<std::size_t>(c)] +=
            point.weight * (held * component(point.tau, c) - pressure * component(point.n, c));
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

double ends_in_contact(const CurveFields &fields) {
  return (fields.p_n[0] < 0 ? 1.0 : 0.0) + (fields.p_n[fields.p_n.size() - 1] < 0 ? 1.0 : 0.0);
}

void nitsche_outputs(std::span<const NitscheFace> faces, const Matrix &pressures,
                     const CurveFields &fields, Outputs &outputs) {
  const NitscheLaw &law = faces.front().law;
  const Sums sums = integrate(faces, pressures, nitsche_bounds(faces, pressures));
  outputs.normal_force = sums.normal;
  outputs.reaction = sums.force[1];
  outputs.horizontal_reaction = sums.force[0];
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

  const Vector bounds = fields.p_n.unaryExpr([&](double p) { return nitsche_bound(law, p); });
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

void nitsche_outputs(const NitscheLayer &layer, const FullMu &mu,
                     const std::vector<NitscheFace> &faces, const Vector &u,
                     const Matrix &pressures, Outputs &outputs) {
  Index first = 0;
  for (std::size_t k = 0; k < layer.curves.size(); ++k) {
    const auto count = std::ssize(layer.cells_of(k));
    const auto own =
        std::span(faces).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
    const CurveFields fields = nitsche_fields(layer, k, mu, u);
    Outputs part, &one = layer.curves.size() == 1 ? outputs : part;
    nitsche_outputs(own, pressures.middleRows(4 * first, 4 * count), fields, one);
    if (layer.curves[k].facing.follows_state) one.ends_in_contact = ends_in_contact(fields);
    if (&one == &part) add_contact(part, outputs);
    first += count;
  }
}

} // namespace rbvi
