#include "nitsche_system.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/quadrature.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double residual_accuracy = 1e-13; ///< of the residual, relative
constexpr double round_off = 1e-9;          ///< below it the residual may stagnate
constexpr double shortest_step = 0.125;
constexpr int most_steps = 100, most_full_steps = 25;

/// The Gauss points beside a cell, as they are known or one by one.
class FaceOfCell {
public:
  FaceOfCell(const NitscheLayer &layer, const FullMu &mu, const CurveCell &beside,
             const NitscheFace *known)
      : layer_(layer), mu_(mu), facing_(layer.curve_of(beside).facing), known_(known) {
    if (known == nullptr) at_ = curve_cell_at(layer, mu, beside);
  }
  double gamma() const { return known_ != nullptr ? known_->gamma : at_->gamma; }
  NitschePoint point(int q) const {
    if (known_ != nullptr) return known_->points[q];
    const auto [s, weight] = edge_quadrature[q];
    NitschePoint point = nitsche_point(layer_.scene, facing_, mu_, *at_, s);
    point.weight *= weight;
    return point;
  }

private:
  const NitscheLayer &layer_;
  const FullMu &mu_;
  const Facing &facing_;
  const NitscheFace *known_;
  std::optional<CurveCellAtMu> at_;
};

} // namespace

Matrix basis_on(const CurveCell &cell, const Matrix &trace) {
  Matrix basis = Matrix::Zero(12, trace.cols());
  for (std::size_t i = 0; i < 12; ++i)
    if (cell.dofs[i] >= 0) basis.row(static_cast<Index>(i)) = trace.row(cell.dofs[i]);
  return basis;
}

ReducedNitsche::System::System(const ReducedModel &model, const std::vector<CurveCell> &cells,
                               const ChosenPoints &chosen) {
  for (const auto &[number, factor] : chosen) {
    const int cell = number / 4;
    if (parts.empty() || parts.back().cell != cell)
      parts.push_back({cell, {}, basis_on(cells[cell], model.contact.trace).transpose()});
    parts.back().points.emplace_back(number % 4, factor);
  }
  points = static_cast<Index>(chosen.size());
  u = Vector::Zero(model.primal_size());
}

void ReducedNitsche::System::set_points(const NitscheLayer &layer, const FullMu &all_parameters,
                                        const std::vector<NitscheFace> &whole) {
  mu = all_parameters;
  const bool turns = layer.follows_state();
  terms = {Vector(points), Vector(points), Vector::Zero(points), {}, layer.friction()};
  at_rest.clear();
  functionals.resize(u.size(), terms.friction ? 2 * points : points);
  offsets.resize(functionals.cols());
  Matrix &columns = turns ? axes_at_rest : functionals;
  const Index kinds = turns ? 4 : terms.friction ? 2 : 1;
  columns.resize(u.size(), kinds * points);
  Index next = 0;
  for (const Part &part : parts) {
    const CurveCell &beside = layer.cells[part.cell];
    const NitscheCurve &curve = layer.curve_of(beside);
    const FaceOfCell face(layer, mu, beside, whole.empty() ? nullptr : &whole[part.cell]);
    const auto count = static_cast<Index>(part.points.size());
    Eigen::Matrix<double, 12, Eigen::Dynamic> local(12, kinds * count);
    terms.laws.insert(terms.laws.end(), part.points.size(), curve.law_at(mu));
    for (Index k = 0; k < count; ++k) {
      const auto [q, factor] = part.points[k];
      const NitschePoint point = face.point(q);
      local.col(k) = point.normal(face.gamma());
      if (kinds > 1) local.col(count + k) = point.tangential(face.gamma());
      if (turns) {
        local.col(2 * count + k) = point.n;
        local.col(3 * count + k) = point.tau;
        at_rest.push_back({&curve.facing, point.place, point.facing.normal});
      }
      terms.weights[next + k] = factor * point.weight;
      terms.gamma[next + k] = face.gamma();
      set_offsets(next + k, point.facing);
    }
    for (Index kind = 0; kind < kinds; ++kind)
      columns.middleCols(kind * points + next, count).noalias() =
          part.basis * local.middleCols(kind * count, count);
    next += count;
  }
}

