#include "rbvi/mor/high_fidelity_pair.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/solve/linear.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace rbvi {

namespace {

constexpr double singular = 1e-10;          ///< of a singular value, relative to the largest
constexpr double largest_tolerance = 0.999; ///< sigma never exceeds 1

/// [V B^T; B 0], with the zeros of its diagonal, and [0 0; 0 W].
struct SaddlePencil {
  Handle<Mat> k, m;
};

SaddlePencil saddle_pencil(MPI_Comm comm, Mat v, Mat b, Mat b_transposed, Mat w) {
  Handle<Mat> zeros, nested_k, nested_m;
  RBVI_CALL(MatDuplicate(w, MAT_DO_NOT_COPY_VALUES, zeros.put()));
  const std::array<Mat, 4> of_k{v, b_transposed, b, zeros.get()},
      of_m{nullptr, nullptr, nullptr, w};
  std::array<IS, 2> parts{};
  RBVI_CALL(MatCreateNest(comm, 2, nullptr, 2, nullptr, of_k.data(), nested_k.put()));
  RBVI_CALL(MatNestGetISs(nested_k.get(), parts.data(), nullptr));
  RBVI_CALL(MatCreateNest(comm, 2, parts.data(), 2, parts.data(), of_m.data(), nested_m.put()));
  SaddlePencil pencil;
  RBVI_CALL(MatConvert(nested_k.get(), MATAIJ, MAT_INITIAL_MATRIX, pencil.k.put()));
  RBVI_CALL(MatConvert(nested_m.get(), MATAIJ, MAT_INITIAL_MATRIX, pencil.m.put()));
  RBVI_CALL(MatSetOption(pencil.k.get(), MAT_SYMMETRIC, PETSC_TRUE));
  return pencil;
}

/// Inside ST symmetric factors by MUMPS, with room for the pivots that zeros of a diagonal delay.
void factorise(EPS eps, Mat matrix) {
  constexpr PetscInt more_room = 14, percent = 500;
  ST st = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  Mat factor = nullptr;
  RBVI_CALL(EPSGetST(eps, &st));
  RBVI_CALL(STGetKSP(st, &ksp));
  RBVI_CALL(KSPSetType(ksp, KSPPREONLY));
  RBVI_CALL(KSPSetOperators(ksp, matrix, matrix));
  RBVI_CALL(KSPGetPC(ksp, &pc));
  RBVI_CALL(PCSetType(pc, PCCHOLESKY));
  RBVI_CALL(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  RBVI_CALL(PCFactorSetUpMatSolverType(pc));
  RBVI_CALL(PCFactorGetMatrix(pc, &factor));
  RBVI_CALL(MatMumpsSetIcntl(factor, more_room, percent));
}

/// The size of the eigenvalue of a x = lambda m x that `eps` finds first, 0 up to the size `zero`.
double eigenvalue(EPS eps, Mat a, Mat m, const std::string &of, double zero = 0) {
  RBVI_CALL(EPSSetOperators(eps, a, m));
  RBVI_CALL(EPSSolve(eps));
  PetscInt converged = 0;
  double value = 0;
  RBVI_CALL(EPSGetConverged(eps, &converged));
  if (converged > 0) RBVI_CALL(EPSGetEigenvalue(eps, 0, &value, nullptr));
  if (converged > 0 && std::abs(value) <= zero) return 0;
  if (!(value < 0))
    throw failure("the iteration for " + of +
                  " did not converge: raise -infsup_eps_max_it or -infsup_eps_tol");
  return -value;
}

/// Multipliers that face a partner everywhere.
std::vector<Index> covered_multipliers(const Operators &op) {
  std::vector<Index> rows;
  for (Index i = 0; i < op.b.rows(); ++i)
    if (!std::ranges::binary_search(op.uncovered, i)) rows.push_back(i);
  if (rows.empty()) throw failure("no multiplier has a partner: there is no inf-sup constant");
  return rows;
}

} // namespace

Handle<EPS> make_infsup_eps(MPI_Comm comm, PetscInt multipliers) {
  constexpr double tolerance = 1e-12; // relative, of 1 / beta^2 and c^2
  constexpr PetscInt most_restarts = 200;
  Handle<EPS> eps;
  RBVI_CALL(EPSCreate(comm, eps.put()));
  RBVI_CALL(EPSSetOptionsPrefix(eps.get(), "infsup_"));
  RBVI_CALL(EPSSetProblemType(eps.get(), EPS_GHEP));
  RBVI_CALL(EPSSetType(eps.get(), EPSKRYLOVSCHUR));
  RBVI_CALL(EPSSetTolerances(eps.get(), tolerance, most_restarts));
  // The values of two bodies cluster: 16 vectors, the default, do not suffice.
  RBVI_CALL(EPSSetDimensions(eps.get(), 1, std::min<PetscInt>(multipliers, 64), PETSC_DEFAULT));
  RBVI_CALL(EPSSetFromOptions(eps.get()));
  return eps;
}

PairConstants iterated_constants(KSP v, Mat b, Mat w) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(v));
  PetscInt multipliers = 0;
  Mat product = nullptr;
  Handle<Mat> transposed, schur;
  RBVI_CALL(MatGetSize(b, &multipliers, nullptr));
  RBVI_CALL(KSPGetOperators(v, &product, nullptr));
  RBVI_CALL(MatTranspose(b, MAT_INITIAL_MATRIX, transposed.put()));
  const SaddlePencil pencil = saddle_pencil(comm, product, b, transposed.get(), w);
  const Handle<EPS> smallest = make_infsup_eps(comm, multipliers),
                    largest = make_infsup_eps(comm, multipliers);
  ST st = nullptr;
  RBVI_CALL(EPSGetST(smallest.get(), &st));
  RBVI_CALL(STSetType(st, STSINVERT));
  RBVI_CALL(EPSSetWhichEigenpairs(smallest.get(), EPS_TARGET_MAGNITUDE));
  RBVI_CALL(EPSSetTarget(smallest.get(), 0));
  factorise(smallest.get(), pencil.k.get());
  // PETSc's Schur complement has the sign of lambda above.
  RBVI_CALL(MatCreateSchurComplement(product, product, transposed.get(), b, nullptr, schur.put()));
  RBVI_CALL(MatSchurComplementSetKSP(schur.get(), v));
  RBVI_CALL(KSPSetErrorIfNotConverged(v, PETSC_TRUE));
  RBVI_CALL(EPSSetWhichEigenpairs(largest.get(), EPS_SMALLEST_REAL));
  factorise(largest.get(), w);
  const double c = eigenvalue(largest.get(), schur.get(), w, "c_HF");
  const double beta = eigenvalue(smallest.get(), pencil.k.get(), pencil.m.get(), "beta_HF",
                                 std::pow(singular, 2) * c); // of two obstacles on the same nodes
  return {std::sqrt(beta), std::sqrt(c)};
}

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
