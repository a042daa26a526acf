#include "database.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/response_solver.hpp"
#include "rbvi/tool/options.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// An option of PETSc's that one of our solvers would read and not follow.
struct Ineffective {
  const char *name;
  const char *instead;
};
constexpr const char *by_iterations =
    "a factorisation is kept while conjugate gradients need few iterations: use -nitsche_ksp_rtol "
    "or -nitsche_ksp_max_it";
constexpr Ineffective ineffective[] = {{"nitsche_snes_lag_preconditioner", by_iterations},
                                       {"nitsche_ksp_reuse_preconditioner", by_iterations}};

const std::vector<std::string> &of_solvers() {
  static const std::vector<std::string> prefixes = [] {
    std::vector<std::string> all = prefixes_of({"ksp_", "pc_", "mat_", "snes_"});
    all.emplace_back("vi_"); // and what a preconditioner of it is made of
    return all;
  }();
  return prefixes;
}

/// Throws bad_input for options of a solver that this run does not have, or that have no effect.
void check_solver_of(const std::string &name, const Scene &scene, const HfOptions &options) {
  for (const Ineffective &option : ineffective)
    if (name.starts_with(option.name))
      throw bad_input("-" + name + " has no effect: " + option.instead);
  const bool mixed = has_multipliers(scene);
  if (name.starts_with("nitsche_") && mixed)
    throw bad_input("-" + name + " is for Nitsche's method: set -formulation nitsche");
  if (name.starts_with("hf_") && !mixed)
    throw bad_input("-" + name + " is for the mixed formulation: Nitsche's method has -nitsche_" +
                    name.substr(3));
  if (name.starts_with("vi_") && (!mixed || options.method != HfMethod::vi))
    throw bad_input("-" + name + " is for -hf_method vi");
}

/// Whether one application of a preconditioner solves the system.
bool solves(const std::string &pc_type) {
  static const std::vector<std::string> types{PCLU,        PCCHOLESKY, PCSVD,      PCQR,
                                              PCREDUNDANT, PCKSP,      PCTELESCOPE};
  return std::find(types.begin(), types.end(), pc_type) != types.end();
}

/// Throws bad_input where a solver without iterations has tolerances, or is none.
void check_direct(KSP ksp, const std::string &prefix, const std::vector<std::string> &names) {
  PetscBool direct = PETSC_FALSE;
  RBVI_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(ksp), KSPPREONLY, &direct));
  if (direct == PETSC_FALSE) return;
  for (const char *of_iterations : {"rtol", "atol", "divtol", "max_it"})
    for (const std::string &name : names)
      if (name == prefix + "ksp_" + of_iterations)
        throw bad_input("-" + name + " has no effect on a direct solver: add -" + prefix +
                        "ksp_type cg, or leave it out");
  PC pc = nullptr;
  PCType type = nullptr;
  RBVI_CALL(KSPGetPC(ksp, &pc));
  RBVI_CALL(PCGetType(pc, &type));
  if (type != nullptr && !solves(type))
    throw bad_input("-" + prefix + "pc_type " + type + " is no solver by itself: add -" + prefix +
                    "ksp_type cg");
}

/// The solvers of a run as they are made, for their questions to the options alone.
void make_solvers(MPI_Comm comm, const std::vector<std::string> &names, const HfOptions &options) {
  const Handle<KSP> stiffness = make_direct_solver(comm, "hf_");
  check_direct(stiffness.get(), "hf_", names);
  const Handle<KSP> product = make_direct_solver(PETSC_COMM_SELF, "v_");
  check_direct(product.get(), "v_", names);
  if (options.method != HfMethod::vi) return;
  Handle<SNES> snes;
  KSP ksp = nullptr;
  PC pc = nullptr;
  RBVI_CALL(SNESCreate(comm, snes.put()));
  RBVI_CALL(SNESSetOptionsPrefix(snes.get(), "vi_"));
  RBVI_CALL(SNESSetType(snes.get(), SNESVINEWTONRSLS));
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(KSPSetType(ksp, KSPPREONLY));
  RBVI_CALL(KSPGetPC(ksp, &pc));
  RBVI_CALL(PCSetType(pc, PCLU));
  RBVI_CALL(SNESSetFromOptions(snes.get()));
  PetscBool levels = PETSC_FALSE;
  RBVI_CALL(
      PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &levels, PCGAMG, PCMG, nullptr));
  if (levels == PETSC_TRUE)
    throw bad_input("multigrid does not follow the systems of vi, which differ in size from step "
                    "to step: use -vi_pc_type icc, or no -vi_pc_type");
  check_direct(ksp, "vi_", names);
}

/// What the solvers ask for only when they work (options of factorisations, of inner solvers).
void try_solvers(Problem &problem, const HfOptions &options) {
  Mu mu;
  const ParameterSpace &space = problem.scene().parameters;
  for (int i = 0; i < space.size(); ++i)
    mu.push_back(space.at(i).value);
  (void)HighFidelity(problem, options).solve(mu);
  (void)ResponseSolver(problem.v_product(), problem.trace(), "v_")
      .responses(Matrix::Identity(problem.trace().size, 1));
}

} // namespace

const std::vector<std::string> &solver_prefixes() {
  static const std::vector<std::string> prefixes = [] {
    std::vector<std::string> all = of_solvers();
    all.insert(all.end(), eigen_prefixes().begin(), eigen_prefixes().end());
    return all;
  }();
  return prefixes;
}

void check_solver_options(Problem &problem, const HfOptions &options) {
  const std::vector<std::string> names = unread_names(of_solvers());
  if (names.empty()) return;
  for (const std::string &name : names)
    check_solver_of(name, problem.scene(), options);
  std::string reason;
  try {
    make_solvers(problem.comm(), names, options);
    if (!unread_names(of_solvers()).empty()) try_solvers(problem, options);
  } catch (const Error &error) {
    if (error.status() == Status::bad_input) throw;
    reason = std::string(" (") + error.what() + ")";
  }
  std::string unused;
  for (const std::string &name : unread_names(of_solvers()))
    unused += " -" + name;
  if (!unused.empty())
    throw bad_input("no solver of this run asks for the option" + unused + reason);
  if (!reason.empty()) throw bad_input("the options of the solvers do not work" + reason);
}

} // namespace rbvi
