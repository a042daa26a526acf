#include "rbvi/mor/stability.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/par/small_svd.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace rbvi {

namespace {

/// All that inf-sup constants, c and sigma are read off.
Vector stretches(const Matrix &matrix) {
  return singular_values(matrix, "infsup_");
}

} // namespace

RieszSpace make_riesz_space(Mat product, const Trace &trace, const std::vector<Index> &dofs,
                            const Matrix &loads) {
  constexpr double dependent = 1e-6;
  RieszSpace space;
  space.dofs = dofs;
  space.trace = dofs.empty() ? trace : part_of(trace, dofs);
  space.solver = std::make_shared<ResponseSolver>(product, space.trace, "v_");
  const Index size = space.trace.size;
  if (loads.cols() > 0 && 2 * loads.cols() <= size) {
    const Matrix gram = loads.transpose() * space.solver->responses(loads);
    space.factor = (gram + gram.transpose()) / 2;
    const bool definite = cholesky_in_place(space.factor);
    const auto pivots = space.factor.diagonal();
    if (definite && pivots.minCoeff() > dependent * pivots.maxCoeff()) {
      space.factor.triangularView<Eigen::StrictlyUpper>().setZero();
      space.loads = loads;
      return space;
    }
  }
  const Matrix traces = space.solver->responses(Matrix::Identity(size, size));
  space.factor =
      cholesky((traces + traces.transpose()) / 2, "the inverse V product on the contact dofs");
  return space;
}

std::vector<int> append_representers(const RieszSpace &space, const Matrix &representers,
                                     LinearBasis &basis, double tolerance) {
  const bool units = space.loads.size() == 0;
  return append_fields(*space.solver, units ? representers : Matrix(space.loads * representers),
                       basis, tolerance);
}

Matrix mode_coordinates(const RieszSpace &space, const LinearBasis &modes) {
  const PetscInt count = modes.size();
  const Index contact = space.factor.rows();
  Matrix coordinates = Matrix::Zero(contact + count, count);
  if (count == 0) return coordinates;
  Matrix top = restrict_to(space.trace, BorrowedColumns(modes.columns.get()).get());
  if (space.loads.size() > 0) top = (space.loads.transpose() * top).eval();
  solve_lower(space.factor, top);
  const EigenPairs rest = eigen_pairs(Matrix::Identity(count, count) - top.transpose() * top);
  if (!(rest.values(0) > -1e-8))
    throw failure("the primal basis is not orthonormal in the V product of the supremizers");
  const Vector roots = rest.values.cwiseMax(0).cwiseSqrt();
  coordinates.topRows(contact) = top;
  coordinates.bottomRows(count) = roots.asDiagonal() * rest.vectors.transpose();
  return coordinates;
}

Matrix orthonormal_dual_basis(const Matrix &generators, const SparseMatrix &w_product,
                              double tolerance) {
  OrthonormalColumns basis(&w_product);
  basis.append(generators, tolerance);
  return basis.columns();
}

Matrix supremizer_coordinates(const RieszSpace &space, const SparseMatrix &b_contact,
                              const Matrix &x) {
  constexpr double of_multiples = 1e-9;
  Matrix forces = b_contact.transpose() * x;
  if (!space.dofs.empty()) forces = forces(space.dofs, Eigen::all).eval();
  if (space.loads.size() > 0) {
    const double scale = forces.cwiseProduct(space.loads).sum() / space.loads.squaredNorm();
    if (!((forces - scale * space.loads).norm() <= of_multiples * forces.norm()))
      throw failure("supremizers of other multipliers than the loads");
    return scale * space.factor.transpose();
  }
  return space.factor.transpose().triangularView<Eigen::Upper>() * forces;
}

double infsup_constant(const Matrix &primal, const Matrix &supremizers) {
  if (supremizers.cols() == 0) return std::numeric_limits<double>::infinity();
  if (primal.cols() < supremizers.cols()) return 0;
  const Matrix pairing = primal.topRows(supremizers.rows()).transpose() * supremizers;
  return stretches(pairing)(supremizers.cols() - 1);
}

namespace {

// T(mu) eta lies in V_N + S_R(mu), so the supremum over that space is the norm of T(mu) eta.
double smallest_stretch(const Matrix &supremizers) {
  if (supremizers.cols() == 0) return std::numeric_limits<double>::infinity();
  if (supremizers.rows() < supremizers.cols()) return 0;
  return stretches(supremizers)(supremizers.cols() - 1);
}

/// The triangular factor of a matrix that gets more rows.
void add_rows(Matrix &factor, const Matrix &rows) {
  Matrix stacked(factor.rows() + rows.rows(), rows.cols());
  stacked << factor, rows;
  if (stacked.rows() <= stacked.cols()) {
    factor = stacked;
    return;
  }
  factor = triangular_factor(stacked);
}

} // namespace

InfSup infsup_constants(const RieszSpace &space, const SparseMatrix &b_contact, const Matrix &modes,
                        const Matrix &enriched, const Matrix &x) {
  const Matrix supremizers = supremizer_coordinates(space, b_contact, x);
  return {.hf = std::numeric_limits<double>::quiet_NaN(),
          .dec = infsup_constant(modes, supremizers),
          .on = smallest_stretch(supremizers),
          .off = infsup_constant(enriched, supremizers)};
}

std::vector<StabilityStep> stability_path(const Matrix &coordinates, Index modes,
                                          const std::vector<int> &counts,
                                          const Matrix &supremizers) {
  const Matrix range = orthonormal_range(supremizers);
  const auto contact = coordinates.topRows(supremizers.rows());
  const Matrix work = contact.transpose() * supremizers, cosines = contact.transpose() * range;
  const Vector stretch = stretches(supremizers);
  const double on = smallest_stretch(supremizers);
  Matrix work_factor(0, work.cols()), cosine_factor(0, range.cols());
  Index seen = 0;
  std::vector<StabilityStep> steps;
  for (const int count : counts) {
    const Index fresh = modes + count - seen;
    add_rows(work_factor, work.middleRows(seen, fresh));
    add_rows(cosine_factor, cosines.middleRows(seen, fresh));
    seen += fresh;
    const double cosine = std::min(smallest_stretch(cosine_factor), 1.0);
    StabilityStep step{};
    step.off = smallest_stretch(work_factor);
    step.bound.sigma = std::sqrt((1 - cosine) * (1 + cosine));
    step.bound.c = stretch.size() > 0 ? stretch(0) : 0;
    step.bound.on = on;
    step.bound.sharp = cosine * on;
    step.bound.classic = (on - step.bound.c * step.bound.sigma) / (1 + step.bound.sigma);
    steps.push_back(step);
  }
  return steps;
}

} // namespace rbvi
