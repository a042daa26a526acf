#include "quarter_disc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

constexpr double right_angle = std::numbers::pi / 2;
constexpr double core_radius = 0.6;
constexpr double corner_growth = 0.25;   ///< of the edges, per distance from the corner
constexpr double rim_growth = 0.15;      ///< of the edges, per distance from the core's rim
constexpr double ring_distance = 0.885;  ///< of the rings below the core, in edges
constexpr double core_ring_distance = 1; ///< of the rings in the core, in edges
constexpr double offset_distance = 0.2;  ///< up to here the rings are offset curves

using Curve = std::function<Point(double)>;

/// Point at a radius and at an angle from the lowest point; exactly on the flat side at its end.
Point polar(double radius, double angle) {
  if (angle == right_angle) return {radius, 0, 0};
  return {radius * std::sin(angle), -radius * std::cos(angle), 0};
}

/// From x (t = 0) to y (t = 1).
Point between(const Point &x, const Point &y, double t) {
  return (1 - t) * x + t * y;
}

Curve arc(double radius, double from, double to) {
  return [=](double s) { return polar(radius, (1 - s) * from + s * to); };
}

Curve segment(const Point &from, const Point &to) {
  return [=](double s) { return between(from, to, s); };
}

double length(const Point &x, const Point &y) {
  return std::hypot(x[0] - y[0], x[1] - y[1]);
}

/// Edge length at a point, by its distance from the contact arc, the corner and the core's rim.
struct EdgeLength {
  QuarterDisc shape;
  double operator()(const Point &x) const {
    const double shortest = shape.contact_angle / shape.edges;
    const bool beside = std::atan2(x[0], -x[1]) > shape.contact_angle;
    const double distance =
        beside ? length(x, polar(1, shape.contact_angle)) : 1 - std::hypot(x[0], x[1]);
    const double from_corner = shape.corner_edge + corner_growth * length(x, {1, 0, 0});
    const double from_rim = shape.rim_edge + rim_growth * length(x, {core_radius, 0, 0});
    return std::min(
        {shortest + shape.growth * distance, from_corner, from_rim, shape.longest_edge});
  }
};

/// A curve measured in edges.
class GradedCurve {
public:
  GradedCurve(const EdgeLength &edge, Curve curve) : curve_(std::move(curve)) {
    for (int i = 0; i < pieces; ++i) {
      const Point x = curve_(static_cast<double>(i) / pieces);
      const Point y = curve_(static_cast<double>(i + 1) / pieces);
      sums_.push_back(sums_.back() + length(x, y) / edge(between(x, y, 0.5)));
    }
  }
  double measure() const { return sums_.back(); }
  int edges() const { return std::max(1, static_cast<int>(std::lround(measure()))); }
  /// At the fraction t of the measure.
  Point at(double t) const {
    if (t == 1) return curve_(1);
    const double sum = t * measure();
    const auto next = std::upper_bound(sums_.begin() + 1, sums_.end() - 1, sum);
    const double last = *(next - 1), along = (sum - last) / (*next - last);
    return curve_((static_cast<double>(next - 1 - sums_.begin()) + along) / pieces);
  }

private:
  static constexpr int pieces = 2048;
  Curve curve_;
  std::vector<double> sums_{0};
};

Ring add_ring(SerialMesh &mesh, const GradedCurve &curve) {
  return add_open_ring(mesh, curve.edges(), [&](double t) { return curve.at(t); });
}

/// Appends the nodes of a curve to a ring that ends at its first point.
void extend_ring(SerialMesh &mesh, Ring &ring, const GradedCurve &curve) {
  const int edges = curve.edges();
  for (int i = 1; i <= edges; ++i) {
    ring.push_back(static_cast<int>(mesh.points.size()));
    mesh.points.push_back(curve.at(static_cast<double>(i) / edges));
  }
}

/// The curve at a distance d from the contact arc: a concentric arc, then the round cap about the
/// end of the contact arc, as far as the boundary of the disc.
struct Offset {
  double contact_angle, d;
  double end_angle() const { return contact_angle + 2 * std::asin(d / 2); }
  Point at(double s) const {
    const double straight = (1 - d) * contact_angle;
    const double along = s * (straight + d * (right_angle - std::asin(d / 2)));
    if (along <= straight) return polar(1 - d, along / (1 - d));
    const Point end = polar(1, contact_angle);
    const double angle = contact_angle - (along - straight) / d; // of the normal to the vertical
    return {end[0] - d * std::sin(angle), end[1] + d * std::cos(angle), 0};
  }
};

/// The last ring below the core: along the core's arc, then straight to the boundary of the disc.
Curve last_ring(const QuarterDisc &shape) {
  const Point corner = polar(core_radius, shape.inner_end), end = polar(1, shape.outer_end);
  const double bent = core_radius * shape.inner_end, straight = length(corner, end);
  return [=](double s) {
    const double along = s * (bent + straight);
    if (along <= bent) return polar(core_radius, along / core_radius);
    return between(corner, end, (along - bent) / straight);
  };
}

