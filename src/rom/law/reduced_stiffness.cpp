#include "rbvi/rom/law/reduced_stiffness.hpp"

#include "not_definite.hpp"
#include "rbvi/rom/model/affine_coefficients.hpp"
#include "rbvi/rom/model/packed.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <utility>

namespace rbvi {

namespace {

FullMu corner(const ParameterSpace &space, double Parameter::*bound) {
  Mu mu;
  for (int i = 0; i < space.size(); ++i)
    mu.push_back(space.at(i).*bound);
  return expand(space, mu);
}

} // namespace

Matrix enriched_subspace(const Matrix &b, Index modes) {
  const Index n = b.cols(), added = std::min(n - modes, b.rows());
  Matrix subspace = Matrix::Zero(n, modes + added);
  subspace.topLeftCorner(modes, modes).setIdentity();
  subspace.bottomRightCorner(n - modes, added) = thin_qr(b.rightCols(n - modes).transpose()).q;
  return subspace;
}

ReducedStiffness::ReducedStiffness(const ReducedModel &model, const Scene &scene)
    : model_(model), scene_(scene) {
  if (model.a.size() <= 2 && !model.online_enriched) find_common_eigenvectors();
}

/// The common eigenvectors of A_N at two corners of the box, or of its only term.
void ReducedStiffness::find_common_eigenvectors() {
  const AffineTerms &a = model_.a;
  const Index n = model_.primal_size();
  const auto stiffness_at = [&](const FullMu &mu) {
    return unpacked(a.reduced * affine_coefficients(a, scene_.a, scene_, mu), n);
  };
  const Matrix first = stiffness_at(corner(scene_.parameters, &Parameter::lower));
  const EigenPairs pairs =
      a.size() == 1
          ? eigen_pairs(first)
          : eigen_pairs(stiffness_at(corner(scene_.parameters, &Parameter::upper)), first);
  if (pairs.values.size() == 0) return;
  Matrix eigenvalues(n, a.size());
  for (Index q = 0; q < a.size(); ++q) {
    Matrix term = pairs.vectors.transpose() *
                  (unpacked(a.reduced.col(q), n).selfadjointView<Eigen::Lower>() * pairs.vectors);
    eigenvalues.col(q) = term.diagonal();
    term.diagonal().setZero();
    if (!(term.cwiseAbs().maxCoeff() <= 1e-10 * eigenvalues.col(q).cwiseAbs().maxCoeff())) return;
  }
  eigenvectors_ = pairs.vectors;
  eigenvalues_ = std::move(eigenvalues);
  b_.resize(model_.generators, n * model_.b.size());
  for (Index p = 0; p < model_.b.size(); ++p)
    b_.middleCols(p * n, n) =
        model_.b.reduced.col(p).reshaped(model_.generators, n) * eigenvectors_;
}

void ReducedStiffness::set(const FullMu &all_parameters) {
  std::vector<double> values = values_of_dependence(scene_.a, all_parameters);
  if (at_ == values) return;
  const Vector theta = affine_coefficients(model_.a, scene_.a, scene_, all_parameters);
  if (eigenvectors_.size() > 0) {
    diagonal_ = eigenvalues_ * theta;
    if (!(diagonal_.minCoeff() > 0)) throw stiffness_not_definite();
  } else {
    a_.resize(model_.primal_size(), model_.primal_size());
    unpack(model_.a.reduced * theta, a_);
    if (!model_.online_enriched) factorise(a_);
  }
  at_ = std::move(values);
}

void ReducedStiffness::factorise(const Matrix &stiffness) {
  lower_ = stiffness;
  if (!cholesky_in_place(lower_)) throw stiffness_not_definite();
}

void ReducedStiffness::restrict_to(Matrix subspace) {
  subspace_ = std::move(subspace);
  factorise(subspace_.transpose() * (a_.selfadjointView<Eigen::Lower>() * subspace_));
}

Vector ReducedStiffness::response(const Vector &theta_b, const Vector &x) const {
  const Index n = model_.primal_size();
  const bool turned = eigenvectors_.size() > 0;
  Vector load = Vector::Zero(n);
  for (Index p = 0; p < theta_b.size(); ++p) {
    const double *values = turned ? b_.data() + p * n * b_.rows() : model_.b.reduced.col(p).data();
    load.noalias() +=
        theta_b[p] * (Eigen::Map<const Matrix>(values, model_.generators, n).transpose() * x);
  }
  if (turned) return eigenvectors_ * load.cwiseQuotient(diagonal_);
  return response(load);
}

Vector ReducedStiffness::response(const Vector &load) const {
  if (model_.online_enriched)
    return subspace_ * cholesky_solve(lower_, subspace_.transpose() * load);
  if (eigenvectors_.size() == 0) return cholesky_solve(lower_, load);
  return eigenvectors_ * (eigenvectors_.transpose() * load).cwiseQuotient(diagonal_);
}

/// Of one term: its response to them.
Matrix ReducedStiffness::turned(const Matrix &loads) const {
  if (eigenvectors_.size() == 0) return loads;
  Matrix result = eigenvectors_.transpose() * loads;
  if (eigenvalues_.cols() == 1)
    result = eigenvectors_ * (eigenvalues_.cwiseInverse().asDiagonal() * result);
  return result;
}

Vector ReducedStiffness::response_of_turned(const Vector &load) const {
  if (eigenvectors_.size() == 0) return response(load);
  if (eigenvalues_.cols() == 1) return load * (eigenvalues_(0) / diagonal_[0]);
  return eigenvectors_ * load.cwiseQuotient(diagonal_);
}

Matrix ReducedStiffness::half_response(const Matrix &loads) const {
  if (eigenvectors_.size() > 0)
    return diagonal_.cwiseSqrt().cwiseInverse().asDiagonal() * (eigenvectors_.transpose() * loads);
  Matrix half = model_.online_enriched ? Matrix(subspace_.transpose() * loads) : loads;
  solve_lower(lower_, half);
  return half;
}

Vector ReducedStiffness::transposed_half_response(const Vector &half) const {
  if (eigenvectors_.size() > 0) return eigenvectors_ * half.cwiseQuotient(diagonal_.cwiseSqrt());
  Vector whole = half;
  solve_lower_transposed(lower_, whole);
  return model_.online_enriched ? Vector(subspace_ * whole) : whole;
}

} // namespace rbvi
