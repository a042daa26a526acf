#include "rbvi/rom/law/changed_stiffness.hpp"

#include "not_definite.hpp"
#include "rbvi/rom/model/packed.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>

namespace rbvi {

ChangedStiffness::ChangedStiffness(const ReducedModel &model)
    : model_(model), a_(model.primal_size(), model.primal_size()) {
  unpack(model.a.reduced.col(0), a_);
  l_ = a_;
  const Eigen::LLT<Eigen::Ref<Matrix>> factor(l_);
  if (factor.info() != Eigen::Success) throw stiffness_not_definite();
  Matrix range = model.a_change.range;
  solve_fixed(range);
  const Eigen::HouseholderQR<Matrix> qr(range);
  const Index size = std::min(range.rows(), range.cols()); // of a leading part fewer rows
  u_ = qr.householderQ() * Matrix::Identity(range.rows(), size);
  along_ = qr.matrixQR().topRows(size).triangularView<Eigen::Upper>();
}

double ChangedStiffness::set(const Vector &theta) {
  const StiffnessChange &change = model_.a_change;
  scale_ = change.scales.dot(theta);
  if (!(scale_ > 0)) throw stiffness_not_definite();
  core_ = unpacked(change.cores * theta, change.rank());
  const Index size = along_.rows();
  const Matrix k = along_ * (core_ / scale_) * along_.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(Matrix::Identity(size, size) + k);
  if (solver.info() != Eigen::Success || !(solver.eigenvalues()[0] > 0))
    throw stiffness_not_definite();
  const Vector inverse_roots = solver.eigenvalues().cwiseSqrt().cwiseInverse();
  inverse_ = solver.eigenvectors() * (inverse_roots.array() - 1).matrix().asDiagonal() *
             solver.eigenvectors().transpose();
  return scale_;
}

void ChangedStiffness::solve_fixed(Matrix &x) const {
  l_.triangularView<Eigen::Lower>().solveInPlace(x);
}

void ChangedStiffness::solve_change(Matrix &x) const {
  const Matrix part = inverse_ * (u_.transpose() * x);
  x.noalias() += u_ * part;
}

void ChangedStiffness::solve_root(Vector &x) const {
  l_.triangularView<Eigen::Lower>().solveInPlace(x);
  x += u_ * (inverse_ * (u_.transpose() * x));
}

void ChangedStiffness::solve_transposed(Vector &x) const {
  x += u_ * (inverse_ * (u_.transpose() * x));
  l_.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
}

Vector ChangedStiffness::times(const Vector &u) const {
  const Matrix &q = model_.a_change.range;
  return scale_ * (a_.selfadjointView<Eigen::Lower>() * u) + q * (core_ * (q.transpose() * u));
}

} // namespace rbvi
