#include "rbvi/contact/nitsche_curve.hpp"

#include "rbvi/contact/curve.hpp"
#include "rbvi/element/lagrange.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

using Row = NitschePoint::Row;

Row local(const std::array<int, 12> &dofs, const Vector &u) {
  Row result = Row::Zero();
  for (std::size_t i = 0; i < dofs.size(); ++i)
    if (dofs[i] >= 0) result[static_cast<Index>(i)] = u[dofs[i]];
  return result;
}

/// Calls visit(face, point, number) at every point.
template <class Visit>
void at_all_points(const std::vector<NitscheFace> &faces, const Visit &visit) {
  Index number = 0;
  for (const NitscheFace &face : faces)
    for (const NitschePoint &point : face.points)
      visit(face, point, number++);
}

void add_square(FaceBlock &block, double factor, const Row &row) {
  if (factor != 0) block.noalias() += factor * row * row.transpose();
}

/// What a change of u adds to the pressures.
Matrix pressure_changes(const std::vector<NitscheFace> &faces, const Vector &du) {
  Matrix result(4 * static_cast<Index>(faces.size()), 2);
  Index number = 0;
  for (const NitscheFace &face : faces) {
    const Row here = local(face.dofs, du);
    for (const NitschePoint &point : face.points)
      result.row(number++) << point.normal(face.gamma).dot(here),
          point.tangential(face.gamma).dot(here);
  }
  return result;
}

/// Pressures with these factors, of P_n and then perhaps of P_tau, tested with every dof.
Vector tested(const std::vector<NitscheFace> &faces, Index dofs, const Vector &factors) {
  Vector result = Vector::Zero(dofs);
  const Index points = 4 * static_cast<Index>(faces.size());
  at_all_points(faces, [&](const NitscheFace &face, const NitschePoint &point, Index i) {
    const double tangential = factors.size() > points ? factors[points + i] : 0;
    if (factors[i] == 0 && tangential == 0) return;
    Row row = factors[i] * point.normal(face.gamma);
    if (tangential != 0) row += tangential * point.tangential(face.gamma);
    for (std::size_t k = 0; k < face.dofs.size(); ++k)
      if (face.dofs[k] >= 0) result[face.dofs[k]] += row[static_cast<Index>(k)];
  });
  return result;
}

double length_of(const std::array<Point, 4> &vertices, int edge) {
  const auto [i, j] = simplex_edges[edge];
  return edge_length(vertices[i], vertices[j]);
}

} // namespace

CurveCellAtMu curve_cell_at(const NitscheLayer &layer, const FullMu &mu, const CurveCell &beside) {
  const Scene &scene = layer.scene;
  CurveCellAtMu result{beside.cell,
                       beside.edge,
                       scene.materials[beside.material].of_cell(mu, reference_centre(beside.cell)),
                       {}};
  for (std::size_t v = 0; v < 3; ++v)
    result.cell.mapped[v] = scene.map(mu, beside.cell.reference[v]);
  result.geometry = simplex(2, result.cell.mapped);
  result.gamma = layer.curve_of(beside).gamma0 *
                 (result.material.lambda + 2 * result.material.shear) /
                 length_of(beside.cell.reference, beside.edge);
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
    faces.push_back({nitsche_points(layer.scene, curve.facing, mu, at), at.gamma, beside.dofs,
                     beside.curve, laws[beside.curve],
                     curve.friction() || curve.facing.follows_state});
  }
  if (state.size() > 0) turn_to(layer, mu, state, faces);
  return faces;
}

void turn_to(const NitscheLayer &layer, const FullMu &mu, const Vector &state,
             std::vector<NitscheFace> &faces) {
  for (NitscheFace &face : faces) {
    const Facing &facing = layer.curves[face.curve].facing;
    if (!facing.follows_state) continue;
    const Row here = local(face.dofs, state);
    for (NitschePoint &point : face.points)
      turn_to(facing, mu, here, point);
  }
}

