#include "rbvi/rom/reduced_stiffness.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/rom/online.hpp"
#include "rbvi/rom/packed.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace rbvi {

namespace {

Mu corner(const ParameterSpace &space, double Parameter::*bound) {
  Mu mu;
  for (int i = 0; i < space.size(); ++i)
    mu.push_back(space.at(i).*bound);
  return expand(space, mu);
}

} // namespace

ReducedStiffness::ReducedStiffness(const ReducedModel &model, const Scene &scene)
    : model_(model), scene_(scene) {
  if (model.a.size() <= 2) find_common_eigenvectors();
}

/// Of A_N at two corners of the box, or of its only term.
void ReducedStiffness::find_common_eigenvectors() {
  const AffineTerms &a = model_.a;
  const Index n = model_.primal_size();
  const auto stiffness_at = [&](const Mu &mu) {
    return unpacked(a.reduced * affine_coefficients(a, scene_.a, scene_, mu), n);
  };
  const Matrix first = stiffness_at(corner(scene_.parameters, &Parameter::lower));
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(
      a.size() == 1 ? first : stiffness_at(corner(scene_.parameters, &Parameter::upper)),
      a.size() == 1 ? Matrix(Matrix::Identity(n, n)) : first);
  if (solver.info() != Eigen::Success) return;
  Matrix eigenvalues(n, a.size());
  for (Index q = 0; q < a.size(); ++q) {
    Matrix term =
        solver.eigenvectors().transpose() *
        (unpacked(a.reduced.col(q), n).selfadjointView<Eigen::Lower>() * solver.eigenvectors());
    eigenvalues.col(q) = term.diagonal();
    term.diagonal().setZero();
    if (!(term.cwiseAbs().maxCoeff() <= 1e-10 * eigenvalues.col(q).cwiseAbs().maxCoeff())) return;
  }
  eigenvectors_ = solver.eigenvectors();
  eigenvalues_ = std::move(eigenvalues);
  b_.resize(model_.generators, n * model_.b.size());
  for (Index p = 0; p < model_.b.size(); ++p)
    b_.middleCols(p * n, n) =
        model_.b.reduced.col(p).reshaped(model_.generators, n) * eigenvectors_;
}

bool ReducedStiffness::depends_on_change(const Mu &all_parameters) const {
  if (at_.empty()) return true;
  if (!scene_.a_parameters) return at_ != all_parameters;
  return std::any_of(scene_.a_parameters->begin(), scene_.a_parameters->end(), [&](int i) {
    return at_[static_cast<std::size_t>(i)] != all_parameters[static_cast<std::size_t>(i)];
  });
}

void ReducedStiffness::set(const Mu &all_parameters) {
  if (!depends_on_change(all_parameters)) return;
  const Vector theta = affine_coefficients(model_.a, scene_.a, scene_, all_parameters);
  bool definite = true;
  if (eigenvectors_.size() > 0) {
    diagonal_ = eigenvalues_ * theta;
    definite = diagonal_.minCoeff() > 0;
  } else {
    factor_.compute(unpacked(model_.a.reduced * theta, model_.primal_size()));
    definite = factor_.info() == Eigen::Success;
  }
  if (!definite)
    throw failure("the reduced stiffness is not positive definite: reduce again with a smaller "
                  "-eim_tolerance, or stay closer to the training set");
  at_ = all_parameters;
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
  if (!turned) return factor_.solve(load);
  return eigenvectors_ * load.cwiseQuotient(diagonal_);
}

Matrix ReducedStiffness::half_response(const Matrix &loads) const {
  if (eigenvectors_.size() == 0) return factor_.matrixL().solve(loads);
  return diagonal_.cwiseSqrt().cwiseInverse().asDiagonal() * (eigenvectors_.transpose() * loads);
}

} // namespace rbvi
