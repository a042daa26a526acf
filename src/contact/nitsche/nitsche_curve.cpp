#include "rbvi/contact/nitsche/nitsche_curve.hpp"

#include "rbvi/element/lagrange.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

using Row = NitschePoint::Row;

Row local(const std::array<int, 12> &dofs, const Vector &u) {
  Row result = Row::Zero();
  for (std::size_t i = 0; i < dofs.size(); ++i)
    if (dofs[i] >= 0) result[static_cast<Index>(i)] = u[dofs[i]];
  return result;
}

/// Linear part of P_n and of P_tau in u.
Row normal_row(const NitschePoint &point, double gamma) {
  return point.sigma_n - gamma * point.n;
}

Row tangential_row(const NitschePoint &point, double gamma) {
  return point.sigma_tau - gamma * point.tau;
}

/// Calls visit(face, point, number, bound) at every point; bound < 0 without friction.
template <class Visit>
void at_all_points(const std::vector<NitscheFace> &faces, const Vector &bounds,
                   const Visit &visit) {
  Index number = 0;
  for (const NitscheFace &face : faces)
    for (const NitschePoint &point : face.points) {
      visit(face, point, number, bounds.size() > 0 ? bounds[number] : -1);
      ++number;
    }
}

void add_square(FaceBlock &block, double factor, const Row &row) {
  if (factor != 0) block.noalias() += factor * row * row.transpose();
}

/// Of tau tau^T: what the normal of a point in contact turns by.
double turning(const NitschePoint &point, double pressure) {
  return pressure < 0 ? point.weight * point.turning : 0;
}

/// The terms tested with every dof of the layer: those at `pressures`, and what they change to
/// first order with the pressures `moved`.
Vector tested(const std::vector<NitscheFace> &faces, Index dofs, const Matrix &pressures,
              const Matrix &moved, const Vector &bounds) {
  Vector result = Vector::Zero(dofs);
  at_all_points(faces, bounds,
                [&](const NitscheFace &face, const NitschePoint &point, Index i, double bound) {
                  const PointTerm contact = contact_term(pressures(i, 0), face.gamma);
                  const PointTerm friction = friction_term(pressures(i, 1), bound, face.gamma);
                  const double normal = contact.slope + contact.curvature * moved(i, 0);
                  const double tangential = friction.slope + friction.curvature * moved(i, 1);
                  if (normal == 0 && tangential == 0) return;
                  Row row = normal * normal_row(point, face.gamma);
                  if (tangential != 0) row += tangential * tangential_row(point, face.gamma);
                  for (std::size_t k = 0; k < face.dofs.size(); ++k)
                    if (face.dofs[k] >= 0)
                      result[face.dofs[k]] += point.weight * row[static_cast<Index>(k)];
                });
  return result;
}

double edge_length(const std::array<Point, 4> &vertices, int edge) {
  const auto [i, j] = simplex_edges[edge];
  const Point &a = vertices[i], &b = vertices[j];
  return std::hypot(b[0] - a[0], b[1] - a[1]);
}

} // namespace

CurveCellAtMu curve_cell_at(const NitscheLayer &layer, const FullMu &mu, const CurveCell &beside) {
  const Scene &scene = layer.scene;
  CurveCellAtMu result{beside.cell, scene.material(mu, reference_centre(beside.cell)), 0};
  for (std::size_t v = 0; v < 3; ++v)
    result.cell.mapped[v] = scene.map(mu, beside.cell.reference[v]);
  result.gamma = layer.curve_of(beside).gamma0 *
                 (result.material.lambda + 2 * result.material.shear) /
                 edge_length(beside.cell.reference, beside.edge);
  return result;
}

