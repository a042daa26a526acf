#include "rbvi/solve/eliminated.hpp"

#include "linear/reduced_system.hpp"
#include "linear/saddle_system.hpp"
#include "rbvi/contact/transfer.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/fem/rigid_body_modes.hpp"
#include "rbvi/solve/linear/vectors.hpp"

#include <optional>
#include <string_view>

namespace rbvi {

namespace {

constexpr int steps_worth_a_factorisation = 40, steps_worth_a_setup = 80; ///< of multigrid
constexpr int most_krylov_steps = 1000;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

void assemble(Mat matrix) {
  RBVI_CALL(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

/// Multigrid for large scalar problems: at 14 000 nodes of a membrane it takes as long as a
/// factorisation and its solves, from 57 000 on a half of it, and no memory for factors. With
/// vectors direct; where an option names another preconditioner, that one.
bool takes_multigrid(const Problem &problem) {
  constexpr PetscInt from = 10000;
  char type[64] = "";
  PetscBool given = PETSC_FALSE;
  RBVI_CALL(PetscOptionsGetString(nullptr, nullptr, "-hf_pc_type", type, sizeof type, &given));
  if (given == PETSC_TRUE)
    return std::string_view(type) != PCCHOLESKY && std::string_view(type) != PCLU;
  RBVI_CALL(PetscOptionsHasName(nullptr, nullptr, "-hf_ksp_type", &given));
  if (given == PETSC_TRUE) return false;
  return problem.scene().components == 1 && problem.dofs().total_free >= from;
}

/// T^T B, or R^T B.
SparseMatrix rows_of(const SparseMatrix &combination, const SparseMatrix &b) {
  return SparseMatrix(combination.transpose()) * b;
}

} // namespace

Eliminated::Eliminated(const Problem &problem)
    : problem_(problem), trace_(problem.trace()), dofs_(contact_dofs(problem.contact())),
      multigrid_(takes_multigrid(problem)),
      factor_(multigrid_ ? make_multigrid(problem.comm(), "hf_")
                         : make_direct_solver(problem.comm(), "hf_")) {
  rows_ = global_rows(trace_, problem.dofs().first_free);
}

/// A without the rows and columns of the pivots, ones on their diagonal.
void Eliminated::drop_pivots(Mat a, const std::vector<PetscInt> &rows) {
  if (!reduced_) {
    RBVI_CALL(MatDuplicate(a, MAT_COPY_VALUES, reduced_.put()));
    RBVI_CALL(MatSetOption(reduced_.get(), MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  } else {
    RBVI_CALL(MatCopy(a, reduced_.get(), SAME_NONZERO_PATTERN));
  }
  RBVI_CALL(MatZeroRowsColumns(reduced_.get(), static_cast<PetscInt>(rows.size()), rows.data(), 1,
                               nullptr, nullptr));
}

/// The same with the pivots tied to other contact dofs.
void Eliminated::tie_pivots(Mat a, const SparseMatrix &ties, const std::vector<PetscInt> &rows) {
  const PetscInt first = problem_.dofs().first_free;
  PetscInt local = 0;
  RBVI_CALL(MatGetLocalSize(a, &local, nullptr));
  Handle<Mat> tied;
  RBVI_CALL(MatCreateAIJ(trace_.comm, local, local, PETSC_DETERMINE, PETSC_DETERMINE, 64, nullptr,
                         64, nullptr, tied.put()));
  RBVI_CALL(MatSetOption(tied.get(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  for (PetscInt row = first; row < first + local; ++row)
    RBVI_CALL(MatSetValue(tied.get(), row, row, 1, INSERT_VALUES));
  for (const PetscInt row : rows)
    RBVI_CALL(MatSetValue(tied.get(), row, row, 0, INSERT_VALUES));
  for (std::size_t k = 0; k < trace_.index.size(); ++k)
    for (SparseMatrix::InnerIterator entry(ties, trace_.index[k]); entry; ++entry)
      RBVI_CALL(MatSetValue(tied.get(), first + trace_.local_row[k], rows_[at(entry.col())],
                            entry.value(), INSERT_VALUES));
  assemble(tied.get());
  RBVI_CALL(MatPtAP(a, tied.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, reduced_.put()));
}

/// Factorises A without the pivots, or with them tied.
void Eliminated::precondition(const Operators &op, const Elimination &z,
                              const std::vector<Index> &pivots) {
  const Trace pivot_trace = part_of(trace_, pivots);
  std::vector<PetscInt> rows;
  for (const PetscInt row : pivot_trace.local_row)
    rows.push_back(problem_.dofs().first_free + row);
  const bool vectors = problem_.scene().components > 1;
  const SparseMatrix ties = vectors && !pivots.empty() ? z.ties(trace_.size) : SparseMatrix();
  tied_ = ties.nonZeros() > 0;
  if (!tied_)
    drop_pivots(op.a, rows);
  else
    tie_pivots(op.a, ties, rows);
  // A pivot that is let go before the next factorisation is preconditioned by its own entry of A.
  const Handle<Vec> diagonal = like(op.f);
  RBVI_CALL(MatGetDiagonal(op.a, diagonal.get()));
  LocalValues of_a(diagonal.get());
  for (const PetscInt row : pivot_trace.local_row)
    RBVI_CALL(MatSetValue(reduced_.get(), problem_.dofs().first_free + row,
                          problem_.dofs().first_free + row, of_a.get()[row], INSERT_VALUES));
  assemble(reduced_.get());
  RBVI_CALL(MatSetOption(reduced_.get(), MAT_SPD, PETSC_TRUE));
  if (vectors && multigrid_) {
    if (!rigid_modes_) rigid_modes_ = rigid_body_modes(problem_.mesh(), problem_.dofs());
    RBVI_CALL(MatSetNearNullSpace(reduced_.get(), rigid_modes_.get()));
  }
  // A multigrid that is set up again keeps what it knew of the largest eigenvalues: where those
  // have grown its smoothers are no longer positive definite.
  if (multigrid_) factor_ = make_multigrid(problem_.comm(), "hf_");
  set_operator(factor_.get(), reduced_.get(),
               problem_.scene().dim == 2 ? Ordering::minimum_fill : Ordering::automatic);
  RBVI_CALL(KSPSetUp(factor_.get()));
  factored_ = pivots;
  of_another_a_ = false;
  ++factorisations_;
}

/// Sets u and returns the multipliers y. Throws failure where the equation cannot be solved.
Vector Eliminated::eliminate(const Operators &op, const SetSystem &system, const SparseMatrix &c,
                             Vec force, double accuracy) {
  const std::vector<Index> pivots = choose_pivots(dofs_, system, c);
  const Elimination z(c, pivots);
  std::optional<Elimination> unsymmetric;
  if (!system.symmetric) unsymmetric.emplace(rows_of(system.t, op.b), pivots);
  const Elimination &w = unsymmetric ? *unsymmetric : z;
  if (of_another_a_) precondition(op, z, pivots);
  ReducedSystem reduced(trace_, op.a, z, w, pivots, factor_.get());

  // right = W^T (force - A u_0).
  const Handle<Vec> right = like(op.f), u_0 = like(op.f);
  RBVI_CALL(VecZeroEntries(u_0.get()));
  const Vector constraint = SparseMatrix(system.r.transpose()) * op.g;
  if (!pivots.empty()) add_extension(reduced.pivots, z.pivot_values(constraint), u_0.get());
  RBVI_CALL(MatMult(op.a, u_0.get(), right.get()));
  RBVI_CALL(VecAYPX(right.get(), -1, force));
  reduced.reduce(right.get());

  set_zero(reduced.pivots, u_.get());
  // Relative to the forces; those of the last sets are the best guess.
  const double forces = norm(op.f) + reaction_;
  Krylov how{system.symmetric, forces > 0 ? 1e-15 : accuracy, accuracy * forces,
             multigrid_ ? steps_worth_a_setup : steps_worth_a_factorisation};
  int steps = solve_reduced(reduced, how, right.get(), u_.get());
  if (steps > how.most_steps) {
    krylov_steps_ += how.most_steps;
    if (pivots != factored_) precondition(op, z, pivots);
    reduced.factor = factor_.get();
    how.most_steps = most_krylov_steps;
    steps = solve_reduced(reduced, how, right.get(), u_.get());
    if (steps > how.most_steps)
      throw failure("the system of the active set was not solved in " +
                    std::to_string(how.most_steps) +
                    " steps, or its preconditioner is not positive definite");
  }
  krylov_steps_ += steps;
  reduced.extend(u_.get());
  RBVI_CALL(VecAXPY(u_.get(), 1, u_0.get()));
  if (pivots.empty()) return {};

  const Handle<Vec> residual = like(op.f);
  RBVI_CALL(MatMult(op.a, u_.get(), residual.get()));
  RBVI_CALL(VecAYPX(residual.get(), -1, force));
  return w.multipliers(restrict_to(reduced.pivots, residual.get()));
}

SetSolution Eliminated::solve_system(const Operators &op, const SetSystem &system,
                                     double accuracy) {
  const SparseMatrix c = rows_of(system.r, op.b);
  const Handle<Vec> force = reaction_rhs(trace_, op, system.fixed); // f - B^T fixed
  Vector y;
  if (complaint_.empty()) {
    try {
      y = eliminate(op, system, c, force.get(), accuracy);
    } catch (const Error &error) { // of every rank
      complaint_ = error.what();
    }
  }
  if (!complaint_.empty())
    y = solve_saddle(trace_, op.a, rows_of(system.t, op.b), c, force.get(),
                     SparseMatrix(system.r.transpose()) * op.g, u_.get());
  const Vector u = restrict_to(trace_, u_.get());
  SetSolution found;
  found.x = system.fixed;
  if (y.size() > 0) found.x += system.t * y;
  reaction_ = (op.b.transpose() * found.x).norm();
  found.w = op.g - op.b * u;
  found.terms = op.g.cwiseAbs() + op.b.cwiseAbs() * u.cwiseAbs();
  return found;
}

MethodResult Eliminated::solve(const Operators &op, const Vector &start, double accuracy) {
  const Handle<Vec> a_diagonal = like(op.f);
  RBVI_CALL(MatGetDiagonal(op.a, a_diagonal.get()));
  const Vector stiffness = restrict_to(trace_, a_diagonal.get());
  Vector diagonal = op.b.cwiseProduct(op.b) * stiffness.cwiseInverse();
  const double mean = diagonal.mean();
  for (double &value : diagonal)
    if (!(value > 0)) value = mean;

  complaint_.clear();
  // Ties follow B, which changes with mu.
  if (tied_ || !constant_stiffness(problem_.scene())) of_another_a_ = true;
  if (!u_) {
    u_ = like(op.f);
    RBVI_CALL(VecZeroEntries(u_.get()));
  }
  const SetSolver solver = [&](const SetSystem &system, double of_system) {
    return solve_system(op, system, of_system);
  };
  FrictionResult found = solve_by_sets(solver, diagonal, op.laws, start, {.tolerance = accuracy});
  MethodResult result;
  result.u = like(op.f);
  RBVI_CALL(VecCopy(u_.get(), result.u.get()));
  result.lambda = std::move(found.x);
  result.start = std::move(found.start);
  result.active = std::move(found.active);
  result.iterations = found.iterations;
  result.converged = found.converged;
  result.reason = found.reason;
  if (!found.converged)
    result.reason += ": try -hf_contact condensed, or a start closer to the solution";
  else if (complaint_.empty())
    result.reason += ", " + std::to_string(factorisations_) + " factorisations and " +
                     std::to_string(krylov_steps_) + " Krylov steps so far";
  else
    result.reason += ", by systems with multipliers because elimination failed: " + complaint_;
  return result;
}

bool GridSequence::has_coarser() {
  if (!coarser_ && problem_.refinements() > 0) {
    coarser_problem_ = problem_.coarser();
    coarser_ = std::make_unique<GridSequence>(*coarser_problem_);
    from_coarser_ = interpolation(coarser_problem_->contact(), problem_.contact());
  }
  return coarser_ != nullptr;
}

MethodResult GridSequence::solve(const Mu &mu, const Operators &op, const Vector &start,
                                 double accuracy) {
  constexpr double enough_to_start = 1e-8;
  // Steps from a neighbour are as many as layers of cells between the sets; those from coarser
  // meshes are three or four on every mesh, and cost a third more. Measured on membranes: 0.07 and
  // 0.10 s at 13e3 dofs, 0.51 and 0.47 s at 53e3, 4.8 and 2.1 s at 213e3.
  constexpr PetscInt coarser_from = 40000;
  if (start.size() > 0 && (problem_.dofs().total_free < coarser_from || !has_coarser()))
    return on_this_.solve(op, start, accuracy);
  if (!has_coarser()) return on_this_.solve(op, {}, accuracy);
  const Operators &on_coarser = coarser_problem_->assemble(mu);
  const MethodResult rough = coarser_->solve(mu, on_coarser, {}, enough_to_start);
  if (!rough.converged) return on_this_.solve(op, {}, accuracy);
  return on_this_.solve(op, from_coarser_ * rough.start, accuracy);
}

} // namespace rbvi