void ReducedNitsche::System::set_offsets(Index i, const FacedPoint &facing) {
  offsets[i] = terms.gamma[i] * facing.gap;
  if (terms.friction) offsets[points + i] = -terms.gamma[i] * facing.slip;
}

/// The axes of every point to those of a state.
void ReducedNitsche::System::turn_to(const Vector &coefficients) {
  if (at_rest.empty()) return;
  const auto columns = [&](Index k) { return axes_at_rest.middleCols(k * points, points); };
  const Vector along_n = columns(2).transpose() * coefficients,
               across = columns(3).transpose() * coefficients;
  along_tau.resize(u.size(), points);
  for (Index i = 0; i < points; ++i) {
    const AtRest &rest = at_rest[i];
    const auto [now, c, s] =
        turned_axes(*rest.facing, mu, rest.place, rest.normal, along_n[i], across[i]);
    set_offsets(i, now);
    functionals.col(i) = c * columns(0).col(i) + s * columns(1).col(i);
    along_tau.col(i) = c * columns(3).col(i) - s * columns(2).col(i);
    const double stress =
        functionals.col(i).dot(coefficients) + terms.gamma[i] * (c * along_n[i] + s * across[i]);
    terms.turning[i] = terms.weights[i] * now.curvature * std::min(stress, 0.0);
    if (terms.friction) functionals.col(points + i) = c * columns(1).col(i) - s * columns(0).col(i);
  }
}

void ReducedNitsche::System::set(const Vector &coefficients) {
  turn_to(coefficients);
  u = coefficients;
  const Vector p = functionals.transpose() * u + offsets;
  pressures = Matrix::Zero(points, 2);
  pressures.reshaped().head(p.size()) = p;
}

/// Sets `relative`.
Vector ReducedNitsche::System::residual() {
  const Vector au = quadratic.a_gamma * u,
               sum = functionals * terms.weighted(&PointTerm::slope, pressures, bounds);
  const Vector r = au + sum - quadratic.f;
  const double scale = au.norm() + sum.norm() + quadratic.f.norm();
  relative = scale == 0 ? 0 : r.norm() / scale;
  return r;
}

Matrix ReducedNitsche::System::tangent_at(const Matrix &at) const {
  const Vector d = terms.weighted(&PointTerm::curvature, at, bounds);
  std::vector<Index> active;
  for (Index i = 0; i < d.size(); ++i)
    if (d[i] != 0) active.push_back(i);
  const Matrix part = functionals(Eigen::all, active);
  Matrix result = quadratic.a_gamma + (part * d(active).asDiagonal()) * part.transpose();
  if (!at_rest.empty())
    result.noalias() += (along_tau * terms.turning_at(at).asDiagonal()) * along_tau.transpose();
  return result;
}

/// One linear solve, contact and stick being those of the pressures `start`, and the axes those of
/// the coefficients `state` where contact follows them.
void ReducedNitsche::System::predict(const Vector &start, const Vector &state) {
  if (start.size() != functionals.cols()) { // from u = 0
    set(Vector::Zero(u.size()));
    set_bounds();
    return;
  }
  Matrix at = Matrix::Zero(points, 2), change = at;
  at.reshaped().head(start.size()) = start;
  bounds = terms.bounds_at(at);
  turn_to(state);
  change.reshaped().head(start.size()) = offsets - start;
  Matrix tangent = tangent_at(at);
  if (!cholesky_in_place(tangent)) throw failure(tangent_not_definite);
  Vector right = quadratic.f - functionals * terms.linearised(at, change, bounds);
  if (!at_rest.empty())
    right += along_tau * terms.turning_at(at).cwiseProduct(along_tau.transpose() * state);
  set(cholesky_solve(tangent, right));
  set_bounds();
}