std::vector<NitscheFace> nitsche_faces(const NitscheLayer &layer, const FullMu &mu,
                                       const std::vector<CurveCell> &cells, const Vector &state) {
  std::vector<NitscheLaw> laws;
  for (const NitscheCurve &curve : layer.curves)
    laws.push_back(curve.law_at(mu));
  std::vector<NitscheFace> faces;
  faces.reserve(cells.size());
  for (const CurveCell &beside : cells) {
    const CurveCellAtMu at = curve_cell_at(layer, mu, beside);
    const NitscheCurve &curve = layer.curve_of(beside);
    faces.push_back(
        {nitsche_points(layer.scene, curve.facing, mu, at.cell, beside.edge, at.material), at.gamma,
         beside.dofs, beside.curve, laws[beside.curve],
         curve.friction() || curve.facing.follows_state});
  }
  if (state.size() > 0) turn_to(layer, mu, state, faces);
  return faces;
}

void turn_to(const NitscheLayer &layer, const FullMu &mu, const Vector &state,
             std::vector<NitscheFace> &faces) {
  for (NitscheFace &face : faces) {
    const NitscheFacing &facing = layer.curves[face.curve].facing;
    if (!facing.follows_state) continue;
    const Row here = local(face.dofs, state);
    for (NitschePoint &point : face.points)
      turn_to(facing, mu, here, point);
  }
}

NitscheLaw NitscheCurve::law_at(const FullMu &mu) const {
  if (!friction()) return {};
  const FrictionBound bound = friction_bound(law, mu); // of one law
  return {law.law, bound.coefficient + bound.threshold, bound.only_in_contact};
}

bool NitscheLayer::friction() const {
  return std::ranges::any_of(curves, &NitscheCurve::friction);
}

std::span<const CurveCell> NitscheLayer::cells_of(std::size_t curve) const {
  const auto own = std::ranges::equal_range(cells, static_cast<int>(curve), {}, &CurveCell::curve);
  return {own.begin(), own.end()};
}

bool NitscheLayer::follows_state() const {
  return std::ranges::any_of(curves,
                             [](const NitscheCurve &curve) { return curve.facing.follows_state; });
}

Matrix nitsche_pressure_changes(const std::vector<NitscheFace> &faces, const Vector &du) {
  Matrix result(4 * static_cast<Index>(faces.size()), 2);
  Index number = 0;
  for (const NitscheFace &face : faces) {
    const Row here = local(face.dofs, du);
    for (const NitschePoint &point : face.points)
      result.row(number++) << normal_row(point, face.gamma).dot(here),
          tangential_row(point, face.gamma).dot(here);
  }
  return result;
}

Matrix nitsche_pressures(const std::vector<NitscheFace> &faces, const Vector &u) {
  Matrix result = nitsche_pressure_changes(faces, u);
  Index number = 0;
  for (const NitscheFace &face : faces)
    for (const NitschePoint &point : face.points)
      result.row(number++) += face.gamma * Eigen::RowVector2d(point.facing.gap, -point.facing.slip);
  return result;
}

double nitsche_bound(const NitscheLaw &law, double p_n) {
  if (law.law == FrictionLaw::none) return -1;
  if (law.law == FrictionLaw::coulomb) return coulomb_bound(p_n, law.value);
  return law.only_in_contact && p_n >= 0 ? 0.0 : law.value;
}

Vector nitsche_bounds(std::span<const NitscheFace> faces, const Matrix &pressures) {
  if (std::ranges::all_of(
          faces, [](const NitscheFace &face) { return face.law.law == FrictionLaw::none; }))
    return {};
  Vector bounds(pressures.rows());
  for (Index i = 0; i < bounds.size(); ++i)
    bounds[i] = nitsche_bound(faces[static_cast<std::size_t>(i) / 4].law, pressures(i, 0));
  return bounds;
}

bool bounds_move(const std::vector<NitscheFace> &faces) {
  return std::ranges::any_of(faces, [](const NitscheFace &face) { return face.law.moves(); });
}

