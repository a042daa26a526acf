#include "rbvi/solve/scaled_part.hpp"

#include "rbvi/core/error.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double round_off = 1e-12; ///< of the entries of A, relative to the largest of their row

Handle<Mat> copy_of(Mat a) {
  Handle<Mat> copy;
  RBVI_CALL(MatDuplicate(a, MAT_COPY_VALUES, copy.put()));
  return copy;
}

/// Largest entry of each local row of a - factor * b, which have the same pattern.
Vector largest_in_rows(Mat a, double factor, Mat b) {
  const Handle<Mat> difference = copy_of(a);
  RBVI_CALL(MatAXPY(difference.get(), -factor, b, SAME_NONZERO_PATTERN));
  PetscInt rows = 0;
  RBVI_CALL(MatGetLocalSize(a, &rows, nullptr));
  Handle<Vec> largest;
  RBVI_CALL(MatCreateVecs(a, nullptr, largest.put()));
  RBVI_CALL(MatGetRowMaxAbs(difference.get(), largest.get(), nullptr));
  Vector result(rows);
  const PetscScalar *values = nullptr;
  RBVI_CALL(VecGetArrayRead(largest.get(), &values));
  std::copy_n(values, rows, result.data());
  RBVI_CALL(VecRestoreArrayRead(largest.get(), &values));
  return result;
}

} // namespace

bool ScaledPart::fits(const Scene &scene) {
  if (!scene.part_stiffness || !scene.a_parameters || scene.f) return false;
  const std::vector<int> &free = scene.parameters.free, &of_a = *scene.a_parameters;
  const auto is_free = [&](int i) { return std::find(free.begin(), free.end(), i) != free.end(); };
  return is_free(*scene.part_stiffness) && std::count_if(of_a.begin(), of_a.end(), is_free) == 1;
}

/// The dofs of the part (their rows change with kappa) that the rest holds too (their rows are not
/// multiples of kappa), or contact.
void ScaledPart::find_interface(const Problem &problem, Mat lower, Mat upper) {
  const Vector size = largest_in_rows(upper, 0, upper);
  const Vector change = largest_in_rows(upper, 1, lower);
  const Vector rest = largest_in_rows(upper, (lower_ + width_) / lower_, lower);
  std::vector<char> in_contact(static_cast<std::size_t>(size.size()), 0);
  for (const PetscInt row : contact_.local_row)
    in_contact[static_cast<std::size_t>(row)] = 1;
  interface_.comm = both_.comm = problem.comm();
  for (Index i = 0; i < size.size(); ++i)
    if (change[i] > round_off * size[i] &&
        (rest[i] > round_off * size[i] || in_contact[static_cast<std::size_t>(i)] != 0))
      interface_.local_row.push_back(static_cast<PetscInt>(i));
  const auto mine = static_cast<PetscInt>(interface_.local_row.size());
  PetscInt end = 0;
  MPI_Scan(&mine, &end, 1, MPIU_INT, MPI_SUM, problem.comm());
  MPI_Allreduce(&mine, &interface_.size, 1, MPIU_INT, MPI_SUM, problem.comm());
  both_ = contact_;
  both_.size += interface_.size;
  for (PetscInt k = 0; k < mine; ++k) {
    interface_.index.push_back(end - mine + k);
    both_.local_row.push_back(interface_.local_row[static_cast<std::size_t>(k)]);
    both_.index.push_back(contact_.size + interface_.index.back());
  }
}

ScaledPart::ScaledPart(Problem &problem)
    : parameter_(problem.scene().part_stiffness.value()), contact_(problem.trace()) {
  const Parameter &parameter = problem.scene().parameters.all[static_cast<std::size_t>(parameter_)];
  lower_ = parameter.lower;
  width_ = parameter.upper - parameter.lower;
  const auto stiffness_at = [&](double value) {
    const ParameterSpace &space = problem.scene().parameters;
    Mu mu;
    for (const int i : space.free)
      mu.push_back(i == parameter_ ? value : space.all[static_cast<std::size_t>(i)].lower);
    return copy_of(problem.assemble(mu).a);
  };
  const Handle<Mat> lower = stiffness_at(parameter.lower), upper = stiffness_at(parameter.upper);
  find_interface(problem, lower.get(), upper.get());
  if (interface_.size == 0)
    throw failure("no part of the body has the stiffness " + parameter.name);

  const PetscInt c = contact_.size, n = interface_.size;
  solver_ = std::make_unique<ReplicatedSolver>(lower.get(), both_, "hf_");
  const Matrix g = solver_->responses(Matrix::Identity(c + n, c + n));
  const Matrix g_upper =
      ReplicatedSolver(upper.get(), interface_, "hf_").responses(Matrix::Identity(n, n));
  // G_ii(upper) w = theta^-1 G_ii(lower) w, theta = 1 + width * sigma.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(g_upper, g.bottomRightCorner(n, n));
  if (solver.info() != Eigen::Success)
    throw failure("the stiffness matrix is not positive definite on the interface of the part "
                  "that " +
                  parameter.name + " scales");
  compliance_ = g.topLeftCorner(c, c);
  w_ = solver.eigenvectors();
  y_ = g.topRightCorner(c, n) * w_;
  sigma_ = (solver.eigenvalues().cwiseInverse().array() - 1).max(0);
}

void ScaledPart::set(const Operators &op) {
  op_ = &op;
  const double step = (op.mu[static_cast<std::size_t>(parameter_)] - lower_) / width_;
  phi_ = (step * sigma_.array()) / (1 + step * sigma_.array());
  by_ = op.b * y_;
}

Matrix ScaledPart::columns(const std::vector<Index> &which) const {
  Matrix loads = Matrix::Zero(op_->b.cols(), static_cast<Index>(which.size()));
  for (std::size_t k = 0; k < which.size(); ++k)
    loads.col(static_cast<Index>(k)) = op_->b.row(which[k]).transpose();
  Matrix result = op_->b * Matrix(compliance_ * loads.sparseView());
  result.noalias() -= by_ * (phi_.asDiagonal() * by_(which, Eigen::all).transpose());
  return result;
}

void ScaledPart::displacement(const Vector &lambda, Vec u) {
  Matrix load(both_.size, 1);
  load.col(0).head(contact_.size) = -(op_->b.transpose() * lambda);
  const Vector eliminated = phi_.cwiseProduct(y_.transpose() * load.col(0).head(contact_.size));
  load.col(0).tail(interface_.size) = -(w_ * eliminated);
  const Handle<Mat> field = solver_->fields(load);
  Vec column = nullptr;
  RBVI_CALL(MatDenseGetColumnVecRead(field.get(), 0, &column));
  RBVI_CALL(VecCopy(column, u));
  RBVI_CALL(MatDenseRestoreColumnVecRead(field.get(), 0, &column));
}

} // namespace rbvi
