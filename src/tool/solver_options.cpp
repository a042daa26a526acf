#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/replicated.hpp"
#include "rbvi/tool/options.hpp"

namespace rbvi {

namespace {

/// Options under our prefixes that no PETSc object has asked for, as " -a -b".
std::string unused_options() {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  RBVI_CALL(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::string unused;
  for (PetscInt i = 0; i < count; ++i)
    for (const std::string &prefix : solver_prefixes())
      if (std::string(names[i]).starts_with(prefix)) unused += " -" + std::string(names[i]);
  RBVI_CALL(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  return unused;
}

/// The solvers of a run as they are made, for their questions to the options alone.
void make_solvers(MPI_Comm comm) {
  (void)make_direct_solver(comm, "hf_");
  (void)make_direct_solver(PETSC_COMM_SELF, "v_");
  Handle<SNES> snes;
  KSP ksp = nullptr;
  PC pc = nullptr;
  RBVI_CALL(SNESCreate(comm, snes.put()));
  RBVI_CALL(SNESSetOptionsPrefix(snes.get(), "vi_"));
  RBVI_CALL(SNESSetType(snes.get(), SNESVINEWTONRSLS));
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(KSPGetPC(ksp, &pc));
  RBVI_CALL(PCSetType(pc, PCLU));
  RBVI_CALL(SNESSetFromOptions(snes.get()));
}

/// What the solvers ask for only when they work (options of factorisations, of inner solvers).
void try_solvers(Problem &problem, const HfOptions &options) {
  Mu mu;
  const ParameterSpace &space = problem.scene().parameters;
  for (int i = 0; i < space.size(); ++i)
    mu.push_back(space.at(i).value);
  (void)HighFidelity(problem, options).solve(mu);
  (void)ReplicatedSolver(problem.v_product(), problem.trace(), "v_")
      .responses(Matrix::Identity(problem.trace().size, 1));
}

} // namespace

const std::vector<std::string> &solver_prefixes() {
  static const std::vector<std::string> prefixes{
      "hf_", "vi_", "v_", "nitsche_snes_", "nitsche_ksp_", "nitsche_pc_", "nitsche_mat_"};
  return prefixes;
}

void check_solver_options(Problem &problem, const HfOptions &options) {
  if (unused_options().empty()) return;
  std::string reason;
  try {
    make_solvers(problem.comm());
    if (!unused_options().empty()) try_solvers(problem, options);
  } catch (const Error &error) {
    reason = std::string(" (") + error.what() + ")";
  }
  const std::string unused = unused_options();
  if (!unused.empty())
    throw bad_input("no solver of this run asks for the option" + unused + reason);
  if (!reason.empty()) throw bad_input("the options of the solvers do not work" + reason);
}

} // namespace rbvi
