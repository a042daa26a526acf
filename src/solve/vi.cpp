#include "local_frames.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/petsc.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/vectors.hpp"

#include <array>
#include <cmath>

namespace rbvi {

namespace {

/// a v = f in unknowns v that are bounded one by one: u itself where it is scalar, else its normal
/// and tangential components (local frames).
struct PrimalProblem {
  Mat a;
  Vec f;
  Handle<Vec> lower, upper;
  Handle<Mat> turned_a{}; ///< in local frames: a and f
  Handle<Vec> turned_f{};
};

PetscErrorCode residual(SNES, Vec u, Vec r, void *context) {
  const auto *problem = static_cast<PrimalProblem *>(context);
  PetscFunctionBeginUser;
  PetscCall(MatMult(problem->a, u, r));
  PetscCall(VecAXPY(r, -1, problem->f));
  PetscFunctionReturn(0);
}

/// Constant, but filled again at every step: the semismooth variant scales its rows in place.
PetscErrorCode jacobian(SNES, Vec, Mat, Mat tangent, void *context) {
  return MatCopy(static_cast<PrimalProblem *>(context)->a, tangent, SAME_NONZERO_PATTERN);
}

PetscErrorCode energy(SNES, Vec u, PetscReal *value, void *context) {
  const auto *problem = static_cast<PrimalProblem *>(context);
  PetscFunctionBeginUser;
  Vec scratch = nullptr;
  PetscScalar quadratic = 0, linear = 0;
  PetscCall(VecDuplicate(u, &scratch));
  PetscCall(MatMult(problem->a, u, scratch));
  PetscCall(VecDot(u, scratch, &quadratic));
  PetscCall(VecDot(u, problem->f, &linear));
  PetscCall(VecDestroy(&scratch));
  *value = quadratic / 2 - linear;
  PetscFunctionReturn(0);
}

/// Of this rank's nodes, where displacements are vectors: row i of b bounds one, b_i / |b_i| is a
/// normal there.
std::vector<NodalBound> nodal_bounds(const Contact &contact, const DualLayout &layout,
                                     const Operators &op) {
  std::vector<NodalBound> bounds;
  Index row = 0;
  for (std::size_t k = 0; k < contact.interfaces.size(); ++k) {
    const ContactInterface &interface = *contact.interfaces[k];
    for (std::size_t i = 0; i < interface.dual().vertices.size(); ++i, ++row) {
      if (!layout.own[k][i]) continue;
      const Index node = interface.dual().vertices[i];
      NodalBound bound{{}, Vector(interface.mesh().components), op.g[row]};
      Index free = 0;
      for (Index c = 0; c < bound.normal.size(); ++c)
        if (const Index dof = interface.mesh().dofs[bound.normal.size() * node + c]; dof >= 0) {
          bound.contact_dofs.push_back(dof);
          bound.normal[free++] = op.b.coeff(row, dof);
        }
      bound.normal.conservativeResize(free);
      const double size = bound.normal.norm();
      if (!(size > 0)) continue;
      bound.normal /= size;
      bound.gap /= size;
      bounds.push_back(std::move(bound));
    }
  }
  return bounds;
}

PetscInt first_row(Mat b) {
  PetscInt first = 0;
  RBVI_CALL(MatGetOwnershipRange(b, &first, nullptr));
  return first;
}

/// Scalar displacements: row i of b reads b_i u_c <= g_i.
void set_bounds(const DistributedContact &contact, PrimalProblem &primal) {
  LocalValues g(contact.g.get());
  const PetscInt first = first_row(contact.b.get());
  visit_entries(contact.b.get(), [&](PetscInt row, PetscInt column, double value) {
    if (value == 0) return;
    const Handle<Vec> &bound = value < 0 ? primal.lower : primal.upper;
    RBVI_CALL(VecSetValue(bound.get(), column, g.get()[row - first] / value, INSERT_VALUES));
  });
  for (const Handle<Vec> *bound : {&primal.lower, &primal.upper}) {
    RBVI_CALL(VecAssemblyBegin(bound->get()));
    RBVI_CALL(VecAssemblyEnd(bound->get()));
  }
}

/// lambda_i = b_i (F - A u) / |b_i|^2, zero where the node is free. `gap`: the largest in size.
Handle<Vec> recover_multiplier(const DistributedContact &contact, const Operators &op, double gap,
                               Vec u) {
  const Handle<Vec> r = like(u), bu = like(contact.g.get());
  Handle<Vec> lambda = like(contact.g.get());
  RBVI_CALL(MatMult(op.a, u, r.get()));
  RBVI_CALL(VecAYPX(r.get(), -1, op.f));
  RBVI_CALL(MatMult(contact.b.get(), r.get(), lambda.get()));
  RBVI_CALL(MatMult(contact.b.get(), u, bu.get()));
  LocalValues value(lambda.get()), constraint(bu.get()), g(contact.g.get());
  Vector squares = Vector::Zero(g.get().size());
  const PetscInt first = first_row(contact.b.get());
  visit_entries(contact.b.get(), [&](PetscInt row, PetscInt, double entry) {
    squares[row - first] += entry * entry;
  });
  for (Index i = 0; i < squares.size(); ++i) {
    const double size = std::sqrt(squares[i]);
    const double scale = size > 0 ? std::max(std::abs(g.get()[i]) / size, gap) : 0;
    const bool touches =
        size > 0 && std::abs(constraint.get()[i] - g.get()[i]) <= 1e-12 * scale * size;
    value.get()[i] = touches ? std::max(0.0, value.get()[i] / squares[i]) : 0.0;
  }
  return lambda;
}

/// In local frames, the bounds those of the normal components at the vertices.
PrimalProblem problem_in_frames(const Operators &op, const LocalFrames &frames) {
  PrimalProblem primal{
      op.a, op.f, like(op.f), frames.upper(), frames.turned(op.a), frames.turned(op.f)};
  primal.a = primal.turned_a.get();
  primal.f = primal.turned_f.get();
  RBVI_CALL(VecSet(primal.lower.get(), PETSC_NINFINITY));
  return primal;
}

PrimalProblem scalar_problem(const DistributedContact &contact, const Operators &op) {
  PrimalProblem primal{op.a, op.f, like(op.f), like(op.f)};
  RBVI_CALL(VecSet(primal.lower.get(), PETSC_NINFINITY));
  RBVI_CALL(VecSet(primal.upper.get(), PETSC_INFINITY));
  set_bounds(contact, primal);
  return primal;
}

/// Size of the terms of the residual where SNES starts, at zero moved into the bounds.
double residual_scale(const PrimalProblem &primal) {
  const Handle<Vec> start = like(primal.f), force = like(primal.f), zero = like(primal.f);
  RBVI_CALL(VecZeroEntries(zero.get()));
  RBVI_CALL(VecMedian(primal.lower.get(), zero.get(), primal.upper.get(), start.get()));
  RBVI_CALL(MatMult(primal.a, start.get(), force.get()));
  const double scale = norm(primal.f) + norm(force.get());
  return scale > 0 ? scale : 1;
}

Handle<SNES> make_snes(MPI_Comm comm, double scale) {
  Handle<SNES> snes;
  RBVI_CALL(SNESCreate(comm, snes.put()));
  RBVI_CALL(SNESSetOptionsPrefix(snes.get(), "vi_"));
  RBVI_CALL(SNESSetType(snes.get(), SNESVINEWTONRSLS));
  RBVI_CALL(SNESSetTolerances(snes.get(), 1e-14 * scale, 1e-12, 0, 200, PETSC_DEFAULT));
  KSP ksp = nullptr;
  PC pc = nullptr;
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(KSPSetType(ksp, KSPPREONLY));
  // An iterative method that an option asks for is to be as good as the direct one.
  RBVI_CALL(KSPSetTolerances(ksp, 1e-12, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(KSPGetPC(ksp, &pc));
  RBVI_CALL(PCSetType(pc, PCLU));
  RBVI_CALL(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  RBVI_CALL(SNESSetFromOptions(snes.get()));
  return snes;
}

/// The unknowns of `primal`, and how SNES ended.
MethodResult minimise(MPI_Comm comm, PrimalProblem &primal) {
  MethodResult result;
  result.free_u = like(primal.f);
  RBVI_CALL(VecZeroEntries(result.free_u.get()));
  const Handle<Vec> r = like(primal.f);
  Handle<Mat> tangent;
  RBVI_CALL(MatDuplicate(primal.a, MAT_COPY_VALUES, tangent.put()));
  const Handle<SNES> snes = make_snes(comm, residual_scale(primal));
  RBVI_CALL(SNESSetFunction(snes.get(), r.get(), residual, &primal));
  RBVI_CALL(SNESSetJacobian(snes.get(), tangent.get(), tangent.get(), jacobian, &primal));
  // The energy measures progress where iterates are feasible; the semismooth method leaves the
  // bounds on its way and has a merit function of its own.
  PetscBool semismooth = PETSC_FALSE;
  RBVI_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(snes.get()), SNESVINEWTONSSLS,
                                   &semismooth));
  if (semismooth == PETSC_FALSE) RBVI_CALL(SNESSetObjective(snes.get(), energy, &primal));
  RBVI_CALL(SNESVISetVariableBounds(snes.get(), primal.lower.get(), primal.upper.get()));
  RBVI_CALL(SNESSolve(snes.get(), nullptr, result.free_u.get()));

  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  RBVI_CALL(SNESGetConvergedReason(snes.get(), &reason));
  RBVI_CALL(SNESGetIterationNumber(snes.get(), &iterations));
  result.iterations = static_cast<int>(iterations);
  result.converged = reason > 0;
  result.reason = std::string("SNES: ") + SNESConvergedReasons[reason] +
                  (reason > 0 ? ""
                   : reason == SNES_DIVERGED_LINEAR_SOLVE
                       ? ": try another -vi_pc_type, a larger -vi_ksp_max_it, or no -vi_ksp_type"
                       : ": try -vi_snes_max_it, another -vi_snes_type, or -hf_method active_set");
  return result;
}

} // namespace

void require_bounds_at_nodes(const Scene &scene) {
  if (!bounds_nodes(scene))
    throw bad_input("vi needs a bound at each node and no friction: set -lumped yes and -friction "
                    "none where the scene has these options, or use -hf_method active_set");
}

MethodResult solve_vi(Problem &problem, const DistributedContact &contact, const Operators &op) {
  require_bounds_at_nodes(problem.scene());
  const DualLayout &layout = problem.dual_layout();
  std::optional<LocalFrames> frames;
  if (problem.scene().components > 1) {
    frames.emplace(problem);
    frames->set(nodal_bounds(problem.contact(), layout, op));
  }
  PrimalProblem primal = frames ? problem_in_frames(op, *frames) : scalar_problem(contact, op);
  MethodResult result = minimise(problem.comm(), primal);
  if (frames) result.free_u = frames->turned_back(result.free_u.get());
  std::array<double, 1> gap{op.nodal_gap.size() > 0 ? op.nodal_gap.cwiseAbs().maxCoeff() : 0};
  over_ranks(problem.comm(), MPI_MAX, gap);
  const Handle<Vec> lambda = recover_multiplier(contact, op, gap.front(), result.free_u.get());
  result.lambda = on_every_rank(layout, lambda.get());
  return result;
}

} // namespace rbvi
