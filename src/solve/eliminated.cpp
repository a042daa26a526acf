#include "rbvi/solve/eliminated.hpp"

#include "elimination.hpp"
#include "rbvi/contact/transfer.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/fem/rigid_body_modes.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/vectors.hpp"

#include <array>
#include <optional>
#include <string_view>

namespace rbvi {

namespace {

constexpr int steps_worth_a_factorisation = 40, steps_worth_a_setup = 80; ///< of multigrid
constexpr int most_krylov_steps = 1000;

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

/// Vertex quadrature keeps the pattern of a mass matrix.
SparseMatrix without_zeros(SparseMatrix matrix) {
  matrix.prune(0.0);
  return matrix;
}

/// T^T B, or R^T B.
SparseMatrix rows_of(const SparseMatrix &combination, const SparseMatrix &b) {
  return SparseMatrix(combination.transpose()) * b;
}

/// Per constraint of a system its multiplier, as a row of B.
std::vector<Index> multipliers_of(const SetSystem &system, const DualLayout &layout) {
  std::vector<Index> rows(system.r.cols());
  for (Index row = 0; row < system.r.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(system.r, row); entry; ++entry)
      rows[entry.col()] = layout.rows[row];
  return rows;
}

Vector product(Mat matrix, Vec v, Vec scratch) {
  RBVI_CALL(MatMult(matrix, v, scratch));
  return LocalValues(scratch).get();
}

} // namespace

/// This rank's multipliers at one mu.
struct OwnContact {
  OwnContact(const DualLayout &layout, const Operators &op)
      : b(without_zeros(own_rows(layout, op.b))), g(op.g(layout.rows)),
        b_over_ranks(distribute_rows(layout, b)), sizes(distribute_rows(layout, b.cwiseAbs())),
        x(distribute_values(layout.comm, g)) {}

