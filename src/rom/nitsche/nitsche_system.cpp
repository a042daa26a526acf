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
constexpr double bound_accuracy = 1e-12;    ///< change of u by new bounds
constexpr double shortest_step = 0.125;
constexpr int most_steps = 100, most_full_steps = 25, most_loops = 60;

Matrix basis_on(const CurveCell &cell, const Matrix &trace) {
  Matrix basis = Matrix::Zero(12, trace.cols());
  for (std::size_t i = 0; i < 12; ++i)
    if (cell.dofs[i] >= 0) basis.row(static_cast<Index>(i)) = trace.row(cell.dofs[i]);
  return basis;
}

} // namespace

ReducedNitsche::System::System(const ReducedModel &model, const std::vector<CurveCell> &cells,
                               const ChosenPoints &chosen) {
  for (const auto &[number, factor] : chosen) {
    const int cell = number / 4;
    if (parts.empty() || parts.back().cell != cell)
      parts.push_back({cell, {}, basis_on(cells[cell], model.contact_trace).transpose()});
    parts.back().points.emplace_back(number % 4, factor);
  }
  points = static_cast<Index>(chosen.size());
  u = Vector::Zero(model.primal_size());
}

void ReducedNitsche::System::set_points(const NitscheLayer &layer, const FullMu &all_parameters) {
  laws.clear();
  for (const Part &part : parts)
    laws.insert(laws.end(), part.points.size(),
                layer.curve_of(layer.cells[part.cell]).law_at(all_parameters));
  friction = layer.friction();
  functionals.resize(u.size(), friction ? 2 * points : points);
  offsets.resize(functionals.cols());
  weights.resize(points);
  gamma.resize(points);
  turning = Vector::Zero(points);
  if (layer.follows_state()) return set_at_rest(layer, all_parameters);
  at_rest.facing.clear();
  Index next = 0;
  for (const Part &part : parts) {
    const CurveCell &beside = layer.cells[part.cell];
    const CurveCellAtMu at = curve_cell_at(layer, all_parameters, beside);
    const NitscheFacing &facing = layer.curve_of(beside).facing;
    const auto count = static_cast<Index>(part.points.size());
    Eigen::Matrix<double, 12, Eigen::Dynamic> local(12, friction ? 2 * count : count);
    for (Index k = 0; k < count; ++k) {
      const auto [q, factor] = part.points[k];
      const EdgePoint rule = edge_quadrature[q];
      const NitschePoint point = nitsche_point(layer.scene, facing, all_parameters, at.cell,
                                               beside.edge, at.material, rule.s);
      local.col(k) = point.sigma_n - at.gamma * point.n;
      offsets[next + k] = at.gamma * point.facing.gap;
      if (friction) {
        local.col(count + k) = point.sigma_tau - at.gamma * point.tau;
        offsets[points + next + k] = -at.gamma * point.facing.slip;
      }
      weights[next + k] = factor * rule.weight * point.weight;
      gamma[next + k] = at.gamma;
    }
    functionals.middleCols(next, count).noalias() = part.basis * local.leftCols(count);
    if (friction)
      functionals.middleCols(points + next, count).noalias() = part.basis * local.rightCols(count);
    next += count;
  }
}

/// Both axes of every point, and the displacement along them.
void ReducedNitsche::System::set_at_rest(const NitscheLayer &layer, const FullMu &all_parameters) {
  at_rest = {{}, all_parameters, {}, {}, Matrix(u.size(), 4 * points)};
  along_tau.resize(u.size(), points);
  Index next = 0;
  for (const Part &part : parts) {
    const CurveCell &beside = layer.cells[part.cell];
    const CurveCellAtMu at = curve_cell_at(layer, all_parameters, beside);
    const NitscheFacing &facing = layer.curve_of(beside).facing;
    Eigen::Matrix<double, 12, 4> local;
    for (const auto &[q, factor] : part.points) {
      const EdgePoint rule = edge_quadrature[q];
      const NitschePoint point = nitsche_point(layer.scene, facing, all_parameters, at.cell,
                                               beside.edge, at.material, rule.s);
      local << point.sigma_n - at.gamma * point.n, point.sigma_tau - at.gamma * point.tau, point.n,
          point.tau;
      for (Index k = 0; k < 4; ++k)
        at_rest.functionals.col(k * points + next).noalias() = part.basis * local.col(k);
      at_rest.facing.push_back(&facing);
      at_rest.x.push_back(point.x);
      at_rest.normal.push_back(point.facing.normal);
      weights[next] = factor * rule.weight * point.weight;
      gamma[next++] = at.gamma;
    }
  }
}

