#include "nitsche_system.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/quadrature.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <cmath>

namespace rbvi {

namespace {

constexpr double accuracy = 1e-13;       ///< of the residual, relative
constexpr double round_off = 1e-9;       ///< below it the residual may stagnate
constexpr double bound_accuracy = 1e-12; ///< change of u by new bounds
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
      parts.push_back(
          {cell,
           {},
           basis_on(cells[static_cast<std::size_t>(cell)], model.contact_trace).transpose()});
    parts.back().points.emplace_back(number % 4, factor);
  }
  points = static_cast<Index>(chosen.size());
  u = Vector::Zero(model.primal_size());
}

void ReducedNitsche::System::set_points(const NitscheCurve &curve, const FullMu &all_parameters) {
  const bool friction = law.law != FrictionLaw::none;
  functionals.resize(u.size(), friction ? 2 * points : points);
  offsets.resize(functionals.cols());
  weights.resize(points);
  gamma.resize(points);
  Index next = 0;
  for (const Part &part : parts) {
    const CurveCell &beside = curve.cells[static_cast<std::size_t>(part.cell)];
    const CurveCellAtMu at = curve_cell_at(curve, all_parameters, beside);
    const auto count = static_cast<Index>(part.points.size());
    Eigen::Matrix<double, 12, Eigen::Dynamic> local(12, friction ? 2 * count : count);
    for (Index k = 0; k < count; ++k) {
      const auto [q, factor] = part.points[static_cast<std::size_t>(k)];
      const EdgePoint rule = edge_quadrature[static_cast<std::size_t>(q)];
      const NitschePoint point = nitsche_point(curve.scene, curve.support, all_parameters, at.cell,
                                               beside.edge, at.material, rule.s);
      local.col(k) = point.sigma_n - at.gamma * point.n;
      offsets[next + k] = at.gamma * point.gap;
      if (friction) {
        local.col(count + k) = point.sigma_tau - at.gamma * point.tau;
        offsets[points + next + k] = -at.gamma * point.slip;
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

void ReducedNitsche::System::set(const Vector &coefficients) {
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

/// Sets `relative`.
Vector ReducedNitsche::System::residual() {
  const Vector au = quadratic.a_gamma * u,
               terms = functionals * weighted(&PointTerm::slope, pressures);
  const Vector r = au + terms - quadratic.f;
  const double scale = au.norm() + terms.norm() + quadratic.f.norm();
  relative = scale > 0 ? r.norm() / scale : 0;
  return r;
}

Matrix ReducedNitsche::System::tangent_at(const Matrix &at) const {
  const Vector d = weighted(&PointTerm::curvature, at);
  std::vector<Index> active;
  for (Index i = 0; i < d.size(); ++i)
    if (d[i] != 0) active.push_back(i);
  const Matrix part = functionals(Eigen::all, active);
  return quadratic.a_gamma + (part * d(active).asDiagonal()) * part.transpose();
}

/// One linear solve, contact and stick being those of the pressures `start`.
void ReducedNitsche::System::predict(const Vector &start) {
  if (start.size() != functionals.cols()) { // from u = 0
    set(Vector::Zero(u.size()));
    bounds = nitsche_bounds(pressures, law);
    return;
  }
  Matrix at = Matrix::Zero(points, 2);
  at.reshaped().head(start.size()) = start;
  bounds = nitsche_bounds(at, law);
  const Vector d = weighted(&PointTerm::curvature, at);
  const Vector forces = weighted(&PointTerm::slope, at) + d.cwiseProduct(offsets - start);
  const Eigen::LLT<Matrix> factor(tangent_at(at));
  if (factor.info() != Eigen::Success) throw failure(tangent_not_definite);
  set(factor.solve(quadratic.f - functionals * forces));
  bounds = nitsche_bounds(pressures, law);
}

/// Newton's method with bounds as they are. Returns the steps.
int ReducedNitsche::System::minimise() {
  double before = 1;
  for (int step = 0; step <= most_steps; ++step) {
    const Vector r = residual();
    if (relative <= accuracy) return step;
    if (step > 0 && relative <= round_off && relative > 0.1 * before) return step;
    before = relative;
    const Eigen::LLT<Matrix> factor(tangent_at(pressures));
    if (factor.info() != Eigen::Success) throw failure(tangent_not_definite);
    const Vector d = -factor.solve(r);
    NitscheLine line{weights, gamma, pressures, Matrix::Zero(points, 2), bounds};
    line.change.reshaped().head(functionals.cols()) = functionals.transpose() * d;
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
    bounds = nitsche_bounds(pressures, law);
    const Vector r = residual();
    if (relative <= accuracy) return step;
    if (step > 0 && relative <= round_off && relative > 0.1 * before) return step;
    before = relative;
    std::vector<Index> slipping; // there the bound moves with P_n
    std::vector<double> rates;
    for (Index i = 0; i < points; ++i) {
      const double shear = pressures(i, 1);
      if (!(std::abs(shear) > bounds[i]) || pressures(i, 0) >= 0) continue;
      slipping.push_back(i);
      rates.push_back(-std::copysign(law.value, shear) * weights[i] / gamma[i]);
    }
    const Vector rate = Eigen::Map<const Vector>(rates.data(), static_cast<Index>(rates.size()));
    const Matrix normal = functionals.leftCols(points)(Eigen::all, slipping);
    const Matrix shear = functionals.rightCols(points)(Eigen::all, slipping);
    Matrix tangent = tangent_at(pressures);
    tangent.noalias() += (shear * rate.asDiagonal()) * normal.transpose();
    const Vector start = u, d = -Eigen::PartialPivLU<Matrix>(tangent).solve(r);
    if (!d.allFinite()) return std::nullopt;
    for (double t = 1; t >= shortest_step; t /= 2) { // the shortest one is taken whatever it gives
      set(start + t * d);
      bounds = nitsche_bounds(pressures, law);
      if (residual().norm() < r.norm()) break;
    }
  }
  return std::nullopt;
}

/// From the last iterate to the answer. Returns the steps.
int ReducedNitsche::System::settle() {
  if (!law.moves()) return minimise();
  int steps = 0;
  for (int loop = 0; loop < most_loops; ++loop) {
    const Vector before = u;
    if (law.law == FrictionLaw::coulomb) {
      if (const std::optional<int> more = follow_bound()) return steps + *more;
      steps += most_full_steps;
    }
    bounds = nitsche_bounds(pressures, law);
    steps += minimise();
    bounds = nitsche_bounds(pressures, law);
    if ((u - before).norm() <= bound_accuracy * u.norm()) {
      (void)residual();
      return steps;
    }
  }
  throw failure("the bound of friction did not settle in " + std::to_string(most_loops) +
                " loops: is the friction coefficient large?");
}

} // namespace rbvi
