#include "nitsche_system.hpp"

#include "rbvi/contact/nitsche_curve.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/vectors.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace rbvi {

namespace {

/// Functionals of u become those of v, u = Q v in the frames of these bounds.
void turn(const std::vector<NodalBound> &bounds, std::vector<NitscheFace> &faces) {
  std::map<Index, const Vector *> normal_of;
  for (const NodalBound &bound : bounds)
    normal_of[bound.contact_dofs.front()] = &bound.normal;
  for (NitscheFace &face : faces)
    for (std::size_t i = 0; i < 12; i += 2) {
      const auto found = normal_of.find(face.dofs[i]);
      if (found == normal_of.end()) continue;
      const Vector &n = *found->second;
      for (NitschePoint &point : face.points)
        for (NitschePoint::Row *row : {&point.sigma_n, &point.sigma_tau, &point.n, &point.tau}) {
          auto pair = row->segment<2>(static_cast<Index>(i));
          pair = Eigen::Vector2d(n[0] * pair[0] + n[1] * pair[1], n[0] * pair[1] - n[1] * pair[0]);
        }
    }
}

constexpr double at_bound = 1e-13; ///< closer to its bound an unknown is held by it
constexpr double resting = 1e-11;  ///< of a step, relative: round-off, where nu is nearly 0.5, too
constexpr double slowly_resting = 1e-12; ///< where bounds follow the steps, which fall linearly
constexpr double near = 1e-3; ///< residual from which on the linear systems are solved to the end
constexpr int most_iterations = 15;
constexpr double edge_depth = 0.5;  ///< at the edge of contact, over the largest: Hertz's
constexpr int dear_iterations = 10; ///< of conjugate gradients: beyond, a factorisation is cheaper

constexpr const char *not_definite =
    "the tangent of Nitsche's method is not positive definite: raise -nitsche_gamma0";

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
      columns[i] = dof < 0 ? -1 : row_of[dof];
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

NitscheSystem &system_of(void *context) {
  return *static_cast<NitscheSystem *>(context);
}

} // namespace

NitscheSystem::NitscheSystem(const NitscheSolver &of, const Problem &whole,
                             const NitscheOptions &chosen)
    : solver(of), problem(whole), layer(layer_of(whole.contact())), options(chosen),
      rows(global_rows(whole.trace(), whole.dofs().first_free)) {
  if (!options.nonpenetration) return;
  if (layer.follows_state())
    throw bad_input("-nitsche_bounds nonpenetration is for contact at rest: leave it out, or use "
                    "-kinematics small");
  frames.emplace(whole);
}

void NitscheSystem::set(const Operators &op) {
  if (!snes || !finished) make_snes(op);
  finished = false;
  mu = op.mu;
  faces = nitsche_faces(layer, mu, layer.cells);
  if (frames) {
    frames->set(bounds_along(problem.contact(), op.mu));
    turn(frames->bounds(), faces);
    f = frames->turned(op.f);
    upper = frames->upper();
    const Handle<Vec> lower = like(op.f);
    RBVI_CALL(VecSet(lower.get(), PETSC_NINFINITY));
    RBVI_CALL(SNESVISetVariableBounds(snes.get(), lower.get(), upper.get()));
    RBVI_CALL(MatCopy(frames->turned(op.a).get(), a_gamma.get(), DIFFERENT_NONZERO_PATTERN));
  } else {
    f = like(op.f);
    RBVI_CALL(VecCopy(op.f, f.get()));
    RBVI_CALL(MatCopy(op.a, a_gamma.get(), SAME_NONZERO_PATTERN));
  }
  add_blocks(faces, nitsche_consistency(faces), rows, a_gamma.get());
}

void NitscheSystem::residual(Vec u, Vec r) {
  turn_to(u);
  if (bounds_move() && options.single_loop) set_bounds(u);
  const Vector terms = nitsche_residual(faces, on_layer(u), bounds);
  RBVI_CALL(MatMult(a_gamma.get(), u, r));
  RBVI_CALL(VecAXPY(r, -1, f.get()));
  scale = std::max(norm(r) + terms.norm(), smallest_scale);
  add_extension(problem.trace(), terms, r);
}