/// Newton's method with bounds as they are. Returns the steps.
int ReducedNitsche::System::minimise() {
  double before = 1;
  for (int step = 0; step <= most_steps; ++step) {
    const Vector r = residual();
    if (relative <= residual_accuracy) return step;
    if (step > 0 && relative <= round_off && relative > 0.1 * before) return step;
    before = relative;
    Matrix tangent = tangent_at(pressures);
    if (!cholesky_in_place(tangent)) throw failure(tangent_not_definite);
    const Vector d = -cholesky_solve(tangent, r);
    NitscheLine line{terms, pressures, Matrix::Zero(points, 2), bounds};
    line.change.reshaped().head(functionals.cols()) = functionals.transpose() * d;
    if (!at_rest.empty())
      line.turning = terms.turning_at(pressures).dot((along_tau.transpose() * d).cwiseAbs2());
    const double t = line_minimum((quadratic.a_gamma * u - quadratic.f).dot(d),
                                  d.dot(quadratic.a_gamma * d), line);
    set(u + t * d);
  }
  throw failure("the reduced problem did not converge: its residual is " + short_number(relative) +
                " after " + std::to_string(most_steps) +
                " Newton steps; reduce again with more modes (-pod_tolerance)");
}

/// Coulomb's bound as a function of u: Newton steps, halved until the residual falls. Returns
/// the steps, nothing where they do not settle soon.
std::optional<int> ReducedNitsche::System::follow_bound() {
  double before = 1;
  for (int step = 0; step <= most_full_steps; ++step) {
    set_bounds();
    const Vector r = residual();
    if (relative <= residual_accuracy) return step;
    if (step > 0 && relative <= round_off && relative > 0.1 * before) return step;
    before = relative;
    std::vector<Index> slipping; // there the bound moves with P_n
    std::vector<double> rates;
    for (Index i = 0; i < points; ++i) {
      const double pressure = -pressures(i, 0), shear = pressures(i, 1);
      const double slope = terms.laws[i] ? terms.laws[i]->slope_at(pressure) : 0;
      if (slope == 0 || !(std::abs(shear) > bounds[i]) || pressure <= 0) continue;
      slipping.push_back(i);
      rates.push_back(-std::copysign(slope, shear) * terms.weights[i] / terms.gamma[i]);
    }
    const Vector rate = Eigen::Map<const Vector>(rates.data(), static_cast<Index>(rates.size()));
    const Matrix normal = functionals.leftCols(points)(Eigen::all, slipping);
    const Matrix shear = functionals.rightCols(points)(Eigen::all, slipping);
    Matrix tangent = tangent_at(pressures);
    tangent.noalias() += (shear * rate.asDiagonal()) * normal.transpose();
    const Vector start = u, d = -lu_solve(tangent, r);
    if (!d.allFinite()) return std::nullopt;
    for (double t = 1; t >= shortest_step; t /= 2) { // the shortest one is taken whatever it gives
      set(start + t * d);
      set_bounds();
      if (residual().norm() < r.norm()) break;
    }
  }
  return std::nullopt;
}

/// From the last iterate to the answer. Returns the steps.
int ReducedNitsche::System::settle() {
  if (std::ranges::none_of(terms.laws, moves)) return minimise();
  int steps = 0;
  if (std::ranges::any_of(terms.laws, [](auto &law) { return law && law->steepest() > 0; })) {
    if (const std::optional<int> more = follow_bound()) return *more;
    steps = most_full_steps;
  }
  set_bounds();
  const auto newton = [&](double) {
    const Vector before = u;
    steps += minimise();
    const double size = u.norm();
    return size == 0 ? 0 : (u - before).norm() / size;
  };
  settle_bounds(terms.laws,
                {newton, [&] { return pressures; }, bounds, residual_accuracy, residual_accuracy});
  return steps;
}

} // namespace rbvi
