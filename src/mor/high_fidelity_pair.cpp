#include "rbvi/mor/high_fidelity_pair.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/par/turns.hpp"
#include "rbvi/solve/linear.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double singular = 1e-10;          ///< of a singular value, relative to the largest
constexpr double largest_tolerance = 0.999; ///< sigma never exceeds 1

/// Multipliers that face a partner everywhere.
std::vector<Index> covered_multipliers(const Operators &op) {
  std::vector<Index> rows;
  for (Index i = 0; i < op.b.rows(); ++i)
    if (!std::ranges::binary_search(op.uncovered, i)) rows.push_back(i);
  if (rows.empty()) throw failure("no multiplier has a partner: there is no inf-sup constant");
  return rows;
}

} // namespace

bool iterates_constants(double multipliers, double dofs) {
  // Measured, in seconds on one core: dense 4e-10 m^3, iterated 4e-5 n (membrane, two_disks).
  constexpr double break_even = 1e5;
  return std::pow(multipliers, 3) > break_even * dofs;
}

bool iterates_constants(const Problem &problem) {
  return iterates_constants(static_cast<double>(problem.dual_size()),
                            static_cast<double>(problem.dofs().total));
}

PairConstants dense_constants(const Problem &problem, const RieszSpace &space,
                              const Operators &op) {
  const std::vector<Index> rows = covered_multipliers(op);
  const Matrix w = cholesky(Matrix(problem.w_product())(rows, rows), "the W product");
  Matrix inverse = Matrix::Identity(w.rows(), w.cols());
  solve_lower_transposed(w, inverse);
  Matrix x = Matrix::Zero(problem.dual_size(), w.cols());
  x(rows, Eigen::all) = inverse;
  const Vector stretch = singular_values(supremizer_coordinates(space, op.b, x), "infsup_");
  const bool enough = stretch.size() == x.cols(); // else V holds fewer directions than W
  return {enough ? stretch(stretch.size() - 1) : 0, stretch(0)};
}

PairConstants iterated_constants(Problem &problem, KSP v, const Operators &op) {
  const std::vector<Index> covered = covered_multipliers(op);
  const DualLayout &layout = problem.dual_layout();
  std::vector<PetscInt> rows;
  for (const Index row : layout.rows)
    if (std::ranges::binary_search(covered, row)) rows.push_back(layout.numbers[row]);
  const Handle<Mat> all_b = distribute_rows(layout, own_rows(layout, op.b)),
                    all_w = distribute(layout, problem.w_product());
  Handle<IS> kept;
  Handle<Mat> b, w;
  RBVI_CALL(ISCreateGeneral(layout.comm, static_cast<PetscInt>(rows.size()), rows.data(),
                            PETSC_COPY_VALUES, kept.put()));
  RBVI_CALL(MatCreateSubMatrix(all_b.get(), kept.get(), nullptr, MAT_INITIAL_MATRIX, b.put()));
  RBVI_CALL(MatCreateSubMatrix(all_w.get(), kept.get(), kept.get(), MAT_INITIAL_MATRIX, w.put()));
  return iterated_constants(v, b.get(), w.get());
}

std::vector<PairConstants> high_fidelity_pairs(Problem &problem, Mat product,
                                               const RieszSpace &space,
                                               const std::vector<ContactPoint> &set) {
  std::vector<PairConstants> pairs(set.size());
  Operators op;
  if (iterates_constants(problem)) {
    const Handle<KSP> v = make_direct_solver(problem.comm(), "v_");
    RBVI_CALL(MatSetOption(product, MAT_SPD, PETSC_TRUE));
    set_operator(v.get(), product);
    for (std::size_t p = 0; p < set.size(); ++p) {
      problem.assemble_contact(set[p].mu, op, set[p].state);
      pairs[p] = iterated_constants(problem, v.get(), op);
    }
    return pairs;
  }
  Matrix values = Matrix::Zero(2, std::ssize(set));
  take_turns(problem.comm(), set.size(), [&](std::size_t p) {
    problem.assemble_contact(set[p].mu, op, set[p].state);
    const PairConstants pair = dense_constants(problem, space, op);
    values.col(static_cast<Index>(p)) << pair.beta, pair.c;
  });
  over_ranks(problem.comm(), MPI_SUM, values);
  for (std::size_t p = 0; p < set.size(); ++p)
    pairs[p] = {values(0, static_cast<Index>(p)), values(1, static_cast<Index>(p))};
  return pairs;
}

double infsup_tolerance(Problem &problem, Mat product, const std::vector<ContactPoint> &set) {
  const RieszSpace space =
      iterates_constants(problem) ? RieszSpace{} : make_riesz_space(product, problem.trace());
  double smallest = largest_tolerance;
  for (const PairConstants &pair : high_fidelity_pairs(problem, product, space, set)) {
    if (!(pair.beta > singular * pair.c))
      throw failure("beta_HF is " + short_number(pair.beta) +
                    ", zero to round-off: give -pga_tolerance a number");
    smallest = std::min(smallest, pair.beta / pair.c);
  }
  return smallest;
}

} // namespace rbvi
