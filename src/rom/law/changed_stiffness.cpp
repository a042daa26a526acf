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
  if (!cholesky_in_place(l_)) throw stiffness_not_definite();
  Matrix range = model.a_change.range;
  solve_fixed(range);
  ThinQr qr = thin_qr(range);
  u_ = std::move(qr.q);
  along_ = std::move(qr.r);
}

double ChangedStiffness::set(const Vector &theta) {
  const StiffnessChange &change = model_.a_change;
  scale_ = change.scales.dot(theta);
  if (!(scale_ > 0)) throw stiffness_not_definite();
  core_ = unpacked(change.cores * theta, change.rank());
  const Index size = along_.rows();
  const Matrix k = along_ * (core_ / scale_) * along_.transpose();
  const EigenPairs pairs = eigen_pairs(Matrix::Identity(size, size) + k);
  if (!(pairs.values[0] > 0)) throw stiffness_not_definite();
  const Vector inverse_roots = pairs.values.cwiseSqrt().cwiseInverse();
  inverse_ =
      pairs.vectors * (inverse_roots.array() - 1).matrix().asDiagonal() * pairs.vectors.transpose();
  return scale_;
}

void ChangedStiffness::solve_fixed(Matrix &x) const {
  solve_lower(l_, x);
}

void ChangedStiffness::solve_change(Matrix &x) const {
  const Matrix part = inverse_ * (u_.transpose() * x);
  x.noalias() += u_ * part;
}

void ChangedStiffness::solve_root(Vector &x) const {
  solve_lower(l_, x);
  x += u_ * (inverse_ * (u_.transpose() * x));
}

void ChangedStiffness::solve_transposed(Vector &x) const {
  x += u_ * (inverse_ * (u_.transpose() * x));
  solve_lower_transposed(l_, x);
}

Vector ChangedStiffness::times(const Vector &u) const {
  const Matrix &q = model_.a_change.range;
  return scale_ * (a_.selfadjointView<Eigen::Lower>() * u) + q * (core_ * (q.transpose() * u));
}

} // namespace rbvi
