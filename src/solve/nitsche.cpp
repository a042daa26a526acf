#include "rbvi/solve/nitsche.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <cmath>
#include <cstring>

namespace rbvi {

namespace {

constexpr double accuracy = 1e-12;       ///< of the residual, relative
constexpr double round_off = 1e-9;       ///< below it the residual may stagnate
constexpr double bound_accuracy = 1e-12; ///< change of u by new bounds of friction, relative
constexpr int patience = 4;        ///< steps without a new smallest residual, the bounds moving
constexpr double resting = 0.9;    ///< of the last change: from there on it is round-off
constexpr double vanishing = 1e-9; ///< of the start: below it terms count as zero
constexpr int most_outer_iterations = 60;
constexpr double near = 1e-4; ///< residual from which on the linear systems are solved to the end
constexpr int most_iterations = 60;
constexpr int dear_iterations = 10; ///< of conjugate gradients: beyond, a factorisation is cheaper

constexpr const char *not_definite =
    "the tangent of Nitsche's method is not positive definite: raise -nitsche_gamma0";

double norm(Vec v) {
  PetscReal value = 0;
  RBVI_CALL(VecNorm(v, NORM_2, &value));
  return value;
}

double dot(Vec a, Vec b) {
  PetscScalar value = 0;
  RBVI_CALL(VecDot(a, b, &value));
  return value;
}

Handle<Vec> like(Vec v) {
  Handle<Vec> result;
  RBVI_CALL(VecDuplicate(v, result.put()));
  return result;
}

/// No exception passes through PETSc: it is kept, and thrown where SNES has returned.
template <class Work> PetscErrorCode guarded(std::exception_ptr &failed, const Work &work) {
  try {
    work();
    return 0;
  } catch (...) {
    failed = std::current_exception();
    return PETSC_ERR_USER;
  }
}

std::vector<PetscInt> rows_of(const Trace &trace, PetscInt first_row) {
  std::vector<PetscInt> rows(static_cast<std::size_t>(trace.size), 0);
  for (std::size_t k = 0; k < trace.index.size(); ++k)
    rows[static_cast<std::size_t>(trace.index[k])] = first_row + trace.local_row[k];
  MPI_Allreduce(MPI_IN_PLACE, rows.data(), static_cast<int>(rows.size()), MPIU_INT, MPI_SUM,
                trace.comm);
  return rows;
}

/// Adds blocks of the faces, every rank in its own rows.
void add_blocks(const std::vector<NitscheFace> &faces, const std::vector<FaceBlock> &blocks,
                const std::vector<PetscInt> &row_of, Mat matrix) {
  PetscInt first = 0, last = 0;
  RBVI_CALL(MatGetOwnershipRange(matrix, &first, &last));
  for (std::size_t f = 0; f < blocks.size(); ++f) {
    if (blocks[f].isZero(0)) continue;
    std::array<PetscInt, 12> rows{}, columns{}; // negative ones are left out
    for (std::size_t i = 0; i < 12; ++i) {
      const int dof = faces[f].dofs[i];
      columns[i] = dof < 0 ? -1 : row_of[static_cast<std::size_t>(dof)];
      rows[i] = columns[i] >= first && columns[i] < last ? columns[i] : -1;
    }
    const Eigen::Matrix<double, 12, 12, Eigen::RowMajor> values = blocks[f];
    RBVI_CALL(MatSetValues(matrix, 12, rows.data(), 12, columns.data(), values.data(), ADD_VALUES));
  }
  RBVI_CALL(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

/// Throws failure if the factorisation that `ksp` has just made shows a negative eigenvalue, as far
/// as its package tells.
void check_inertia(KSP ksp) {
  PC pc = nullptr;
  RBVI_CALL(KSPGetPC(ksp, &pc));
  PetscBool cholesky = PETSC_FALSE;
  RBVI_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCCHOLESKY, &cholesky));
  if (cholesky == PETSC_FALSE) return;
  MatSolverType package = nullptr;
  RBVI_CALL(PCFactorGetMatSolverType(pc, &package));
  if (package == nullptr || std::string(package) != MATSOLVERMUMPS) return; // CHOLMOD stops itself
  Mat factor = nullptr;
  PetscInt negative = 0, counts = 0;
  RBVI_CALL(PCFactorGetMatrix(pc, &factor));
  RBVI_CALL(MatMumpsGetIcntl(factor, 13, &counts));
  if (counts != 1) return; // a type of SNES has made the solver anew
  RBVI_CALL(MatGetInertia(factor, &negative, nullptr, nullptr));
  if (negative > 0) throw failure(not_definite);
}

} // namespace

/// The system at one mu, and the objects that live as long as the solver.
struct NitscheSolver::System {
  explicit System(const NitscheSolver &of)
      : solver(of), rows(rows_of(of.layer_.trace, of.problem_.dofs().first_free)) {}