void NitscheSystem::jacobian(Vec u, Mat matrix) {
  RBVI_CALL(MatCopy(a_gamma.get(), matrix, SAME_NONZERO_PATTERN));
  add_blocks(faces, nitsche_tangent(faces, nitsche_pressures(faces, on_layer(u)), bounds), rows,
             matrix);
}

double NitscheSystem::energy(Vec u) {
  RBVI_CALL(MatMult(a_gamma.get(), u, au.get()));
  return dot(u, au.get()) / 2 - dot(u, f.get()) + nitsche_energy(faces, on_layer(u), bounds);
}

void NitscheSystem::predict_from_rest(Vec u) {
  const Handle<Vec> rest = like(u);
  RBVI_CALL(VecZeroEntries(rest.get()));
  Matrix pressures = nitsche_pressures(faces, on_layer(rest.get()));
  const Vector of_law = nitsche_bounds(faces, pressures);
  pressures.col(0).array() -= edge_depth * std::min(0.0, pressures.col(0).minCoeff());
  predict({rest.get(), pressures}, bounds_move() ? Vector(of_law.cwiseMin(0.0)) : of_law, u);
}

void NitscheSystem::predict(const NitscheStart &start, const Vector &friction_bounds, Vec u) {
  bounds = friction_bounds;
  KSP ksp = nullptr;
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(MatCopy(a_gamma.get(), tangent.get(), SAME_NONZERO_PATTERN));
  add_blocks(faces, nitsche_tangent(faces, start.pressures, bounds), rows, tangent.get());
  Handle<Vec> turned;
  if (frames) turned = frames->turned(start.u);
  Vec from = frames ? turned.get() : start.u;
  turn_to(from);
  RBVI_CALL(MatMult(a_gamma.get(), from, au.get()));
  RBVI_CALL(VecAXPY(au.get(), -1, f.get()));
  const Vector terms = nitsche_linearised(faces, on_layer(from), start.pressures, bounds);
  add_extension(problem.trace(), terms, au.get());
  RBVI_CALL(KSPSetTolerances(ksp, 1e-6, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(KSPSetOperators(ksp, tangent.get(), tangent.get()));
  const auto converges = [&](bool anew) {
    factorised = anew;
    if (anew) ++factorisations;
    RBVI_CALL(KSPSetReusePreconditioner(ksp, anew ? PETSC_FALSE : PETSC_TRUE));
    if (KSPSolve(ksp, au.get(), ay.get()) != 0) throw failure(not_definite);
    check_linear_solve();
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    RBVI_CALL(KSPGetConvergedReason(ksp, &reason));
    return reason > 0;
  };
  if (!converges(factorisations == 0)) converges(true);
  RBVI_CALL(VecWAXPY(u, -1, ay.get(), from));
}

void NitscheSystem::before_step() {
  KSP ksp = nullptr;
  Vec u = nullptr;
  PetscInt iterations = 0;
  PetscReal size = 0;
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(SNESGetSolution(snes.get(), &u));
  RBVI_CALL(SNESGetFunctionNorm(snes.get(), &size));
  RBVI_CALL(KSPGetIterationNumber(ksp, &iterations));
  factorised = factorisations == 0 || iterations > dear_iterations;
  if (factorised) ++factorisations;
  RBVI_CALL(KSPSetTolerances(
      ksp, size > near * scale ? linear_tolerance : std::min(linear_tolerance, 1e-8), PETSC_DEFAULT,
      PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(SNESSetLagPreconditioner(snes.get(), factorised ? -2 : -1)); // now, or not at all
  if (solver.watch) solver.watch(on_layer(u), bounds);
}

/// Where an earlier factorisation is too far off, the iterations end early: their result still
/// descends, and the next step is factorised anew.
void NitscheSystem::check_linear_solve() const {
  KSP ksp = nullptr;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(KSPGetConvergedReason(ksp, &reason));
  if (reason == KSP_DIVERGED_ITS && factorised)
    throw failure("conjugate gradients did not converge with a new preconditioner: raise "
                  "-nitsche_ksp_max_it");
  if (reason == KSP_DIVERGED_INDEFINITE_MAT || reason == KSP_DIVERGED_INDEFINITE_PC ||
      (reason < 0 && factorised))
    throw failure(not_definite);
  if (factorised) check_inertia(ksp);
}

/// u <- u - t y with the t of least energy.
void NitscheSystem::search(SNESLineSearch line) {
  Vec u = nullptr, r = nullptr, y = nullptr;
  RBVI_CALL(SNESLineSearchGetVecs(line, &u, &r, &y, nullptr, nullptr));
  check_linear_solve();
  RBVI_CALL(MatMult(a_gamma.get(), u, au.get()));
  RBVI_CALL(VecAXPY(au.get(), -1, f.get()));
  RBVI_CALL(MatMult(a_gamma.get(), y, ay.get()));
  const NitscheLine along = nitsche_line(faces, on_layer(u), -on_layer(y), bounds);
  const double linear = -dot(au.get(), y), quadratic = dot(ay.get(), y);
  const bool descends = linear + along.slope(0) < 0;
  const bool searches = descends && !options.plain_steps;
  const double t = searches ? line_minimum(linear, quadratic, along) : 1;
  RBVI_CALL(VecAXPY(u, -t, y));
  if (frames) RBVI_CALL(VecPointwiseMin(u, u, upper.get()));
  RBVI_CALL(SNESLineSearchSetLambda(line, t));
  RBVI_CALL(SNESComputeFunction(snes.get(), u, r));
  RBVI_CALL(SNESLineSearchComputeNorms(line));
}

double NitscheSystem::relative_residual(Vec u) {
  residual(u, force.get());
  if (frames) { // u < upper: nothing may push; u = upper: only outwards (r < 0)
    PetscInt count = 0;
    PetscScalar *r = nullptr;
    const PetscScalar *value = nullptr, *bound = nullptr;
    RBVI_CALL(VecGetLocalSize(u, &count));
    RBVI_CALL(VecGetArray(force.get(), &r));
    RBVI_CALL(VecGetArrayRead(u, &value));
    RBVI_CALL(VecGetArrayRead(upper.get(), &bound));
    for (PetscInt i = 0; i < count; ++i)
      if (value[i] >= bound[i] - at_bound && r[i] < 0) r[i] = 0;
    RBVI_CALL(VecRestoreArrayRead(upper.get(), &bound));
    RBVI_CALL(VecRestoreArrayRead(u, &value));
    RBVI_CALL(VecRestoreArray(force.get(), &r));
  }
  return scale == 0 ? 0 : norm(force.get()) / scale;
}

int NitscheSystem::newton(Vec u, std::string &reason) {
  failed = nullptr;
  residual(u, force.get()); // sets the scale
  const double left = nitsche_round_off(faces, on_layer(u));
  RBVI_CALL(SNESSetTolerances(snes.get(), largest({small_residual, tolerance * scale, left}), 0,
                              PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  const PetscErrorCode code = SNESSolve(snes.get(), nullptr, u);
  if (failed) std::rethrow_exception(failed);
  SNESConvergedReason why = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  RBVI_CALL(SNESGetConvergedReason(snes.get(), &why));
  RBVI_CALL(SNESGetIterationNumber(snes.get(), &iterations));
  reason = std::string("SNES: ") + SNESConvergedReasons[why];
  if (code != 0 || why == SNES_DIVERGED_LINEAR_SOLVE) throw failure(not_definite);
  if (why < 0)
    throw failure(reason + " after " + std::to_string(iterations) + " Newton steps: try " +
                  (options.plain_steps ? "-nitsche_steps searched" : "another -nitsche_gamma0") +
                  ", or more -nitsche_snes_max_it");
  return static_cast<int>(iterations);
}

void NitscheSystem::make_snes(const Operators &op) {
  factorisations = 0;
  RBVI_CALL(MatDuplicate(op.a, MAT_COPY_VALUES, a_gamma.put()));
  RBVI_CALL(MatDuplicate(op.a, MAT_COPY_VALUES, tangent.put()));
  RBVI_CALL(MatSetOption(tangent.get(), MAT_SPD, PETSC_TRUE));
  for (Handle<Vec> *scratch : {&au, &ay, &force})
    *scratch = like(op.f);
  RBVI_CALL(SNESCreate(problem.trace().comm, snes.put()));
  RBVI_CALL(SNESSetOptionsPrefix(snes.get(), "nitsche_"));
  // The type comes first: a change of type destroys the line search.
  char type[64] = SNESVINEWTONSSLS;
  if (options.nonpenetration) std::strcpy(type, SNESVINEWTONRSLS);
  RBVI_CALL(PetscOptionsGetString(nullptr, "nitsche_", "-snes_type", type, sizeof type, nullptr));
  if (options.nonpenetration && std::string(type) != SNESVINEWTONRSLS)
    throw bad_input("-nitsche_bounds nonpenetration needs -nitsche_snes_type vinewtonrsls");
  RBVI_CALL(SNESSetType(snes.get(), type));
  if (options.nonpenetration) { // by default PETSc holds whoever is within 1e-8 of a bound
    PetscBool given = PETSC_FALSE;
    const std::string name = "-nitsche_snes_vi_zero_tolerance";
    RBVI_CALL(PetscOptionsHasName(nullptr, nullptr, name.c_str(), &given));
    if (given == PETSC_FALSE) RBVI_CALL(PetscOptionsSetValue(nullptr, name.c_str(), "1e-14"));
  }
  set_callbacks();
  RBVI_CALL(SNESSetTolerances(snes.get(), small_residual, accuracy,
                              options.single_loop ? slowly_resting : resting, 100, 100000));
  RBVI_CALL(SNESSetDivergenceTolerance(snes.get(), -1)); // it starts close to its end
  set_linear_solver();
  RBVI_CALL(SNESGetTolerances(snes.get(), &small_residual, &accuracy, nullptr, nullptr, nullptr));
  const bool extended = std::string(type).starts_with("vi");
  if (!extended || frames) return;
  const Handle<Vec> lower = like(op.f);
  upper = like(op.f);
  RBVI_CALL(VecSet(lower.get(), PETSC_NINFINITY));
  RBVI_CALL(VecSet(upper.get(), PETSC_INFINITY));
  RBVI_CALL(SNESVISetVariableBounds(snes.get(), lower.get(), upper.get()));
}

void NitscheSystem::set_callbacks() {
  RBVI_CALL(SNESSetApplicationContext(snes.get(), this));
  RBVI_CALL(SNESSetFunction(
      snes.get(), force.get(),
      [](SNES, Vec u, Vec r, void *context) {
        auto &self = system_of(context);
        return guarded(self.failed, [&] { self.residual(u, r); });
      },
      this));
  RBVI_CALL(SNESSetJacobian(
      snes.get(), tangent.get(), tangent.get(),
      [](SNES, Vec u, Mat, Mat matrix, void *context) {
        auto &self = system_of(context);
        return guarded(self.failed, [&] { self.jacobian(u, matrix); });
      },
      this));
  RBVI_CALL(SNESSetUpdate(snes.get(), [](SNES which, PetscInt) {
    void *context = nullptr;
    PetscCall(SNESGetApplicationContext(which, &context));
    auto &self = system_of(context);
    return guarded(self.failed, [&] { self.before_step(); });
  }));
  if (!options.single_loop && !layer.follows_state())
    RBVI_CALL(SNESSetObjective(
        snes.get(),
        [](SNES, Vec u, PetscReal *value, void *context) {
          auto &self = system_of(context);
          return guarded(self.failed, [&] { *value = self.energy(u); });
        },
        this));
  SNESLineSearch line = nullptr;
  RBVI_CALL(SNESGetLineSearch(snes.get(), &line));
  RBVI_CALL(SNESLineSearchSetType(line, SNESLINESEARCHSHELL));
  RBVI_CALL(SNESLineSearchShellSetUserFunc(
      line,
      [](SNESLineSearch search, void *context) {
        auto &self = system_of(context);
        return guarded(self.failed, [&] { self.search(search); });
      },
      this));
}

void NitscheSystem::set_linear_solver() {
  KSP ksp = nullptr;
  PC pc = nullptr;
  const int ranks = ranks_of(problem.trace().comm);
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
  if (options.plain_steps)
    RBVI_CALL(KSPSetTolerances(ksp, 1e-10, PETSC_DEFAULT, PETSC_DEFAULT, 200));
  RBVI_CALL(KSPGetTolerances(ksp, &linear_tolerance, nullptr, nullptr, nullptr));
}

} // namespace rbvi
