#include "rbvi/model/reduced_body.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/packed.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rbvi {

namespace {

Error stiffness_not_definite() {
  return failure("the reduced stiffness is not positive definite: reduce again with a smaller "
                 "-eim_tolerance, or stay closer to the training set");
}

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

ReducedBody::ReducedBody(const ReducedModel &model, const Scene &scene)
    : model_(model), scene_(scene) {
  if (model.body.a_change.rank() > 0)
    find_change();
  else if (model.body.a.size() <= 2 && !model.body.online_enriched)
    find_common_eigenvectors();
  prepared_b_.resize(model.primal_size(), model.contact.generators * model.contact.b.size());
  for (Index p = 0; p < model.contact.b.size(); ++p)
    prepared_b_.middleCols(p * model.contact.generators, model.contact.generators) =
        prepared(model.contact.b.reduced.col(p)
                     .reshaped(model.contact.generators, model.primal_size())
                     .transpose());
  if (only_scales()) unit_responses_ = prepared(model.body.f.reduced);
  turned_f_ = turned(model.body.f.reduced);
  turned_springs_ = turned(model.body.springs);
}

void ReducedBody::find_change() {
  a_.resize(model_.primal_size(), model_.primal_size());
  unpack(model_.body.a.reduced.col(0), a_);
  l_ = a_;
  if (!cholesky_in_place(l_)) throw stiffness_not_definite();
  ThinQr qr = thin_qr(turned(model_.body.a_change.range));
  u_ = std::move(qr.q);
  along_ = std::move(qr.r);
}

/// The common eigenvectors of A_N at two corners of the box, or of its only term.
void ReducedBody::find_common_eigenvectors() {
  const AffineTerms &a = model_.body.a;
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
}

Matrix ReducedBody::turned(const Matrix &loads) const {
  if (loads.size() == 0) return Matrix(model_.primal_size(), loads.cols());
  if (eigenvectors_.size() > 0) return eigenvectors_.transpose() * loads;
  Matrix result = loads;
  if (l_.size() > 0) solve_lower(l_, result);
  return result;
}

Matrix ReducedBody::prepared(const Matrix &loads) const {
  if (!only_scales() || loads.size() == 0) return turned(loads);
  return eigenvectors_ * (eigenvalues_.cwiseInverse().asDiagonal() * turned(loads));
}

void BodyAtMu::set(const FullMu &mu, const Vector &beta) {
  mu_ = mu;
  beta_ = beta;
  if (body_.model_.body.online_enriched) {
    subspace_.resize(0, 0);
    lower_.resize(0, 0);
    ++root_number_;
  }
  std::vector<double> values = values_of_dependence(body_.scene_.a, mu);
  if (at_ == values) return;
  at_.reset();
  theta_ = affine_coefficients(body_.model_.body.a, body_.scene_.a, body_.scene_, mu);
  a_.resize(0, 0);
  lower_.resize(0, 0);
  const Matrix &eigenvalues = body_.eigenvalues_;
  if (eigenvalues.size() > 0) {
    scale_ = body_.only_scales() ? std::abs(theta_[0]) : 1;
    const Vector diagonal = eigenvalues * (theta_ / scale_);
    if (!(diagonal.minCoeff() > 0)) throw stiffness_not_definite();
    inverse_roots_ = diagonal.cwiseSqrt().cwiseInverse();
  } else if (body_.l_.size() > 0) {
    set_change();
  }
  if (!body_.only_scales() || root_number_ == 0) ++root_number_;
  at_ = std::move(values);
}

void BodyAtMu::set_change() {
  const StiffnessChange &change = body_.model_.body.a_change;
  scale_ = change.scales.dot(theta_);
  if (!(scale_ > 0)) throw stiffness_not_definite();
  core_ = unpacked(change.cores * theta_, change.rank());
  const Index size = body_.along_.rows();
  const Matrix k = body_.along_ * (core_ / scale_) * body_.along_.transpose();
  const EigenPairs pairs = eigen_pairs(Matrix::Identity(size, size) + k);
  if (!(pairs.values[0] > 0)) throw stiffness_not_definite();
  const Vector inverse_roots = pairs.values.cwiseSqrt().cwiseInverse();
  inverse_ =
      pairs.vectors * (inverse_roots.array() - 1).matrix().asDiagonal() * pairs.vectors.transpose();
}

void BodyAtMu::restrict_to(Matrix subspace) {
  subspace_ = std::move(subspace);
  lower_.resize(0, 0);
  ++root_number_;
}

Vector BodyAtMu::restricted(const Vector &load) const {
  return subspace_.size() > 0 ? Vector(subspace_.transpose() * load) : load;
}

Vector BodyAtMu::load() const {
  if (beta_.size() == 0) return given_load();
  const Vector theta = spring_coefficients(body_.model_, body_.scene_, mu_);
  return given_load() + body_.model_.body.springs * theta.cwiseProduct(beta_);
}

Matrix BodyAtMu::free_motions() const {
  const Matrix half = half_response_to_springs();
  Matrix motions(body_.model_.primal_size(), half.cols());
  for (Index k = 0; k < motions.cols(); ++k)
    motions.col(k) = transposed_half_response(half.col(k));
  return motions;
}

Vector BodyAtMu::given_load() const {
  const AffineTerms &f = body_.model_.body.f;
  if (!has_load()) return Vector::Zero(body_.model_.primal_size());
  return f.reduced * affine_coefficients(f, body_.scene_.f, body_.scene_, mu_);
}

const Matrix &BodyAtMu::lower_triangle() const {
  if (a_.size() == 0) stiffness_of(body_.model_, theta_, a_);
  return a_;
}

const Matrix &BodyAtMu::factor() const {
  if (lower_.size() > 0) return lower_;
  const Matrix &a = lower_triangle();
  if (subspace_.size() > 0)
    lower_ = subspace_.transpose() * (a.selfadjointView<Eigen::Lower>() * subspace_);
  else
    lower_ = a;
  if (cholesky_in_place(lower_)) return lower_;
  lower_.resize(0, 0);
  throw stiffness_not_definite();
}

Matrix BodyAtMu::stiffness() const {
  return lower_triangle().selfadjointView<Eigen::Lower>();
}

Vector BodyAtMu::times(const Vector &u) const {
  if (body_.l_.size() == 0) return lower_triangle().selfadjointView<Eigen::Lower>() * u;
  const Matrix &q = body_.model_.body.a_change.range;
  return scale_ * (body_.a_.selfadjointView<Eigen::Lower>() * u) +
         q * (core_ * (q.transpose() * u));
}

Vector BodyAtMu::diagonal() const {
  return body_.l_.size() == 0 ? Vector(lower_triangle().diagonal())
                              : Vector(scale_ * body_.a_.diagonal());
}

Matrix BodyAtMu::half_response_of_turned(const Matrix &turned) const {
  return scaled_half_response_of_turned(turned) / std::sqrt(scale_);
}

Matrix BodyAtMu::scaled_half_response_of_turned(const Matrix &turned) const {
  if (inverse_roots_.size() > 0) return inverse_roots_.asDiagonal() * turned;
  if (inverse_.size() > 0) {
    const Matrix part = inverse_ * (body_.u_.transpose() * turned);
    return turned + body_.u_ * part;
  }
  Matrix half = subspace_.size() > 0 ? Matrix(subspace_.transpose() * turned) : turned;
  solve_lower(factor(), half);
  return half;
}

Matrix BodyAtMu::half_response(const Matrix &loads) const {
  return half_response_of_turned(body_.turned(loads));
}

Vector BodyAtMu::half_response_to_load() const {
  const AffineTerms &f = body_.model_.body.f;
  Vector turned = Vector::Zero(body_.model_.primal_size());
  if (has_load())
    turned = body_.turned_f_ * affine_coefficients(f, body_.scene_.f, body_.scene_, mu_);
  if (beta_.size() > 0)
    turned += body_.turned_springs_ *
              spring_coefficients(body_.model_, body_.scene_, mu_).cwiseProduct(beta_);
  return half_response_of_turned(turned);
}

Vector BodyAtMu::response_to_load() const {
  const Vector shares = load_shares();
  if (shares.size() > 0) return body_.unit_responses_ * shares;
  return transposed_half_response(half_response_to_load());
}

Vector BodyAtMu::load_shares() const {
  const AffineTerms &f = body_.model_.body.f;
  if (!body_.only_scales() || !has_load() || beta_.size() > 0) return {};
  return affine_coefficients(f, body_.scene_.f, body_.scene_, mu_) / theta_[0];
}

Matrix BodyAtMu::half_response_to_springs() const {
  return half_response_of_turned(body_.turned_springs_);
}

Vector BodyAtMu::transposed_half_response(const Vector &half) const {
  if (inverse_roots_.size() > 0)
    return body_.eigenvectors_ * (inverse_roots_ / std::sqrt(scale_)).cwiseProduct(half);
  Vector whole = half;
  if (inverse_.size() > 0) {
    whole += body_.u_ * (inverse_ * (body_.u_.transpose() * half));
    solve_lower_transposed(body_.l_, whole);
    return whole / std::sqrt(scale_);
  }
  solve_lower_transposed(factor(), whole);
  return subspace_.size() > 0 ? Vector(subspace_ * whole) : whole;
}

Vector BodyAtMu::response_of_prepared(const Vector &prepared) const {
  if (body_.only_scales()) return prepared / theta_[0];
  return transposed_half_response(half_response_of_turned(prepared));
}

Vector BodyAtMu::response(const Vector &load) const {
  return transposed_half_response(half_response(load));
}

Vector BodyAtMu::response(const Vector &theta_b, const Vector &x) const {
  Vector load = Vector::Zero(body_.prepared_b_.rows());
  for (Index p = 0; p < theta_b.size(); ++p)
    for (Index j = 0; j < x.size(); ++j)
      if (x[j] != 0) load += theta_b[p] * x[j] * body_.prepared_b_.col(p * x.size() + j);
  return response_of_prepared(load);
}

} // namespace rbvi
