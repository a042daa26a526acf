#include "proportional_body.hpp"

#include <cmath>

namespace rbvi {

namespace {

using RowVector = Eigen::SparseVector<double, Eigen::RowMajor>;

/// What the row is of another one; 0 where it is not in proportion to it.
double ratio_of(const RowVector &row, const RowVector &other) {
  constexpr double round_off = 1e-14; // of the row
  if (other.size() == 0) return 0;
  const double ratio = row.dot(other) / other.squaredNorm();
  const RowVector apart = row - ratio * other;
  return apart.norm() <= round_off * row.norm() ? ratio : 0;
}

} // namespace

ProportionalBody::ProportionalBody(const Problem &problem)
    : FullBody(problem.trace().size), problem_(problem),
      ksp_(make_direct_solver(problem.comm(), "hf_")) {}

void ProportionalBody::set(const Operators &op) {
  const Scene &scene = problem_.scene();
  const double coefficient = common_coefficient(scene.a, scene.parameters, op.mu);
  if (!first_) {
    RBVI_CALL(MatDuplicate(op.a, MAT_COPY_VALUES, a_.put()));
    RBVI_CALL(MatSetOption(a_.get(), MAT_SPD, PETSC_TRUE));
    set_operator(ksp_.get(), a_.get());
    first_ = std::make_unique<FactoredBody>(ksp_.get(), problem_.trace(), ColumnsLast::for_one_b);
    first_->set(a_.get());
    coefficient_ = coefficient;
  }
  ratio_ = coefficient / coefficient_;
}

Matrix ProportionalBody::moved(const SparseMatrix &b, const std::vector<Index> &which) {
  kept_.resize(static_cast<std::size_t>(b.rows()));
  std::vector<double> ratios;
  std::vector<Index> fresh;
  for (const Index row : which) {
    ratios.push_back(ratio_of(b.row(row), kept_[row].row));
    if (ratios.back() == 0) fresh.push_back(row);
  }
  const Matrix responses = first_->moved(b, fresh);
  for (std::size_t k = 0; k < fresh.size(); ++k)
    kept_[fresh[k]] = {b.row(fresh[k]), responses.col(static_cast<Index>(k))};
  Matrix result(size(), std::ssize(which));
  for (std::size_t k = 0; k < which.size(); ++k)
    result.col(static_cast<Index>(k)) =
        (ratios[k] == 0 ? 1 : ratios[k]) / ratio_ * kept_[which[k]].response;
  return result;
}

void ProportionalBody::make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) {
  SparseMatrix units(std::ssize(dofs), size());
  std::vector<Index> all(dofs.size());
  for (std::size_t k = 0; k < dofs.size(); ++k) {
    units.insert(static_cast<Index>(k), dofs[k]) = 1;
    all[k] = static_cast<Index>(k);
  }
  columns = first_->moved(units, all) / ratio_;
}

double ProportionalBody::displacement(const Operators &op, const Vector &lambda, Vec u) {
  const double error = first_->displacement(op, lambda, u);
  RBVI_CALL(VecScale(u, 1 / ratio_));
  return error;
}

} // namespace rbvi