std::vector<FaceBlock> nitsche_consistency(const std::vector<NitscheFace> &faces) {
  std::vector<FaceBlock> blocks;
  blocks.reserve(faces.size());
  for (const NitscheFace &face : faces) {
    FaceBlock block = FaceBlock::Zero();
    for (const NitschePoint &point : face.points) {
      const double factor = point.weight * consistency_term(0, face.gamma).curvature;
      add_square(block, factor, point.sigma_n);
      if (face.whole_stress) add_square(block, factor, point.sigma_tau);
    }
    blocks.push_back(block);
  }
  return blocks;
}

double nitsche_energy(const std::vector<NitscheFace> &faces, const Vector &u,
                      const Vector &bounds) {
  const Matrix pressures = nitsche_pressures(faces, u);
  double energy = 0;
  at_all_points(faces, bounds,
                [&](const NitscheFace &face, const NitschePoint &point, Index i, double bound) {
                  energy +=
                      point.weight * (contact_term(pressures(i, 0), face.gamma).energy +
                                      friction_term(pressures(i, 1), bound, face.gamma).energy);
                });
  return energy;
}

Vector nitsche_linearised(const std::vector<NitscheFace> &faces, const Vector &u,
                          const Matrix &pressures, const Vector &bounds) {
  return tested(faces, u.size(), pressures, nitsche_pressures(faces, u) - pressures, bounds);
}

Vector nitsche_residual(const std::vector<NitscheFace> &faces, const Vector &u,
                        const Vector &bounds) {
  const Matrix pressures = nitsche_pressures(faces, u);
  return tested(faces, u.size(), pressures, Matrix::Zero(pressures.rows(), 2), bounds);
}

std::vector<FaceBlock> nitsche_tangent(const std::vector<NitscheFace> &faces,
                                       const Matrix &pressures, const Vector &bounds) {
  std::vector<FaceBlock> blocks(faces.size(), FaceBlock::Zero());
  at_all_points(
      faces, bounds,
      [&](const NitscheFace &face, const NitschePoint &point, Index i, double bound) {
        FaceBlock &block = blocks[static_cast<std::size_t>(i) / face.points.size()];
        add_square(block, point.weight * contact_term(pressures(i, 0), face.gamma).curvature,
                   normal_row(point, face.gamma));
        add_square(block, turning(point, pressures(i, 0)), point.tau);
        add_square(block,
                   point.weight * friction_term(pressures(i, 1), bound, face.gamma).curvature,
                   tangential_row(point, face.gamma));
      });
  return blocks;
}

double nitsche_turning(const std::vector<NitscheFace> &faces, const Matrix &pressures,
                       const Vector &d) {
  double sum = 0;
  at_all_points(faces, {},
                [&](const NitscheFace &face, const NitschePoint &point, Index i, double) {
                  const double factor = turning(point, pressures(i, 0));
                  if (factor != 0) sum += factor * std::pow(point.tau.dot(local(face.dofs, d)), 2);
                });
  return sum;
}

NitscheLine nitsche_line(const std::vector<NitscheFace> &faces, const Vector &u, const Vector &d,
                         const Vector &bounds) {
  const auto points = 4 * static_cast<Index>(faces.size());
  NitscheLine line{Vector(points), Vector(points), nitsche_pressures(faces, u),
                   nitsche_pressure_changes(faces, d), bounds};
  Index number = 0;
  for (const NitscheFace &face : faces)
    for (const NitschePoint &point : face.points) {
      line.weights[number] = point.weight;
      line.gamma[number++] = face.gamma;
    }
  return line;
}

double NitscheLine::slope(double t) const {
  double sum = 0;
  for (Index i = 0; i < weights.size(); ++i) {
    const Eigen::RowVector2d p = start.row(i) + t * change.row(i);
    double density = contact_term(p[0], gamma[i]).slope * change(i, 0);
    if (bounds.size() > 0) density += friction_term(p[1], bounds[i], gamma[i]).slope * change(i, 1);
    sum += weights[i] * density;
  }
  return sum;
}

