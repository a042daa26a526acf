#include "rbvi/solve/scaled_part.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/solve/complement.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace rbvi {

namespace {

/// Whether each local row of A has an entry.
std::vector<bool> rows_with_entries(Mat a) {
  PetscInt rows = 0;
  RBVI_CALL(MatGetLocalSize(a, &rows, nullptr));
  Handle<Vec> largest;
  RBVI_CALL(MatCreateVecs(a, nullptr, largest.put()));
  RBVI_CALL(MatGetRowMaxAbs(a, largest.get(), nullptr));
  std::vector<bool> result;
  const PetscScalar *values = nullptr;
  RBVI_CALL(VecGetArrayRead(largest.get(), &values));
  for (PetscInt i = 0; i < rows; ++i)
    result.push_back(values[i] > 0);
  RBVI_CALL(VecRestoreArrayRead(largest.get(), &values));
  return result;
}

/// theta at the two bounds of all free parameters, the smaller one first.
std::pair<double, double> range_of_coefficient(const Scene &scene, const SplitSum &split) {
  const ParameterSpace &space = scene.parameters;
  Mu lower, upper;
  for (int i = 0; i < space.size(); ++i) {
    lower.push_back(space.at(i).lower);
    upper.push_back(space.at(i).upper);
  }
  const auto theta = [&](const Mu &mu) {
    return exact_coefficients(scene.a, split, space, expand(space, mu)).back();
  };
  return std::minmax({theta(lower), theta(upper)});
}

} // namespace

bool ScaledPart::fits(const Scene &scene) {
  const SplitSum split = split_sum(scene.a, scene.parameters);
  if (!scene.f.empty() || !split.mapped.empty() || split.exact.size() != 2 ||
      !split.exact.front().factors.empty())
    return false;
  const auto [lower, upper] = range_of_coefficient(scene, split);
  return lower > 0 && lower < upper;
}

/// The dofs of the part that the rest holds too, or contact.
void ScaledPart::find_interface(const Problem &problem) {
  const std::vector<bool> rest = rows_with_entries(problem.a_terms().exact.front().get());
  const std::vector<bool> part = rows_with_entries(problem.a_terms().exact.back().get());
  std::vector<bool> in_contact(part.size(), false);
  for (const PetscInt row : contact_.local_row)
    in_contact[row] = true;
  for (std::size_t i = 0; i < part.size(); ++i)
    if (part[i] && (rest[i] || in_contact[i]))
      interface_.local_row.push_back(static_cast<PetscInt>(i));
  interface_.comm = both_.comm = problem.comm();
  const auto mine = static_cast<PetscInt>(interface_.local_row.size());
  PetscInt end = 0;
  MPI_Scan(&mine, &end, 1, MPIU_INT, MPI_SUM, problem.comm());
  MPI_Allreduce(&mine, &interface_.size, 1, MPIU_INT, MPI_SUM, problem.comm());
  both_ = contact_;
  both_.size += interface_.size;
  for (PetscInt k = 0; k < mine; ++k) {
    interface_.index.push_back(end - mine + k);
    both_.local_row.push_back(interface_.local_row[k]);
    both_.index.push_back(contact_.size + interface_.index.back());
  }
}

ScaledPart::ScaledPart(const Problem &problem)
    : FullBody(problem.trace().size), problem_(problem), contact_(problem.trace()) {
  const Summed<Mat> &a = problem.a_terms();
  const auto [lowest, highest] = range_of_coefficient(problem.scene(), a.split);
  lower_ = lowest;
  width_ = highest - lowest;
  const auto stiffness_at = [&](double theta) {
    Handle<Mat> sum;
    RBVI_CALL(MatDuplicate(a.exact.front().get(), MAT_COPY_VALUES, sum.put()));
    RBVI_CALL(MatAXPY(sum.get(), theta, a.exact.back().get(), SAME_NONZERO_PATTERN));
    return sum;
  };
  const Handle<Mat> lower = stiffness_at(lowest), upper = stiffness_at(highest);
  find_interface(problem);
  if (interface_.size == 0)
    throw failure("the part of the stiffness that a parameter scales is zero");

  const PetscInt c = contact_.size, n = interface_.size;
  solver_ = std::make_unique<ResponseSolver>(lower.get(), both_, "hf_");
  const Matrix g =
      condensed_by_loads(lower.get(), both_, "hf_", Matrix::Identity(c + n, c + n), solver_.get());
  const Matrix g_upper = condensed_by_loads(upper.get(), interface_, "hf_", Matrix::Identity(n, n));
  // G_ii(upper) w = theta^-1 G_ii(lower) w, theta = 1 + width * sigma.
  const EigenPairs pairs = eigen_pairs(g_upper, g.bottomRightCorner(n, n));
  if (pairs.values.size() == 0)
    throw failure("the stiffness matrix is not positive definite on the interface of the part "
                  "that a parameter scales");
  compliance_ = g.topLeftCorner(c, c);
  w_ = pairs.vectors;
  y_ = g.topRightCorner(c, n) * w_;
  sigma_ = (pairs.values.cwiseInverse().array() - 1).max(0);
}

void ScaledPart::set(const Operators &op) {
  forget();
  const Scene &scene = problem_.scene();
  const double theta =
      exact_coefficients(scene.a, problem_.a_terms().split, scene.parameters, op.mu).back();
  const double step = (theta - lower_) / width_;
  phi_ = (step * sigma_.array()) / (1 + step * sigma_.array());
}

Matrix ScaledPart::moved(const SparseMatrix &b, const std::vector<Index> &which) {
  Matrix loads = Matrix::Zero(size(), std::ssize(which));
  for (std::size_t k = 0; k < which.size(); ++k)
    loads.col(k) = b.row(which[k]).transpose();
  const SparseMatrix sparse = loads.sparseView();
  Matrix result = compliance_ * sparse;
  result.noalias() -= y_ * (phi_.asDiagonal() * Matrix(y_.transpose() * sparse));
  return result;
}

void ScaledPart::make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) {
  columns = compliance_(Eigen::all, dofs);
  columns.noalias() -= y_ * (phi_.asDiagonal() * y_(dofs, Eigen::all).transpose());
}

double ScaledPart::displacement(const Operators &op, const Vector &lambda, Vec u) {
  Matrix load(both_.size, 1);
  auto reaction = load.col(0).head(contact_.size);
  reaction = -(op.b.transpose() * lambda);
  load.col(0).tail(interface_.size) = -(w_ * phi_.cwiseProduct(y_.transpose() * reaction));
  const Handle<Mat> field = solver_->fields(load);
  Vec column = nullptr;
  RBVI_CALL(MatDenseGetColumnVecRead(field.get(), 0, &column));
  RBVI_CALL(VecCopy(column, u));
  RBVI_CALL(MatDenseRestoreColumnVecRead(field.get(), 0, &column));
  return 0;
}

} // namespace rbvi