  SparseMatrix b; ///< own multipliers x contact dofs
  Vector g;
  Handle<Mat> b_over_ranks, sizes; ///< B and its |b_ij|, on the free displacement dofs
  Handle<Vec> x;                   ///< scratch, of multipliers
};

namespace {

/// f - B^T x.
Handle<Vec> without_reaction(const OwnContact &contact, Vec f, const Vector &x) {
  Handle<Vec> force = like(f);
  LocalValues(contact.x.get()).get() = -x;
  RBVI_CALL(MatMultTransposeAdd(contact.b_over_ranks.get(), contact.x.get(), f, force.get()));
  return force;
}

/// Of B A_D^-1 B^T, A_D the diagonal of A; where B is zero its mean.
Vector diagonal_of(const DualLayout &layout, const OwnContact &contact, Mat a, Vec scratch) {
  const Handle<Mat> squares = distribute_rows(layout, contact.b.cwiseProduct(contact.b));
  RBVI_CALL(MatGetDiagonal(a, scratch));
  RBVI_CALL(VecReciprocal(scratch));
  Vector diagonal = product(squares.get(), scratch, contact.x.get());
  PetscScalar sum = 0;
  PetscInt count = 0;
  RBVI_CALL(VecSum(contact.x.get(), &sum));
  RBVI_CALL(VecGetSize(contact.x.get(), &count));
  for (double &value : diagonal)
    if (!(value > 0)) value = sum / count;
  return diagonal;
}

} // namespace

Eliminated::Eliminated(Problem &problem)
    : problem_(problem), layout_(problem.dual_layout()), dofs_(contact_dofs(problem.contact())),
      multigrid_(takes_multigrid(problem)),
      factor_(multigrid_ ? make_multigrid(problem.comm(), "hf_")
                         : make_direct_solver(problem.comm(), "hf_")) {}

bool Eliminated::on_any_rank(bool here) const {
  std::array<PetscInt, 1> flag{here ? 1 : 0};
  over_ranks(layout_.comm, MPI_MAX, flag);
  return flag.front() != 0;
}

/// A without the rows and columns of the pivots, ones on their diagonal.
void Eliminated::drop_pivots(Mat a, const Elimination &z) {
  if (!reduced_) {
    RBVI_CALL(MatDuplicate(a, MAT_COPY_VALUES, reduced_.put()));
    RBVI_CALL(MatSetOption(reduced_.get(), MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  } else {
    RBVI_CALL(MatCopy(a, reduced_.get(), SAME_NONZERO_PATTERN));
  }
  const auto &pivots = z.pivots();
  RBVI_CALL(MatZeroRowsColumns(reduced_.get(), static_cast<PetscInt>(pivots.size()), pivots.data(),
                               1, nullptr, nullptr));
}

/// The same with the pivots tied to other contact dofs.
void Eliminated::tie_pivots(Mat a, const Elimination &z, const SparseMatrix &ties) {
  PetscInt local = 0, first = 0;
  RBVI_CALL(MatGetLocalSize(a, &local, nullptr));
  RBVI_CALL(MatGetOwnershipRange(a, &first, nullptr));
  Handle<Mat> tied;
  Handle<Vec> kept;
  RBVI_CALL(MatCreateVecs(a, kept.put(), nullptr));
  RBVI_CALL(VecSet(kept.get(), 1));
  z.set_pivots(Vector::Zero(ties.rows()), kept.get());
  RBVI_CALL(MatCreateAIJ(layout_.comm, local, local, PETSC_DETERMINE, PETSC_DETERMINE, 64, nullptr,
                         64, nullptr, tied.put()));
  RBVI_CALL(MatSetOption(tied.get(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  {
    LocalValues diagonal(kept.get());
    for (PetscInt row = 0; row < local; ++row)
      RBVI_CALL(
          MatSetValue(tied.get(), first + row, first + row, diagonal.get()[row], INSERT_VALUES));
  }
  for (Index k = 0; k < ties.rows(); ++k)
    for (SparseMatrix::InnerIterator entry(ties, k); entry; ++entry)
      RBVI_CALL(MatSetValue(tied.get(), z.pivots()[k], layout_.columns[entry.col()], entry.value(),
                            INSERT_VALUES));
  assemble(tied.get());
  RBVI_CALL(MatPtAP(a, tied.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, reduced_.put()));
}

/// Factorises A without the pivots, or with them tied.
void Eliminated::precondition(const Operators &op, const Elimination &z) {
  const bool vectors = problem_.scene().components > 1;
  const SparseMatrix ties = vectors && z.count() > 0 ? z.ties() : SparseMatrix();
  tied_ = on_any_rank(ties.nonZeros() > 0);
  if (!tied_)
    drop_pivots(op.a, z);
  else
    tie_pivots(op.a, z, ties);
  // A pivot that is let go before the next factorisation is preconditioned by its own entry of A.
  const Handle<Vec> diagonal = like(op.f);
  RBVI_CALL(MatGetDiagonal(op.a, diagonal.get()));
  const Vector of_a = z.at_pivots(diagonal.get());
  for (Index k = 0; k < of_a.size(); ++k)
    RBVI_CALL(MatSetValue(reduced_.get(), z.pivots()[k], z.pivots()[k], of_a[k], INSERT_VALUES));
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
  factored_ = z.pivots();
  of_another_a_ = false;
  ++factorisations_;
}

/// Sets u and returns this rank's multipliers y. `other`: W of a system that is not symmetric;
/// null: Z. Throws failure where the equation cannot be solved.
Vector Eliminated::eliminate(const Operators &op, const Elimination &z, const Elimination *other,
                             const Vector &constraint, Vec force, double accuracy) {
  const bool symmetric = other == nullptr;
  const Elimination &w = symmetric ? z : *other;
  if (of_another_a_) precondition(op, z);
  const Handle<Vec> scratch = like(op.f);
  ReducedSystem reduced{op.a, z, w, factor_.get(), scratch.get()};

  // right = W^T (force - A u_0).
  const Handle<Vec> right = like(op.f), u_0 = like(op.f);
  RBVI_CALL(VecZeroEntries(u_0.get()));
  if (z.count() > 0) z.extend(constraint, u_0.get());
  RBVI_CALL(MatMult(op.a, u_0.get(), right.get()));
  RBVI_CALL(VecAYPX(right.get(), -1, force));
  reduced.reduce(right.get());

  reduced.zero_pivots(u_.get());
  if (norm(right.get()) == 0) RBVI_CALL(VecZeroEntries(u_.get())); // no noise of a start
  // Relative to the forces; those of the last sets are the best guess.
  const double forces = norm(op.f) + reaction_;
  Krylov how{symmetric, forces > 0 ? 1e-15 : accuracy, accuracy * forces,
             multigrid_ ? steps_worth_a_setup : steps_worth_a_factorisation};
  int steps = solve_reduced(reduced, how, right.get(), u_.get());
  if (steps > how.most_steps) {
    krylov_steps_ += how.most_steps;
    if (on_any_rank(z.pivots() != factored_)) precondition(op, z);
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
  if (z.count() == 0) return {};

  const Handle<Vec> residual = like(op.f);
  RBVI_CALL(MatMult(op.a, u_.get(), residual.get()));
  RBVI_CALL(VecAYPX(residual.get(), -1, force));
  return w.multipliers(residual.get());
}

SetSolution Eliminated::solve_system(const Operators &op, const OwnContact &contact,
                                     const SetSystem &system, double accuracy) {
  const bool symmetric = !on_any_rank(!system.symmetric);
  const SparseMatrix c = rows_of(system.r, contact.b);
  const SparseMatrix reactions = symmetric ? SparseMatrix() : rows_of(system.t, contact.b);
  const Vector constraint = system.r.transpose() * contact.g;
  const Handle<Vec> force = without_reaction(contact, op.f, system.fixed);
  Vector y;
  if (complaint_.empty()) {
    try {
      std::vector<Index> pivots;
      collectively(layout_.comm,
                   [&] { pivots = choose_pivots(dofs_, multipliers_of(system, layout_), c); });
      const Elimination z(layout_, c, pivots, dofs_.moves);
      std::optional<Elimination> unsymmetric;
      if (!symmetric) unsymmetric.emplace(layout_, reactions, pivots, dofs_.moves);
      y = eliminate(op, z, unsymmetric ? &*unsymmetric : nullptr, constraint, force.get(),
                    accuracy);
    } catch (const Error &error) { // of every rank
      complaint_ = error.what();
    }
  }
  if (!complaint_.empty()) {
    const Handle<Mat> of_u = distribute_rows(layout_, c);
    Handle<Mat> of_forces;
    if (!symmetric) of_forces = distribute_rows(layout_, reactions);
    y = solve_saddle(op.a, symmetric ? of_u.get() : of_forces.get(), of_u.get(), force.get(),
                     constraint, u_.get());
  }
  SetSolution found;
  found.x = system.fixed;
  if (y.size() > 0) found.x += system.t * y;
  const Handle<Vec> size = like(op.f);
  LocalValues(contact.x.get()).get() = found.x;
  RBVI_CALL(MatMultTranspose(contact.b_over_ranks.get(), contact.x.get(), size.get()));
  reaction_ = norm(size.get());
  found.w = contact.g - product(contact.b_over_ranks.get(), u_.get(), contact.x.get());
  RBVI_CALL(VecCopy(u_.get(), size.get()));
  RBVI_CALL(VecAbs(size.get()));
  found.terms = contact.g.cwiseAbs() + product(contact.sizes.get(), size.get(), contact.x.get());
  return found;
}

MethodResult Eliminated::solve(const Operators &op, const Vector &start, double accuracy,
                               bool by_rule) {
  complaint_.clear();
  reaction_ = 0; // that of another mu says nothing
  // Ties follow B, which changes with mu.
  if (tied_ || !constant_stiffness(problem_.scene())) of_another_a_ = true;
  MethodResult result;
  result.free_u = like(op.f);
  if (!u_) {
    u_ = like(op.f);
    RBVI_CALL(VecZeroEntries(u_.get()));
  }
  const OwnContact contact(layout_, op);
  const SetSolver solver = [&](const SetSystem &system, double of_system) {
    return solve_system(op, contact, system, of_system);
  };
  const LargestOverRanks largest = [&](Vector &values) {
    over_ranks(layout_.comm, MPI_MAX, values);
  };
  Vector own_start = start.size() > 0 ? Vector(start(layout_.rows)) : Vector();
  for (Index row = 0; row < own_start.size(); ++row) // one that faces no partner has no row
    if (contact.b.row(row).nonZeros() == 0) own_start[row] = 0;
  const FrictionResult found = solve_by_sets(
      solver, diagonal_of(layout_, contact, op.a, result.free_u.get()), own_laws(layout_, op.laws),
      own_start, {{.tolerance = accuracy}, largest, by_rule});
  RBVI_CALL(VecCopy(u_.get(), result.free_u.get()));
  result.iterations = found.iterations;
  result.converged = found.converged;
  result.reason = found.reason;
  if (!found.converged) {
    result.reason += ": try -hf_contact condensed, or a start closer to the solution";
    return result;
  }
  result.lambda = on_every_rank(layout_, found.x);
  result.start = on_every_rank(layout_, found.start);
  result.active = in_contact(op.laws, result.lambda);
  if (complaint_.empty())
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
    from_coarser_ =
        interpolation(coarser_problem_->contact(), problem_.contact(), problem_.dual_layout().own);
  }
  return coarser_ != nullptr;
}

MethodResult GridSequence::solve(const Mu &mu, const Operators &op, const Vector &start,
                                 double accuracy, bool by_rule) {
  constexpr double enough_to_start = 1e-8;
  // Steps from a neighbour are as many as layers of cells between the sets; those from coarser
  // meshes are three or four on every mesh, and cost a third more. Measured on membranes: 0.07 and
  // 0.10 s at 13e3 dofs, 0.51 and 0.47 s at 53e3, 4.8 and 2.1 s at 213e3.
  constexpr PetscInt coarser_from = 40000;
  if (!by_rule) return on_this_.solve(op, start, accuracy);
  if (start.size() > 0 && (problem_.dofs().total_free < coarser_from || !has_coarser()))
    return on_this_.solve(op, start, accuracy, true);
  if (!has_coarser()) return on_this_.solve(op, {}, accuracy, true);
  const Operators &on_coarser = coarser_problem_->assemble(mu, ContactRows::own);
  const MethodResult rough = coarser_->solve(mu, on_coarser, {}, enough_to_start);
  if (!rough.converged) return on_this_.solve(op, {}, accuracy, true);
  return on_this_.solve(op, from_coarser_ * rough.start, accuracy);
}

} // namespace rbvi