/// The axes of every point to those of a state.
void ReducedNitsche::System::turn_to(const Vector &coefficients) {
  if (at_rest.facing.empty()) return;
  const auto columns = [&](Index k) { return at_rest.functionals.middleCols(k * points, points); };
  const Vector along_n = columns(2).transpose() * coefficients,
               across = columns(3).transpose() * coefficients;
  for (Index i = 0; i < points; ++i) {
    const Point &n = at_rest.normal[i];
    const NitscheFacing &facing = *at_rest.facing[i];
    const SupportPoint now =
        facing.at(at_rest.mu, at_rest.x[i],
                  {along_n[i] * n[0] - across[i] * n[1], along_n[i] * n[1] + across[i] * n[0], 0});
    const double c = now.normal[0] * n[0] + now.normal[1] * n[1],
                 s = now.normal[1] * n[0] - now.normal[0] * n[1];
    functionals.col(i) = c * columns(0).col(i) + s * columns(1).col(i);
    offsets[i] = gamma[i] * now.gap;
    along_tau.col(i) = c * columns(3).col(i) - s * columns(2).col(i);
    const double stress =
        functionals.col(i).dot(coefficients) + gamma[i] * (c * along_n[i] + s * across[i]);
    turning[i] = weights[i] * now.curvature * std::min(stress, 0.0);
    if (!friction) continue;
    functionals.col(points + i) = c * columns(1).col(i) - s * columns(0).col(i);
    offsets[points + i] = -gamma[i] * now.slip;
  }
}

void ReducedNitsche::System::set(const Vector &coefficients) {
  turn_to(coefficients);
  u = coefficients;
  const Vector p = functionals.transpose() * u + offsets;
  pressures = Matrix::Zero(points, 2);
  pressures.reshaped().head(p.size()) = p;
}

Vector ReducedNitsche::System::weighted(double PointTerm::*part, const Matrix &at) const {
  Vector result(functionals.cols());
  for (Index i = 0; i < points; ++i) {
    result[i] = weights[i] * contact_term(at(i, 0), gamma[i]).*part;
    if (bounds.size() > 0)
      result[points + i] = weights[i] * friction_term(at(i, 1), bounds[i], gamma[i]).*part;
  }
  return result;
}

Vector ReducedNitsche::System::bounds_at(const Matrix &at) const {
  if (!friction) return {};
  Vector result(points);
  for (Index i = 0; i < points; ++i)
    result[i] = nitsche_bound(laws[i], at(i, 0));
  return result;
}

/// Sets `relative`.
Vector ReducedNitsche::System::residual() {
  const Vector au = quadratic.a_gamma * u,
               terms = functionals * weighted(&PointTerm::slope, pressures);
  const Vector r = au + terms - quadratic.f;
  const double scale = au.norm() + terms.norm() + quadratic.f.norm();
  relative = scale == 0 ? 0 : r.norm() / scale;
  return r;
}

Matrix ReducedNitsche::System::tangent_at(const Matrix &at) const {
  const Vector d = weighted(&PointTerm::curvature, at);
  std::vector<Index> active;
  for (Index i = 0; i < d.size(); ++i)
    if (d[i] != 0) active.push_back(i);
  const Matrix part = functionals(Eigen::all, active);
  Matrix result = quadratic.a_gamma + (part * d(active).asDiagonal()) * part.transpose();
  if (!at_rest.facing.empty())
    result.noalias() += (along_tau * turning_at(at).asDiagonal()) * along_tau.transpose();
  return result;
}

