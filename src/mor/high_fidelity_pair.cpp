#include "rbvi/mor/high_fidelity_pair.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/par/turns.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr double singular = 1e-10;          ///< of a singular value, relative to the largest
constexpr double largest_tolerance = 0.999; ///< sigma never exceeds 1

/// Multipliers that face a partner everywhere.
std::vector<Index> covered_multipliers(const Operators &op) {
  std::vector<Index> rows;
  for (Index i = 0; i < op.b.rows(); ++i)
    if (!std::ranges::binary_search(op.uncovered, i)) rows.push_back(i);
  return rows;
}

/// What takes these rows of a matrix of `size` rows.
SparseMatrix rows_of_identity(const std::vector<Index> &rows, Index size) {
  SparseMatrix chosen(std::ssize(rows), size);
  for (std::size_t i = 0; i < rows.size(); ++i)
    chosen.insert(static_cast<Index>(i), rows[i]) = 1;
  chosen.makeCompressed();
  return chosen;
}

} // namespace

std::optional<SparseInfSup> sparse_infsup(Problem &problem) {
  // Measured, in seconds on one core: dense 4e-10 m^3, iterated 4e-5 n (membrane, two_disks).
  constexpr double break_even = 1e5;
  const auto m = static_cast<double>(problem.dual_size());
  if (m * m * m <= break_even * static_cast<double>(problem.dofs().total)) return std::nullopt;
  return SparseInfSup(problem.v_product(), problem.trace());
}

PairConstants high_fidelity_pair(const Problem &problem, const RieszSpace &space,
                                 const Operators &op, const std::optional<SparseInfSup> &sparse) {
  const std::vector<Index> rows = covered_multipliers(op);
  if (rows.empty()) throw failure("no multiplier has a partner: there is no inf-sup constant");
  if (sparse) {
    const SparseMatrix chosen = rows_of_identity(rows, problem.dual_size());
    const SparseMatrix b = chosen * op.b,
                       w = chosen * SparseMatrix(problem.w_product() * chosen.transpose());
    return {sparse->constant(b, w), largest_stretch(space.factor, b, w)};
  }
  const Matrix w = cholesky(Matrix(problem.w_product())(rows, rows), "the W product");
  Matrix inverse = Matrix::Identity(w.rows(), w.cols());
  solve_lower_transposed(w, inverse);
  Matrix x = Matrix::Zero(problem.dual_size(), w.cols());
  x(rows, Eigen::all) = inverse;
  const Vector stretch = singular_values(supremizer_coordinates(space, op.b, x));
  const bool enough = stretch.size() == x.cols(); // else V holds fewer directions than W
  return {enough ? stretch(stretch.size() - 1) : 0, stretch(0)};
}

double infsup_tolerance(MPI_Comm comm, Problem &problem, const RieszSpace &space,
                        const std::vector<ContactPoint> &set) {
  double smallest = largest_tolerance;
  const std::optional<SparseInfSup> sparse = sparse_infsup(problem);
  Operators op;
  take_turns(comm, set.size(), [&](std::size_t p) {
    problem.assemble_contact(set[p].mu, op, set[p].state);
    const PairConstants pair = high_fidelity_pair(problem, space, op, sparse);
    if (!(pair.beta > singular * pair.c))
      throw failure("beta_HF is " + short_number(pair.beta) +
                    ", zero to round-off: give -pga_tolerance a number");
    smallest = std::min(smallest, pair.beta / pair.c);
  });
  MPI_Allreduce(MPI_IN_PLACE, &smallest, 1, MPI_DOUBLE, MPI_MIN, comm);
  return smallest;
}

} // namespace rbvi