double line_minimum(double linear, double quadratic, const NitscheLine &line) {
  const auto slope = [&](double t) { return linear + t * quadratic + line.slope(t); };
  const double first = slope(0), enough = 1e-2 * std::abs(first);
  double low = 0, low_slope = first, high = 1, high_slope = slope(1);
  while (high_slope < -enough && high < 16) {
    low = high;
    low_slope = high_slope;
    high *= 2;
    high_slope = slope(high);
  }
  if (high_slope <= enough) return high;
  for (int step = 0; step < 60; ++step) { // regula falsi, halved where it stalls
    double t = low - low_slope * (high - low) / (high_slope - low_slope);
    if (step % 3 == 2) t = (low + high) / 2;
    const double value = slope(t);
    if (std::abs(value) <= enough) return t;
    (value < 0 ? low : high) = t;
    (value < 0 ? low_slope : high_slope) = value;
  }
  return low > 0 ? low : high;
}

CurveFields nitsche_fields(const NitscheLayer &layer, std::size_t number, const FullMu &mu,
                           const Vector &u) {
  const NitscheFacing &facing = layer.curves[number].facing;
  const std::span<const CurveCell> cells = layer.cells_of(number);
  const auto count = static_cast<Index>(cells.size()) + 1;
  CurveFields fields;
  for (Vector *field : {&fields.sigma_n, &fields.sigma_tau, &fields.p_n, &fields.p_tau,
                        &fields.excess, &fields.arc_length})
    *field = Vector::Zero(count);
  Vector &excess = fields.excess;
  Vector slip = Vector::Zero(count), gamma = Vector::Zero(count), edges = Vector::Zero(count);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const CurveCellAtMu at = curve_cell_at(layer, mu, cells[k]);
    const auto ends = simplex_edges[cells[k].edge];
    const bool forward = at.cell.reference[ends[0]][0] < at.cell.reference[ends[1]][0];
    const Row here = local(cells[k].dofs, u);
    for (const double s : {0.0, 1.0}) {
      NitschePoint point =
          nitsche_point(layer.scene, facing, mu, at.cell, cells[k].edge, at.material, s);
      if (facing.follows_state) turn_to(facing, mu, here, point);
      const Index vertex = static_cast<Index>(k) + ((s == 1) == forward ? 1 : 0);
      fields.sigma_n[vertex] += point.sigma_n.dot(here);
      fields.sigma_tau[vertex] += point.sigma_tau.dot(here);
      excess[vertex] = point.n.dot(here) - point.facing.gap;
      slip[vertex] = point.tau.dot(here) + point.facing.slip;
      gamma[vertex] += at.gamma;
      ++edges[vertex];
    }
    fields.arc_length[static_cast<Index>(k) + 1] =
        fields.arc_length[static_cast<Index>(k)] + edge_length(at.cell.mapped, cells[k].edge);
  }
  for (Vector *sum : {&fields.sigma_n, &fields.sigma_tau, &gamma})
    sum->array() /= edges.array();
  fields.p_n = fields.sigma_n - gamma.cwiseProduct(excess);
  fields.p_tau = fields.sigma_tau - gamma.cwiseProduct(slip);
  fields.arc_length.array() -= fields.arc_length[count - 1] / 2;
  return fields;
}

Vector nitsche_multiplier(const NitscheLayer &layer, const FullMu &mu, const Vector &u) {
  std::vector<double> result;
  for (std::size_t k = 0; k < layer.curves.size(); ++k) {
    const CurveFields fields = nitsche_fields(layer, k, mu, u);
    result.insert(result.end(), fields.sigma_n.begin(), fields.sigma_n.end());
    if (layer.curves[k].friction())
      result.insert(result.end(), fields.sigma_tau.begin(), fields.sigma_tau.end());
  }
  return -Eigen::Map<const Vector>(result.data(), std::ssize(result));
}

} // namespace rbvi
