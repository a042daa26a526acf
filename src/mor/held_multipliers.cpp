#include "rbvi/mor/held_multipliers.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/solve/response_solver.hpp"

#include <Eigen/Cholesky>

#include <algorithm>

namespace rbvi {

namespace {

constexpr std::size_t columns_at_once = 192; ///< columns, solves: bounds the memory

/// Some rows of a matrix, as the columns of the result.
Matrix rows_as_columns(const SparseMatrix &matrix, const std::vector<Index> &rows) {
  Matrix columns = Matrix::Zero(matrix.cols(), std::ssize(rows));
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (SparseMatrix::InnerIterator entry(matrix, rows[k]); entry; ++entry)
      columns(entry.col(), static_cast<Index>(k)) = entry.value();
  return columns;
}

/// A without the rows and columns of some dofs, ones on their diagonal. Collective.
Handle<Mat> without_dofs(Mat a, const Trace &trace, const std::vector<Index> &dofs) {
  Handle<Mat> reduced;
  PetscInt first = 0;
  RBVI_CALL(MatGetOwnershipRange(a, &first, nullptr));
  std::vector<PetscInt> rows;
  for (const PetscInt row : part_of(trace, dofs).local_row)
    rows.push_back(first + row);
  RBVI_CALL(MatDuplicate(a, MAT_COPY_VALUES, reduced.put()));
  RBVI_CALL(MatZeroRowsColumns(reduced.get(), static_cast<PetscInt>(rows.size()), rows.data(), 1,
                               nullptr, nullptr));
  return reduced;
}

} // namespace

std::optional<HeldDofs> held_dofs(const SparseMatrix &b, const std::vector<Index> &held) {
  std::vector<bool> taken(b.cols(), false);
  HeldDofs result{{}, Vector(std::ssize(held))};
  for (std::size_t k = 0; k < held.size(); ++k) {
    for (SparseMatrix::InnerIterator entry(b, held[k]); entry; ++entry) {
      if (entry.value() == 0) continue;
      if (result.dofs.size() > k || taken[entry.col()]) return std::nullopt;
      taken[entry.col()] = true;
      result.entries[k] = entry.value();
      result.dofs.push_back(entry.col());
    }
    if (result.dofs.size() == k) return std::nullopt;
  }
  return result;
}

Matrix hold_by_columns(const ColumnSource &condensed, const std::vector<Index> &held,
                       const Matrix &others) {
  Matrix block(std::ssize(held), std::ssize(held)), result(std::ssize(held), others.cols());
  for (std::size_t first = 0; first < held.size(); first += columns_at_once) {
    const auto begin = held.begin() + static_cast<std::ptrdiff_t>(first);
    const std::vector<Index> some(
        begin, begin + std::min<std::ptrdiff_t>(columns_at_once, held.end() - begin));
    const Matrix columns = condensed(some);
    const auto place = static_cast<Index>(first);
    block.middleCols(place, columns.cols()) = columns(held, Eigen::all);
    result.middleRows(place, columns.cols()) = -columns.transpose() * others;
  }
  block = ((block + block.transpose()) / 2).eval();
  if (!cholesky_in_place(block))
    throw failure("the condensed operator is not positive definite on the nodes in permanent "
                  "contact: try another -reference_mu");
  solve_lower(block, result);
  solve_lower_transposed(block, result);
  return result;
}

Matrix hold_by_reactions(const Problem &problem, const Operators &op, const HeldDofs &held,
                         const Matrix &others) {
  const Trace &trace = problem.trace();
  ResponseSolver solver(without_dofs(op.a, trace, held.dofs).get(), trace, "hf_");
  Matrix result(std::ssize(held.dofs), others.cols());
  for (Index first = 0; first < others.cols(); first += columns_at_once) {
    const Index count = std::min<Index>(columns_at_once, others.cols() - first);
    const Matrix loads = op.b.transpose() * others.middleCols(first, count);
    Matrix free_loads = loads;
    free_loads(held.dofs, Eigen::all).setZero();
    const Handle<Mat> fields = solver.fields(free_loads);
    Handle<Mat> forces;
    RBVI_CALL(MatMatMult(op.a, fields.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, forces.put()));
    const Matrix reactions = restrict_to(trace, forces.get()) - loads;
    result.middleCols(first, count) =
        held.entries.cwiseInverse().asDiagonal() * reactions(held.dofs, Eigen::all);
  }
  return result;
}

HoldingMultipliers holding(const Problem &problem, const Operators &op) {
  return [&](const std::vector<Index> &held, const Matrix &others) {
    if (others.cols() < std::ssize(held))
      if (const std::optional<HeldDofs> dofs = held_dofs(op.b, held))
        return hold_by_reactions(problem, op, *dofs, others);
    ResponseSolver solver(op.a, problem.trace(), "hf_");
    const ColumnSource columns = [&](const std::vector<Index> &which) -> Matrix {
      return op.b * solver.responses(rows_as_columns(op.b, which));
    };
    return hold_by_columns(columns, held, others);
  };
}

} // namespace rbvi