  const NitscheSolver &solver;
  std::vector<PetscInt> rows; ///< of the dofs of the layer
  Handle<SNES> snes;
  Handle<Mat> a_gamma, tangent;
  Handle<Vec> au, ay, force; ///< scratch
  double sign = 1;           ///< of what SNES is given: see set_up
  double linear_tolerance = 1e-2;

  Vec f = nullptr;
  std::vector<NitscheFace> faces;
  NitscheLaw law;
  Vector bounds;
  double tolerance = accuracy;
  double scale = 0, relative = 1; ///< of the last residual: its terms' norms, its part of them
  double smallest_scale = 0;      ///< where the answer is zero all its terms are round-off
  double best = 1;                ///< the smallest part so far, and its step
  PetscInt best_step = 0;
  int factorisations = 0;
  bool factorised = false; ///< in this step
  std::exception_ptr failed;

  Vector on_layer(Vec u) const { return restrict_to(solver.layer_.trace, u); }
  void set_bounds(Vec u) { bounds = nitsche_bounds(nitsche_pressures(faces, on_layer(u)), law); }

  void set_up(const Operators &op);
  void residual(Vec u, Vec r);
  void jacobian(Vec u, Mat matrix);
  double energy(Vec u);
  void predict(const NitscheState &start, Vec u);
  void before_step();
  void check_linear_solve() const;
  void search(SNESLineSearch line);
  SNESConvergedReason judge(PetscInt step, double r);
};

void NitscheSolver::System::residual(Vec u, Vec r) {
  if (law.moves() && solver.options_.single_loop) set_bounds(u);
  const Vector terms = nitsche_residual(faces, on_layer(u), bounds);
  RBVI_CALL(MatMult(a_gamma.get(), u, r));
  RBVI_CALL(VecAXPY(r, -1, f));
  scale = std::max(norm(r) + terms.norm(), smallest_scale);
  add_extension(solver.layer_.trace, terms, r);
}

void NitscheSolver::System::jacobian(Vec u, Mat matrix) {
  RBVI_CALL(MatCopy(a_gamma.get(), matrix, SAME_NONZERO_PATTERN));
  add_blocks(faces, nitsche_tangent(faces, nitsche_pressures(faces, on_layer(u)), bounds), rows,
             matrix);
}

double NitscheSolver::System::energy(Vec u) {
  RBVI_CALL(MatMult(a_gamma.get(), u, au.get()));
  return dot(u, au.get()) / 2 - dot(u, f) + nitsche_energy(faces, on_layer(u), bounds);
}

/// One linear solve for u, where contact and stick are those of `start`.
void NitscheSolver::System::predict(const NitscheState &start, Vec u) {
  KSP ksp = nullptr;
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(MatCopy(a_gamma.get(), tangent.get(), SAME_NONZERO_PATTERN));
  add_blocks(faces, nitsche_tangent(faces, start.pressures, start.bounds), rows, tangent.get());
  RBVI_CALL(MatMult(a_gamma.get(), start.u.get(), au.get()));
  RBVI_CALL(VecAXPY(au.get(), -1, f));
  const Vector terms =
      nitsche_linearised(faces, on_layer(start.u.get()), start.pressures, start.bounds);
  add_extension(solver.layer_.trace, terms, au.get());
  RBVI_CALL(KSPSetTolerances(ksp, 1e-6, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(KSPSetOperators(ksp, tangent.get(), tangent.get()));
  RBVI_CALL(KSPSetReusePreconditioner(ksp, factorisations > 0 ? PETSC_TRUE : PETSC_FALSE));
  factorisations = std::max(factorisations, 1);
  RBVI_CALL(KSPSolve(ksp, au.get(), ay.get()));
  RBVI_CALL(VecWAXPY(u, -1, ay.get(), start.u.get()));
}

void NitscheSolver::System::before_step() {
  KSP ksp = nullptr;
  Vec u = nullptr;
  PetscInt iterations = 0;
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(SNESGetSolution(snes.get(), &u));
  RBVI_CALL(KSPGetIterationNumber(ksp, &iterations));
  factorised = factorisations == 0 || iterations > dear_iterations;
  if (factorised) ++factorisations;
  RBVI_CALL(KSPSetTolerances(ksp,
                             relative > near ? linear_tolerance : std::min(linear_tolerance, 1e-8),
                             PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(SNESSetLagPreconditioner(snes.get(), factorised ? -2 : -1)); // now, or not at all
  if (solver.watch) solver.watch(on_layer(u), bounds);
}

/// Where an earlier factorisation is too far off, the iterations end early: their result still
/// descends, and the next step is factorised anew.
void NitscheSolver::System::check_linear_solve() const {
  KSP ksp = nullptr;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(KSPGetConvergedReason(ksp, &reason));
  if (reason == KSP_DIVERGED_INDEFINITE_MAT || reason == KSP_DIVERGED_INDEFINITE_PC ||
      (reason < 0 && factorised))
    throw failure(not_definite);
  if (factorised) check_inertia(ksp);
}

/// u <- u - t y with the t of least energy.
void NitscheSolver::System::search(SNESLineSearch line) {
  Vec u = nullptr, r = nullptr, y = nullptr;
  RBVI_CALL(SNESLineSearchGetVecs(line, &u, &r, &y, nullptr, nullptr));
  check_linear_solve();
  RBVI_CALL(MatMult(a_gamma.get(), u, au.get()));
  RBVI_CALL(VecAXPY(au.get(), -1, f));
  RBVI_CALL(MatMult(a_gamma.get(), y, ay.get()));
  const NitscheLine along = nitsche_line(faces, on_layer(u), -on_layer(y), bounds);
  const double linear = -dot(au.get(), y), quadratic = dot(ay.get(), y);
  const bool descends = linear + along.slope(0) < 0;
  const bool searches = descends && !solver.options_.full_steps;
  const double t = searches ? line_minimum(linear, quadratic, along) : 1;
  RBVI_CALL(VecAXPY(u, -t, y));
  RBVI_CALL(SNESLineSearchSetLambda(line, t));
  RBVI_CALL(SNESComputeFunction(snes.get(), u, r));
  RBVI_CALL(SNESLineSearchComputeNorms(line));
}

SNESConvergedReason NitscheSolver::System::judge(PetscInt step, double r) {
  if (!std::isfinite(r)) return SNES_DIVERGED_FNORM_NAN;
  const double before = relative;
  relative = scale > 0 ? r / scale : 0;
  if (relative <= tolerance) return SNES_CONVERGED_FNORM_RELATIVE;
  if (step == 0 || relative < best) {
    best = relative;
    best_step = step;
  }
  // Where bounds follow the steps, residuals fall slowly, and not at each step.
  const bool stagnant = law.moves() && solver.options_.single_loop ? step - best_step >= patience
                                                                   : relative > 0.1 * before;
  if (step > 0 && relative <= round_off && stagnant) return SNES_CONVERGED_SNORM_RELATIVE;
  return SNES_CONVERGED_ITERATING;
}

namespace {

template <class System> System &system_of(void *context) {
  return *static_cast<System *>(context);
}

} // namespace

void NitscheSolver::System::set_up(const Operators &op) {
  f = op.f;
  if (snes) return;
  const MPI_Comm comm = solver.problem_.comm();
  RBVI_CALL(MatDuplicate(op.a, MAT_COPY_VALUES, a_gamma.put()));
  RBVI_CALL(MatDuplicate(op.a, MAT_COPY_VALUES, tangent.put()));
  RBVI_CALL(MatSetOption(tangent.get(), MAT_SPD, PETSC_TRUE));
  for (Handle<Vec> *scratch : {&au, &ay, &force})
    *scratch = like(op.f);
  RBVI_CALL(SNESCreate(comm, snes.put()));
  RBVI_CALL(SNESSetOptionsPrefix(snes.get(), "nitsche_"));
  // The type comes first: a change of type destroys the line search.
  char type[64] = SNESVINEWTONSSLS;
  if (solver.options_.nonpenetration) std::strcpy(type, SNESVINEWTONRSLS);
  RBVI_CALL(PetscOptionsGetString(nullptr, "nitsche_", "-snes_type", type, sizeof type, nullptr));
  RBVI_CALL(SNESSetType(snes.get(), type));
  RBVI_CALL(SNESSetApplicationContext(snes.get(), this));
  RBVI_CALL(SNESSetFunction(
      snes.get(), force.get(),
      [](SNES, Vec u, Vec r, void *context) {
        auto &self = system_of<System>(context);
        return guarded(self.failed, [&] { self.residual(u, r); });
      },
      this));
  RBVI_CALL(SNESSetJacobian(
      snes.get(), tangent.get(), tangent.get(),
      [](SNES, Vec u, Mat, Mat matrix, void *context) {
        auto &self = system_of<System>(context);
        return guarded(self.failed, [&] { self.jacobian(u, matrix); });
      },
      this));
  RBVI_CALL(SNESSetUpdate(snes.get(), [](SNES which, PetscInt) {
    void *context = nullptr;
    PetscCall(SNESGetApplicationContext(which, &context));
    auto &self = system_of<System>(context);
    return guarded(self.failed, [&] { self.before_step(); });
  }));
  RBVI_CALL(SNESSetConvergenceTest(
      snes.get(),
      [](SNES, PetscInt step, PetscReal, PetscReal, PetscReal r, SNESConvergedReason *reason,
         void *context) -> PetscErrorCode {
        *reason = system_of<System>(context).judge(step, r);
        return 0;
      },
      this, nullptr));
  if (!solver.options_.single_loop)
    RBVI_CALL(SNESSetObjective(
        snes.get(),
        [](SNES, Vec u, PetscReal *value, void *context) {
          auto &self = system_of<System>(context);
          return guarded(self.failed, [&] { *value = self.energy(u); });
        },
        this));
  SNESLineSearch line = nullptr;
  RBVI_CALL(SNESGetLineSearch(snes.get(), &line));
  RBVI_CALL(SNESLineSearchSetType(line, SNESLINESEARCHSHELL));
  RBVI_CALL(SNESLineSearchShellSetUserFunc(
      line,
      [](SNESLineSearch search, void *context) {
        auto &self = system_of<System>(context);
        return guarded(self.failed, [&] { self.search(search); });
      },
      this));
  RBVI_CALL(SNESSetTolerances(snes.get(), 0, 0, 0, 100, 100000));
  KSP ksp = nullptr;
  PC pc = nullptr;
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(KSPSetType(ksp, KSPCG));
  RBVI_CALL(KSPSetTolerances(ksp, linear_tolerance, PETSC_DEFAULT, 1e30, most_iterations));
  RBVI_CALL(SNESSetMaxLinearSolveFailures(snes.get(), 1000));
  RBVI_CALL(KSPGetPC(ksp, &pc));
  RBVI_CALL(PCSetType(pc, PCCHOLESKY));
  RBVI_CALL(PCFactorSetMatSolverType(pc, ranks == 1 ? MATSOLVERCHOLMOD : MATSOLVERMUMPS));
  if (ranks > 1) { // without it MUMPS does not count negative eigenvalues
    Mat factor = nullptr;
    RBVI_CALL(KSPSetOperators(ksp, tangent.get(), tangent.get()));
    RBVI_CALL(PCFactorSetUpMatSolverType(pc));
    RBVI_CALL(PCFactorGetMatrix(pc, &factor));
    RBVI_CALL(MatMumpsSetIcntl(factor, 13, 1));
  }
  RBVI_CALL(SNESSetFromOptions(snes.get()));
  if (solver.options_.full_steps)
    RBVI_CALL(KSPSetTolerances(ksp, 1e-10, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(KSPGetTolerances(ksp, &linear_tolerance, nullptr, nullptr, nullptr));
  const Handle<Vec> lower = like(op.f), upper = like(op.f);
  RBVI_CALL(VecSet(lower.get(), PETSC_NINFINITY));
  RBVI_CALL(VecSet(upper.get(), PETSC_INFINITY));
  PetscBool bounded = PETSC_FALSE;
  RBVI_CALL(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(snes.get()), &bounded,
                                      SNESVINEWTONSSLS, SNESVINEWTONRSLS, ""));
  if (bounded == PETSC_TRUE)
    RBVI_CALL(SNESVISetVariableBounds(snes.get(), lower.get(), upper.get()));
}

NitscheSolver::NitscheSolver(Problem &problem, const NitscheOptions &options)
    : problem_(problem), options_(options),
      layer_(make_contact_layer(problem.mesh(), problem.dofs(), problem.scene().support->boundary)),
      system_(new System(*this)) {}

NitscheSolver::~NitscheSolver() = default;

namespace {

/// Newton steps from u, in place.
int newton(SNES snes, Vec u, std::exception_ptr &failed, std::string &reason) {
  failed = nullptr;
  const PetscErrorCode code = SNESSolve(snes, nullptr, u);
  if (failed) std::rethrow_exception(failed);
  SNESConvergedReason why = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  RBVI_CALL(SNESGetConvergedReason(snes, &why));
  RBVI_CALL(SNESGetIterationNumber(snes, &iterations));
  reason = std::string("SNES: ") + SNESConvergedReasons[why];
  if (code != 0 || why == SNES_DIVERGED_LINEAR_SOLVE) throw failure(not_definite);
  if (why < 0)
    throw failure(reason + " after " + std::to_string(iterations) +
                  " Newton steps: try another -nitsche_gamma0, or more -nitsche_snes_max_it");
  return static_cast<int>(iterations);
}

} // namespace

NitscheSolution NitscheSolver::solve(const Operators &op, const NitscheState *start) {
  const Scene &scene = problem_.scene();
  System &system = *system_;
  system.set_up(op);
  system.faces = nitsche_faces(scene, op.mu, layer_.cells);
  system.law = nitsche_law(scene.support->friction, op.mu);
  const bool friction = system.law.law != FrictionLaw::none;
  RBVI_CALL(MatCopy(op.a, system.a_gamma.get(), SAME_NONZERO_PATTERN));
  add_blocks(system.faces, nitsche_consistency(system.faces, friction), system.rows,
             system.a_gamma.get());

  NitscheSolution result;
  const int factorised_before = system.factorisations;
  result.state.u = like(op.f);
  Vec u = result.state.u.get();
  const bool nested = system.law.moves() && !options_.single_loop;
  if (start != nullptr) {
    system.predict(*start, u);
    system.bounds = start->bounds;
    if (!system.law.moves()) system.set_bounds(u);
  } else {
    RBVI_CALL(VecZeroEntries(u));
    system.set_bounds(u);
    if (nested) system.bounds.setZero();
  }
  system.smallest_scale = 0;
  system.residual(u, system.force.get());
  system.smallest_scale = vanishing * system.scale;
  run(nested, u, result);
  result.factorisations = system.factorisations - factorised_before;
  result.layer = system.on_layer(u);
  result.state.pressures = nitsche_pressures(system.faces, result.layer);
  result.state.bounds = system.bounds;
  system.residual(u, system.force.get());
  result.residual = system.scale > 0 ? norm(system.force.get()) / system.scale : 0;
  RBVI_CALL(MatMult(op.a, u, system.au.get()));
  result.energy = dot(system.au.get(), u) / 2 - dot(op.f, u);
  return result;
}

void NitscheSolver::run(bool nested, Vec u, NitscheSolution &result) {
  System &system = *system_;
  const Handle<Vec> before = like(u);
  system.tolerance = nested ? 1e-3 : accuracy;
  double last_change = 1;
  for (;;) {
    RBVI_CALL(VecCopy(u, before.get()));
    result.iterations += newton(system.snes.get(), u, system.failed, result.reason);
    ++result.outer_iterations;
    if (!nested) return;
    system.set_bounds(u);
    RBVI_CALL(VecAXPY(before.get(), -1, u));
    const double size = norm(u), change = size > 0 ? norm(before.get()) / size : 0;
    const bool rests = change <= round_off && change > resting * last_change;
    if ((change <= bound_accuracy || rests) && system.tolerance <= accuracy) return;
    last_change = change;
    system.tolerance = std::clamp(1e-2 * change, accuracy, system.tolerance);
    if (result.outer_iterations == most_outer_iterations)
      throw failure("Coulomb's bound did not settle in " + std::to_string(most_outer_iterations) +
                    " steps: it still changes u by " + short_number(change) +
                    "; is the friction coefficient large?");
  }
}

} // namespace rbvi