/// Meets the axis at a distance d from the contact arc: an offset curve that, from some distance
/// on, turns into the last ring; its end moves along the boundary of the disc.
Curve ring_curve(const QuarterDisc &shape, double d) {
  const Offset offset{shape.contact_angle, std::min(d, offset_distance)};
  const Curve last = last_ring(shape);
  const double blend = std::max(0.0, (d - offset_distance) / (1 - core_radius - offset_distance));
  const Point end = between(offset.at(1), last(1), blend);
  const Point rim = polar(1, (1 - blend) * offset.end_angle() + blend * shape.outer_end);
  return [=](double s) { return between(offset.at(s), last(s), blend) + s * (rim - end); };
}

/// The quarter in three parts: the fan of rings about the contact arc, the rest of the
/// annulus about the core in rows from the core's arc to the boundary of the disc, and the core.
struct Quarter {
  const QuarterDisc &shape;
  EdgeLength edge{shape};
  SerialMesh mesh{};
  Ring core_arc{};  ///< from the axis on
  Ring first_row{}; ///< from the end of the fan on

  void add_fan();
  void add_rows();
  void add_core();
};

void Quarter::add_fan() {
  const GradedCurve axis(edge, segment({0, -1, 0}, {0, -core_radius, 0}));
  const auto rings = static_cast<int>(std::lround(axis.measure() / ring_distance));
  Ring ring = add_open_ring(mesh, shape.edges, arc(1, 0, shape.contact_angle));
  add_facets(mesh, "contact", ring);
  add_facets(mesh, "arc", ring);
  const auto append = [&](const Ring &next) {
    zip_best(mesh, next, ring);
    add_facets(mesh, "arc", {ring.back(), next.back()});
    add_facets(mesh, "axis", {next.front(), ring.front()});
    ring = next;
  };
  for (int j = 1; j < rings; ++j)
    append(
        add_ring(mesh, {edge, ring_curve(shape, 1 + axis.at(static_cast<double>(j) / rings)[1])}));

  core_arc = add_ring(mesh, {edge, arc(core_radius, 0, shape.inner_end)});
  first_row = {core_arc.back()};
  extend_ring(mesh, first_row,
              {edge, segment(polar(core_radius, shape.inner_end), polar(1, shape.outer_end))});
  Ring last = core_arc;
  last.insert(last.end(), first_row.begin() + 1, first_row.end());
  append(last);
}

void Quarter::add_rows() {
  const GradedCurve inner(edge, arc(core_radius, shape.inner_end, right_angle));
  const GradedCurve outer(edge, arc(1, shape.outer_end, right_angle));
  const auto rows =
      static_cast<int>(std::lround((inner.measure() + outer.measure()) / std::sqrt(3.0)));
  Ring row = first_row;
  for (int k = 1; k <= rows; ++k) {
    const double t = static_cast<double>(k) / rows;
    const Ring next = add_ring(mesh, {edge, segment(inner.at(t), outer.at(t))});
    zip_best(mesh, next, row);
    add_facets(mesh, "arc", {row.back(), next.back()});
    core_arc.push_back(next.front());
    row = next;
  }
  std::reverse(row.begin(), row.end());
  add_facets(mesh, "top", row);
}

void Quarter::add_core() {
  const auto first = static_cast<int>(mesh.cells.size());
  const GradedCurve axis(edge, segment(polar(core_radius, 0), {0, 0, 0}));
  const GradedCurve top(edge, segment(polar(core_radius, right_angle), {0, 0, 0}));
  const auto rings =
      static_cast<int>(std::lround((axis.measure() + top.measure()) / 2 / core_ring_distance));
  Ring ring = core_arc;
  const auto append = [&](const Ring &next) {
    zip_best(mesh, next, ring);
    add_facets(mesh, "top", {ring.back(), next.back()});
    add_facets(mesh, "axis", {next.front(), ring.front()});
    ring = next;
  };
  for (int j = 1; j < rings; ++j) {
    const double t = static_cast<double>(j) / rings, below = -axis.at(t)[1], beside = top.at(t)[0];
    append(add_ring(mesh, {edge, [=](double s) {
                             return polar((1 - s * s) * below + s * s * beside, s * right_angle);
                           }}));
  }
  mesh.points.push_back({0, 0, 0});
  append({static_cast<int>(mesh.points.size()) - 1});
  for (int cell = first; cell < static_cast<int>(mesh.cells.size()); ++cell)
    mesh.region["core"].push_back(cell);
}

} // namespace

SerialMesh quarter_disc(const QuarterDisc &shape) {
  Quarter quarter{shape};
  quarter.add_fan();
  quarter.add_rows();
  quarter.add_core();
  return quarter.mesh;
}

} // namespace rbvi