NitscheLaw NitscheCurve::law_at(const FullMu &mu) const {
  return friction() ? NitscheLaw(friction_bound(law, mu)) : std::nullopt;
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

Matrix nitsche_pressures(const std::vector<NitscheFace> &faces, const Vector &u) {
  Matrix result = pressure_changes(faces, u);
  at_all_points(faces, [&](const NitscheFace &face, const NitschePoint &point, Index i) {
    result.row(i) += face.gamma * Eigen::RowVector2d(point.facing.gap, -point.facing.slip);
  });
  return result;
}

Vector NitscheTerms::bounds_at(const Matrix &pressures) const {
  if (!friction) return {};
  Vector bounds(weights.size());
  for (Index i = 0; i < bounds.size(); ++i)
    bounds[i] = nitsche_bound(laws[i], pressures(i, 0));
  return bounds;
}

Vector NitscheTerms::weighted(double PointTerm::*part, const Matrix &pressures,
                              const Vector &bounds) const {
  const Index points = weights.size();
  Vector result(points + bounds.size());
  for (Index i = 0; i < points; ++i) {
    result[i] = weights[i] * contact_term(pressures(i, 0), gamma[i]).*part;
    if (bounds.size() > 0)
      result[points + i] = weights[i] * friction_term(pressures(i, 1), bounds[i], gamma[i]).*part;
  }
  return result;
}

Vector NitscheTerms::linearised(const Matrix &pressures, const Matrix &change,
                                const Vector &bounds) const {
  const Vector rates = weighted(&PointTerm::curvature, pressures, bounds);
  return weighted(&PointTerm::slope, pressures, bounds) +
         rates.cwiseProduct(change.reshaped().head(rates.size()));
}

NitscheTerms terms_of(std::span<const NitscheFace> faces) {
  const Index points = 4 * std::ssize(faces);
  NitscheTerms terms{Vector(points), Vector(points), Vector(points), {}, false};
  for (Index i = 0; i < points; ++i) {
    const NitscheFace &face = faces[static_cast<std::size_t>(i) / 4];
    const NitschePoint &point = face.points[static_cast<std::size_t>(i) % 4];
    terms.weights[i] = point.weight;
    terms.gamma[i] = face.gamma;
    terms.turning[i] = point.weight * point.turning;
    terms.laws.push_back(face.law);
    terms.friction = terms.friction || face.law;
  }
  return terms;
}

Vector nitsche_bounds(std::span<const NitscheFace> faces, const Matrix &pressures) {
  return terms_of(faces).bounds_at(pressures);
}

std::vector<NitscheLaw> laws_at_points(std::span<const NitscheFace> faces) {
  return terms_of(faces).laws;
}

bool bounds_move(const std::vector<NitscheFace> &faces) {
  return std::ranges::any_of(faces, [](const NitscheFace &face) { return moves(face.law); });
}

std::vector<FaceBlock> nitsche_consistency(const std::vector<NitscheFace> &faces) {
  std::vector<FaceBlock> blocks(faces.size(), FaceBlock::Zero());
  at_all_points(faces, [&](const NitscheFace &face, const NitschePoint &point, Index i) {
    FaceBlock &block = blocks[static_cast<std::size_t>(i) / face.points.size()];
    const double factor = point.weight * consistency_term(0, face.gamma).curvature;
    add_square(block, factor, point.sigma_n);
    if (face.whole_stress) add_square(block, factor, point.sigma_tau);
  });
  return blocks;
}

double nitsche_energy(const std::vector<NitscheFace> &faces, const Vector &u,
                      const Vector &bounds) {
  return terms_of(faces).weighted(&PointTerm::energy, nitsche_pressures(faces, u), bounds).sum();
}

Vector nitsche_linearised(const std::vector<NitscheFace> &faces, const Vector &u,
                          const Matrix &pressures, const Vector &bounds) {
  const Matrix change = nitsche_pressures(faces, u) - pressures;
  return tested(faces, u.size(), terms_of(faces).linearised(pressures, change, bounds));
}

Vector nitsche_residual(const std::vector<NitscheFace> &faces, const Vector &u,
                        const Vector &bounds) {
  return tested(faces, u.size(),
                terms_of(faces).weighted(&PointTerm::slope, nitsche_pressures(faces, u), bounds));
}

double nitsche_round_off(const std::vector<NitscheFace> &faces, const Vector &u) {
  Matrix sizes = Matrix::Zero(4 * std::ssize(faces), 2);
  at_all_points(faces, [&](const NitscheFace &face, const NitschePoint &point, Index i) {
    sizes(i, 0) = -point.normal(face.gamma).cwiseAbs().dot(local(face.dofs, u).cwiseAbs()) -
                  face.gamma * std::abs(point.facing.gap);
  });
  return std::numeric_limits<double>::epsilon() *
         tested(faces, u.size(), terms_of(faces).weighted(&PointTerm::slope, sizes, {})).norm();
}

std::vector<FaceBlock> nitsche_tangent(const std::vector<NitscheFace> &faces,
                                       const Matrix &pressures, const Vector &bounds) {
  std::vector<FaceBlock> blocks(faces.size(), FaceBlock::Zero());
  const NitscheTerms terms = terms_of(faces);
  const Vector rates = terms.weighted(&PointTerm::curvature, pressures, bounds),
               turning = terms.turning_at(pressures);
  at_all_points(faces, [&](const NitscheFace &face, const NitschePoint &point, Index i) {
    FaceBlock &block = blocks[static_cast<std::size_t>(i) / face.points.size()];
    add_square(block, rates[i], point.normal(face.gamma));
    add_square(block, turning[i], point.tau);
    if (bounds.size() > 0)
      add_square(block, rates[turning.size() + i], point.tangential(face.gamma));
  });
  return blocks;
}

NitscheLine nitsche_line(const std::vector<NitscheFace> &faces, const Vector &u, const Vector &d,
                         const Vector &bounds) {
  NitscheLine line{terms_of(faces), nitsche_pressures(faces, u), pressure_changes(faces, d),
                   bounds};
  const Vector turning = line.terms.turning_at(line.start);
  at_all_points(faces, [&](const NitscheFace &face, const NitschePoint &point, Index i) {
    if (turning[i] != 0)
      line.turning += turning[i] * std::pow(point.tau.dot(local(face.dofs, d)), 2);
  });
  return line;
}

double NitscheLine::slope(double t) const {
  double sum = t * turning;
  for (Index i = 0; i < start.rows(); ++i) {
    const Eigen::RowVector2d p = start.row(i) + t * change.row(i);
    double density = contact_term(p[0], terms.gamma[i]).slope * change(i, 0);
    if (bounds.size() > 0)
      density += friction_term(p[1], bounds[i], terms.gamma[i]).slope * change(i, 1);
    sum += terms.weights[i] * density;
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
  const NitscheCurve &curve = layer.curves[number];
  const std::span<const CurveCell> cells = layer.cells_of(number);
  Index count = 0;
  for (const CurveCell &cell : cells)
    count = std::max<Index>({count, cell.ends[0] + 1, cell.ends[1] + 1});
  CurveFields fields;
  for (Vector *field :
       {&fields.sigma_n, &fields.sigma_tau, &fields.p_n, &fields.p_tau, &fields.excess})
    *field = Vector::Zero(count);
  Vector &excess = fields.excess, arc_length = Vector::Zero(count);
  Vector slip = Vector::Zero(count), gamma = Vector::Zero(count), edges = Vector::Zero(count);
  double length = 0;
  for (const CurveCell &cell : cells) {
    const CurveCellAtMu at = curve_cell_at(layer, mu, cell);
    const Row here = local(cell.dofs, u);
    for (const std::size_t end : {0, 1}) {
      NitschePoint point =
          nitsche_point(layer.scene, curve.facing, mu, at, static_cast<double>(end));
      if (curve.facing.follows_state) turn_to(curve.facing, mu, here, point);
      const Index vertex = cell.ends[end];
      fields.sigma_n[vertex] += point.sigma_n.dot(here);
      fields.sigma_tau[vertex] += point.sigma_tau.dot(here);
      excess[vertex] = point.n.dot(here) - point.facing.gap;
      slip[vertex] = point.tau.dot(here) + point.facing.slip;
      gamma[vertex] += at.gamma;
      ++edges[vertex];
    }
    length += length_of(at.cell.mapped, cell.edge);
    arc_length[std::max(cell.ends[0], cell.ends[1])] = length;
  }
  for (Vector *sum : {&fields.sigma_n, &fields.sigma_tau, &gamma})
    sum->array() /= edges.array();
  fields.images = curve.images;
  for (Index vertex = 0; vertex < count; ++vertex) // the image of the edge has the other sign
    if (curve.images[vertex] < image_count(layer.scene.mirrors)) fields.sigma_tau[vertex] = 0;
  fields.p_n = fields.sigma_n - gamma.cwiseProduct(excess);
  fields.p_tau = fields.sigma_tau - gamma.cwiseProduct(slip);
  fields.arc_length = from_middle(curve.middle, arc_length, length);
  fields.halved = is_halved(curve.middle);
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
