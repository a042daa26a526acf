#include "rbvi/contact/nitsche_curve.hpp"
#include "rbvi/contact/support_outputs.hpp"

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

/// Of |sigma_tau| at the vertices.
Vector bounds_at(const CurveFields &fields, const NitscheLaw &law) {
  return fields.p_n.unaryExpr([&](double p) { return nitsche_bound(law, p); });
}

Sums integrate(std::span<const NitscheFace> faces, const Matrix &pressures, const Vector &bounds) {
  Sums sums;
  sums.edge_pressures.resize(static_cast<Index>(faces.size()));
  Index number = 0, edge = 0;
  for (const NitscheFace &face : faces) {
    double force = 0, length = 0;
    for (const NitschePoint &point : face.points) {
      const double pressure = std::max(0.0, -pressures(number, 0)), shear = pressures(number, 1);
      const Point &n = point.facing.normal, &out = point.body_normal;
      if (pressure > 0) check_pressed_side(dot(n, out), point.place.x);
      const double bound = bounds.size() > 0 ? std::max(0.0, bounds[number]) : 0;
      force += point.weight * pressure;
      sums.tangential += point.weight * std::abs(std::clamp(shear, -bound, bound));
      const Point at = nitsche_force(point, pressures(number, 0), shear, bound);
      sums.force[0] += at[0];
      sums.force[1] += at[1];
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

/// How far fields are from the laws: sums of squares over the nodes of curves.
struct LawErrors {
  double normal = 0, tangential = 0; ///< |sigma - its projection|^2
  double sigma_n = 0, sigma_tau = 0; ///< |sigma|^2
  bool friction = false;

  void add(const CurveFields &fields, const NitscheLaw &law) {
    const auto square = [&](const Vector &of) { return fields.images.dot(of.cwiseAbs2()); };
    normal += square(fields.sigma_n - fields.p_n.cwiseMin(0));
    sigma_n += square(fields.sigma_n);
    if (!law) return;
    const Vector bounds = bounds_at(fields, law);
    friction = true;
    tangential += square(fields.sigma_tau - fields.p_tau.cwiseMax(-bounds).cwiseMin(bounds));
    sigma_tau += square(fields.sigma_tau);
  }
  void set(Outputs &outputs) const {
    const auto ratio = [](double square, double scale) {
      return std::sqrt(scale > 0 ? square / scale : square);
    };
    outputs.law_error_normal = ratio(normal, sigma_n);
    if (!friction) return;
    outputs.law_error_tangential = ratio(tangential, sigma_tau);
    outputs.law_error_tau_over_n = ratio(tangential, sigma_n);
  }
};

} // namespace

Point nitsche_force(const NitschePoint &point, double p_n, double p_tau, double bound) {
  const double pressure = std::max(0.0, -p_n), held = std::clamp(p_tau, -bound, bound);
  const Point &n = point.facing.normal;
  return {-point.weight * (held * n[1] + pressure * n[0]),
          point.weight * (held * n[0] - pressure * n[1]), 0};
}

double ends_in_contact(const CurveFields &fields, const std::vector<int> &open_ends) {
  return static_cast<double>(
      std::ranges::count_if(open_ends, [&](int vertex) { return fields.p_n[vertex] < 0; }));
}

void nitsche_outputs(std::span<const NitscheFace> faces, const Matrix &pressures,
                     const Vector &bounds_there, const CurveFields &fields, Outputs &outputs) {
  const NitscheLaw &law = faces.front().law;
  const Sums sums = integrate(faces, pressures, bounds_there);
  outputs.normal_force = sums.normal;
  outputs.reaction = sums.force[1];
  outputs.horizontal_reaction = sums.force[0];
  outputs.contact_measure = sums.contact;
  outputs.contact_half_width = sums.contact / 2;
  outputs.peak_pressure = std::max(0.0, -fields.sigma_n.minCoeff());
  if (const Index edges = fields.arc_length.size() - 1; edges > 0)
    outputs.centre_pressure = centre_pressure(
        sums.edge_pressures, (fields.arc_length.head(edges) + fields.arc_length.tail(edges)) / 2,
        fields.halved ? sums.contact : sums.contact / 2, fields.halved);
  outputs.max_penetration = std::max(0.0, fields.excess.maxCoeff());
  outputs.contact_nodes = (fields.p_n.array() < 0).select(fields.images, 0).sum();
  outputs.free_nodes = fields.images.sum() - *outputs.contact_nodes;
  LawErrors errors;
  errors.add(fields, law);
  errors.set(outputs);
  if (!law) return;

  const Vector bounds = bounds_at(fields, law);
  outputs.tangential_force = sums.tangential;
  outputs.slip_directions = direction_count(fields.p_tau, -fields.p_n);
  outputs.stick_half_width = sums.stick / 2;
  outputs.stick_nodes = (fields.p_n.array() < 0 && fields.p_tau.array().abs() < bounds.array())
                            .select(fields.images, 0)
                            .sum();
  outputs.friction_violation = std::max(0.0, (fields.sigma_tau.cwiseAbs() - bounds).maxCoeff());
}

void nitsche_outputs(const NitscheLayer &layer, const FullMu &mu,
                     const std::vector<NitscheFace> &faces, const Vector &u,
                     const Matrix &pressures, const Vector &bounds, Outputs &outputs) {
  Index first = 0;
  LawErrors errors;
  for (std::size_t k = 0; k < layer.curves.size(); ++k) {
    const auto count = std::ssize(layer.cells_of(k));
    const auto own = std::span(faces).subspan(first, static_cast<std::size_t>(count));
    const CurveFields fields = nitsche_fields(layer, k, mu, u);
    Outputs part, &one = layer.curves.size() == 1 ? outputs : part;
    const Vector own_bounds = bounds.size() > 0 ? bounds.segment(4 * first, 4 * count) : bounds;
    nitsche_outputs(own, pressures.middleRows(4 * first, 4 * count), own_bounds, fields, one);
    if (layer.scene.axisymmetric) drop_plane_outputs(one);
    if (const std::vector<int> &open = layer.curves[k].open_ends; !open.empty())
      one.ends_in_contact = image_count(layer.scene.mirrors) * ends_in_contact(fields, open);
    make_whole(layer.scene.mirrors, one);
    if (&one == &part) {
      part.name = contact_name(layer.scene, k);
      add_contact(part, outputs);
    }
    errors.add(fields, own.front().law);
    first += count;
  }
  errors.set(outputs);
}

} // namespace rbvi