/// The second derivative along tau that the curvature of the surface adds at each point in contact
/// at these pressures (NitschePoint::turning).
Vector ReducedNitsche::System::turning_at(const Matrix &at) const {
  return (at.col(0).array() < 0).select(turning, 0.0);
}

/// One linear solve, contact and stick being those of the pressures `start`, and the axes those of
/// the coefficients `state` where contact follows them.
void ReducedNitsche::System::predict(const Vector &start, const Vector &state) {
  if (start.size() != functionals.cols()) { // from u = 0
    set(Vector::Zero(u.size()));
    bounds = bounds_at(pressures);
    return;
  }
  Matrix at = Matrix::Zero(points, 2);
  at.reshaped().head(start.size()) = start;
  bounds = bounds_at(at);
  turn_to(state);
  const Vector d = weighted(&PointTerm::curvature, at);
  const Vector forces = weighted(&PointTerm::slope, at) + d.cwiseProduct(offsets - start);
  Matrix tangent = tangent_at(at);
  if (!cholesky_in_place(tangent)) throw failure(tangent_not_definite);
  Vector right = quadratic.f - functionals * forces;
  if (!at_rest.facing.empty())
    right += along_tau * turning_at(at).cwiseProduct(along_tau.transpose() * state);
  set(cholesky_solve(tangent, right));
  bounds = bounds_at(pressures);
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
    NitscheLine line{weights, gamma, pressures, Matrix::Zero(points, 2), bounds};
    line.change.reshaped().head(functionals.cols()) = functionals.transpose() * d;
    double of_turning = 0;
    if (!at_rest.facing.empty())
      of_turning = turning_at(pressures).dot((along_tau.transpose() * d).cwiseAbs2());
    const double t = line_minimum((quadratic.a_gamma * u - quadratic.f).dot(d),
                                  d.dot(quadratic.a_gamma * d) + of_turning, line);
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
    bounds = bounds_at(pressures);
    const Vector r = residual();
    if (relative <= residual_accuracy) return step;
    if (step > 0 && relative <= round_off && relative > 0.1 * before) return step;
    before = relative;
    std::vector<Index> slipping; // there the bound moves with P_n
    std::vector<double> rates;
    for (Index i = 0; i < points; ++i) {
      const NitscheLaw &law = laws[i];
      const double shear = pressures(i, 1);
      if (law.law != FrictionLaw::coulomb || !(std::abs(shear) > bounds[i]) || pressures(i, 0) >= 0)
        continue;
      slipping.push_back(i);
      rates.push_back(-std::copysign(law.value, shear) * weights[i] / gamma[i]);
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
      bounds = bounds_at(pressures);
      if (residual().norm() < r.norm()) break;
    }
  }
  return std::nullopt;
}

/// From the last iterate to the answer. Returns the steps.
int ReducedNitsche::System::settle() {
  if (std::ranges::none_of(laws, &NitscheLaw::moves)) return minimise();
  int steps = 0;
  if (std::ranges::any_of(laws, [](auto &law) { return law.law == FrictionLaw::coulomb; })) {
    if (const std::optional<int> more = follow_bound()) return *more;
    steps = most_full_steps;
  }
  for (int loop = 0; loop < most_loops; ++loop) {
    const Vector before = u;
    bounds = bounds_at(pressures);
    steps += minimise();
    bounds = bounds_at(pressures);
    (void)residual();
    if ((u - before).norm() <= bound_accuracy * u.norm() && relative <= round_off) return steps;
  }
  throw failure("the bound of friction did not settle in " + std::to_string(most_loops) +
                " loops: is the friction coefficient large?");
}

} // namespace rbvi
