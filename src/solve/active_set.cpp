#include "rbvi/law/friction/several_answers.hpp"
#include "rbvi/law/lcp.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/linear/complement.hpp"
#include "rbvi/solve/methods.hpp"

#include <numeric>

namespace rbvi {

namespace {

constexpr Index block = 128; ///< right-hand sides at a time: bounds the memory

/// E^T A^-1 E loads, contact dofs x loads.cols().
Matrix responses(KSP ksp, const Trace &trace, Mat a, const Matrix &loads) {
  const Handle<Mat> rhs = extension(trace, loads, a);
  Handle<Mat> response;
  RBVI_CALL(MatDuplicate(rhs.get(), MAT_DO_NOT_COPY_VALUES, response.put()));
  RBVI_CALL(KSPMatSolve(ksp, rhs.get(), response.get()));
  return restrict_to(trace, response.get());
}

} // namespace

Handle<Vec> reaction_rhs(const Trace &trace, const Operators &op, const Vector &lambda) {
  Handle<Vec> rhs;
  RBVI_CALL(VecDuplicate(op.f, rhs.put()));
  RBVI_CALL(VecCopy(op.f, rhs.get()));
  const Vector reaction = -(op.b.transpose() * lambda);
  add_extension(trace, reaction, rhs.get());
  return rhs;
}

Matrix condensed_columns(KSP ksp, const Trace &trace, const Operators &op,
                         const std::vector<Index> &which) {
  Matrix columns(op.b.rows(), std::ssize(which));
  for (Index first = 0; first < columns.cols(); first += block) {
    const Index count = std::min(block, columns.cols() - first);
    Matrix loads = Matrix::Zero(op.b.cols(), count);
    for (Index k = 0; k < count; ++k)
      loads.col(k) = op.b.row(which[first + k]).transpose();
    columns.middleCols(first, count) = op.b * responses(ksp, trace, op.a, loads);
  }
  return columns;
}

void Compliance::require(KSP ksp, const Trace &trace, Mat a, const std::vector<Index> &contact_dofs,
                         const Groups *groups) {
  slot_.resize(trace.size, -1);
  std::vector<Index> fresh;
  for (const Index dof : contact_dofs)
    if (slot_[dof] < 0) fresh.push_back(dof);
  const Index needed = count_ + std::ssize(fresh);
  if (needed > columns_.cols())
    columns_.conservativeResize(trace.size, std::min<Index>(trace.size, 2 * needed));
  auto made = columns_.middleCols(count_, std::ssize(fresh));
  const auto fill = [&](Index first, Index end) {
    for (; first < end; first += block) {
      const Index count = std::min(block, end - first);
      Matrix loads = Matrix::Zero(trace.size, count);
      for (Index k = 0; k < count; ++k)
        loads(fresh[first + k], k) = 1;
      made.middleCols(first, count) = responses(ksp, trace, a, loads);
    }
  };
  if (groups == nullptr) {
    fill(0, made.cols());
  } else {
    made.setZero();
    const Index share = made.cols(), mine = groups->mine(), all = groups->count();
    fill(share * mine / all, share * (mine + 1) / all);
    over_ranks(groups->across(), MPI_SUM, made);
  }
  for (const Index dof : fresh)
    slot_[dof] = count_++;
}

void Compliance::require_all(const Trace &trace, Mat a, const Groups *groups) {
  if (groups == nullptr) {
    columns_ = compliance_by_complement(a, trace);
  } else {
    columns_.resize(trace.size, trace.size);
    collectively(groups->across(), [&] { // which the first group does not talk on
      if (groups->mine() == 0) columns_ = compliance_by_complement(a, trace);
    });
    MPI_Bcast(columns_.data(), static_cast<int>(columns_.size()), MPI_DOUBLE, 0, groups->across());
  }
  count_ = trace.size;
  slot_.resize(count_);
  std::iota(slot_.begin(), slot_.end(), Index{0});
}

Matrix Compliance::condensed_columns(KSP ksp, const Trace &trace, const Operators &op,
                                     const std::vector<Index> &which) {
  std::vector<Index> touched;
  std::vector<Index> position(trace.size, -1);
  for (const Index row : which)
    for (SparseMatrix::InnerIterator entry(op.b, row); entry; ++entry)
      if (Index &at = position[entry.col()]; at < 0) {
        at = std::ssize(touched);
        touched.push_back(entry.col());
      }
  require(ksp, trace, op.a, touched);
  Matrix unit(trace.size, std::ssize(touched));
  for (std::size_t k = 0; k < touched.size(); ++k)
    unit.col(k) = columns_.col(slot_[touched[k]]);
  const Matrix constraint = op.b * unit;
  Matrix result = Matrix::Zero(op.b.rows(), std::ssize(which));
  for (std::size_t k = 0; k < which.size(); ++k)
    for (SparseMatrix::InnerIterator entry(op.b, which[k]); entry; ++entry)
      result.col(k) += entry.value() * constraint.col(position[entry.col()]);
  return result;
}

namespace {

template <class Found> void take(Found &&found, MethodResult &result) {
  result.lambda = std::move(found.x);
  result.active = std::move(found.active);
  result.iterations = found.iterations;
  result.columns = found.columns;
  result.converged = found.converged;
  result.reason = std::move(found.reason);
}

/// The multipliers, and room for the displacement.
MethodResult solve_condensed(const ColumnSource &columns, const Vector &q, const Operators &op,
                             const Start &start) {
  MethodResult result;
  RBVI_CALL(VecDuplicate(op.f, result.free_u.put()));
  if (!op.laws.has_tangents()) {
    take(solve_lcp(columns, q, start.active), result);
  } else {
    FrictionAnswer found = friction_answer(columns, q, op.laws, start.lambda, true);
    if (found.has_others) found.reason += ", but the law of friction has other answers";
    result.start = std::move(found.start);
    take(std::move(found), result);
  }
  return result;
}

} // namespace

MethodResult solve_active_set(KSP ksp, const Trace &trace, const Operators &op, const Start &start,
                              Compliance *kept) {
  Vector q = op.g;
  PetscReal load = 0;
  RBVI_CALL(VecNorm(op.f, NORM_INFINITY, &load));
  if (load > 0) {
    Handle<Vec> u;
    RBVI_CALL(VecDuplicate(op.f, u.put()));
    solve_linear(ksp, op.f, u.get());
    q -= op.b * restrict_to(trace, u.get());
  }
  MethodResult result = solve_condensed(
      [&](const std::vector<Index> &which) {
        return kept != nullptr ? kept->condensed_columns(ksp, trace, op, which)
                               : condensed_columns(ksp, trace, op, which);
      },
      q, op, start);
  if (result.lambda.size() == 0) return result; // not converged: there is no displacement either
  solve_linear(ksp, reaction_rhs(trace, op, result.lambda).get(), result.free_u.get());
  return result;
}

MethodResult solve_active_set(ScaledPart &part, const Operators &op, const Start &start) {
  MethodResult result = solve_condensed(
      [&](const std::vector<Index> &which) { return part.columns(which); }, op.g, op, start);
  if (result.lambda.size() > 0) part.displacement(result.lambda, result.free_u.get());
  return result;
}

} // namespace rbvi
