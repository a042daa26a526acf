#include "rbvi/solve/full_body.hpp"

#include "rbvi/par/collective.hpp"
#include "rbvi/solve/complement.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// F - B^T lambda. Collective.
Handle<Vec> reaction_rhs(const Trace &trace, const Operators &op, const Vector &lambda) {
  Handle<Vec> rhs;
  RBVI_CALL(VecDuplicate(op.f, rhs.put()));
  RBVI_CALL(VecCopy(op.f, rhs.get()));
  const Vector reaction = -(op.b.transpose() * lambda);
  add_extension(trace, reaction, rhs.get());
  return rhs;
}

} // namespace

void FactoredBody::set(Mat a) {
  a_ = a;
  if (last_ == ColumnsLast::for_all_mu) return;
  forget();
  nodal.reset();
}

Matrix FactoredBody::responses(const Matrix &loads) const {
  const Handle<Mat> rhs = extension(trace_, loads, a_);
  Handle<Mat> response;
  RBVI_CALL(MatDuplicate(rhs.get(), MAT_DO_NOT_COPY_VALUES, response.put()));
  RBVI_CALL(KSPMatSolve(ksp_, rhs.get(), response.get()));
  return restrict_to(trace_, response.get());
}

Matrix FactoredBody::moved(const SparseMatrix &b, const std::vector<Index> &which) {
  if (last_ != ColumnsLast::for_one_b) return FullBody::moved(b, which);
  Matrix loads = Matrix::Zero(size(), std::ssize(which));
  for (std::size_t k = 0; k < which.size(); ++k)
    loads.col(k) = b.row(which[k]).transpose();
  return loads.cols() > 0 ? responses(loads) : loads;
}

void FactoredBody::make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) {
  constexpr Index block = 128; // right-hand sides at a time: bounds the memory
  const Index share = columns.cols();
  Index first = 0, end = share;
  if (groups_ != nullptr) {
    columns.setZero();
    first = share * groups_->mine() / groups_->count();
    end = share * (groups_->mine() + 1) / groups_->count();
  }
  for (; first < end; first += block) {
    const Index count = std::min(block, end - first);
    Matrix loads = Matrix::Zero(size(), count);
    for (Index k = 0; k < count; ++k)
      loads(dofs[first + k], k) = 1;
    columns.middleCols(first, count) = responses(loads);
  }
  if (groups_ != nullptr) over_ranks(groups_->across(), MPI_SUM, columns);
}

void FactoredBody::require(const std::vector<Index> &dofs, const Groups &groups) {
  groups_ = &groups;
  try {
    require(dofs);
  } catch (...) {
    groups_ = nullptr;
    throw;
  }
  groups_ = nullptr;
}

void FactoredBody::require_all(const Groups *groups) {
  if (groups == nullptr) return set_all(compliance_by_complement(a_, trace_));
  Matrix columns(size(), size());
  collectively(groups->across(), [&] { // which the first group does not talk on
    if (groups->mine() == 0) columns = compliance_by_complement(a_, trace_);
  });
  MPI_Bcast(columns.data(), static_cast<int>(columns.size()), MPI_DOUBLE, 0, groups->across());
  set_all(std::move(columns));
}

Vector FactoredBody::free(const Operators &op) {
  PetscReal load = 0;
  RBVI_CALL(VecNorm(op.f, NORM_INFINITY, &load));
  if (load == 0) return Vector::Zero(size());
  Handle<Vec> u;
  RBVI_CALL(VecDuplicate(op.f, u.put()));
  (void)solve_refined(ksp_, op.f, u.get());
  return restrict_to(trace_, u.get());
}

double FactoredBody::displacement(const Operators &op, const Vector &lambda, Vec u) {
  return solve_refined(ksp_, reaction_rhs(trace_, op, lambda).get(), u);
}

} // namespace rbvi
