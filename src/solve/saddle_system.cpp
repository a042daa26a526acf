#include "saddle_system.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/solve/linear.hpp"
#include "rbvi/solve/vectors.hpp"

#include <array>

namespace rbvi {

namespace {

/// The whole matrix, and where its two parts are in vectors.
struct Saddle {
  Handle<Mat> matrix;
  Handle<Mat> blocks; ///< owns the two index sets
  std::array<IS, 2> parts{};
};

Saddle assembled(MPI_Comm comm, Mat a, Mat w, Mat c) {
  Handle<Mat> reactions;
  RBVI_CALL(MatTranspose(w, MAT_INITIAL_MATRIX, reactions.put()));
  const std::array<Mat, 4> blocks{a, reactions.get(), c, nullptr};
  Saddle saddle;
  RBVI_CALL(MatCreateNest(comm, 2, nullptr, 2, nullptr, blocks.data(), saddle.blocks.put()));
  RBVI_CALL(MatNestGetISs(saddle.blocks.get(), saddle.parts.data(), nullptr));
  RBVI_CALL(MatConvert(saddle.blocks.get(), MATAIJ, MAT_INITIAL_MATRIX, saddle.matrix.put()));
  return saddle;
}

/// visit(part of the vector).
template <class Visit> void with_part(Vec whole, IS part, Visit &&visit) {
  Vec values = nullptr;
  RBVI_CALL(VecGetSubVector(whole, part, &values));
  visit(values);
  RBVI_CALL(VecRestoreSubVector(whole, part, &values));
}

} // namespace

Vector solve_saddle(Mat a, Mat w, Mat c, Vec f, const Vector &right, Vec u) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(a));
  const Saddle saddle = assembled(comm, a, w, c);
  Handle<Vec> x, b;
  RBVI_CALL(MatCreateVecs(saddle.matrix.get(), x.put(), b.put()));
  with_part(b.get(), saddle.parts[0], [&](Vec part) { RBVI_CALL(VecCopy(f, part)); });
  with_part(b.get(), saddle.parts[1], [&](Vec part) { LocalValues(part).get() = right; });
  Handle<KSP> ksp;
  PC pc = nullptr;
  RBVI_CALL(KSPCreate(comm, ksp.put()));
  RBVI_CALL(KSPSetOptionsPrefix(ksp.get(), "hf_saddle_"));
  RBVI_CALL(KSPSetType(ksp.get(), KSPPREONLY));
  RBVI_CALL(KSPGetPC(ksp.get(), &pc));
  RBVI_CALL(PCSetType(pc, PCLU));
  RBVI_CALL(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  RBVI_CALL(KSPSetFromOptions(ksp.get()));
  set_operator(ksp.get(), saddle.matrix.get(), Ordering::automatic);
  solve_linear(ksp.get(), b.get(), x.get());
  // One step of refinement; what MUMPS leaves where it fails is zero or not finite.
  constexpr double enough = 1e-9;
  const Handle<Vec> residual = like(b.get()), change = like(x.get());
  const auto set_residual = [&] {
    RBVI_CALL(MatMult(saddle.matrix.get(), x.get(), residual.get()));
    RBVI_CALL(VecAYPX(residual.get(), -1, b.get()));
  };
  set_residual();
  solve_linear(ksp.get(), residual.get(), change.get());
  RBVI_CALL(VecAXPY(x.get(), 1, change.get()));
  set_residual();
  if (!(norm(residual.get()) <= enough * norm(b.get())))
    throw failure("the system of the active set with its multipliers was solved to " +
                  short_number(norm(residual.get()) / norm(b.get())) +
                  " only: try -hf_contact condensed");
  with_part(x.get(), saddle.parts[0], [&](Vec part) { RBVI_CALL(VecCopy(part, u)); });
  Vector y;
  with_part(x.get(), saddle.parts[1], [&](Vec part) { y = LocalValues(part).get(); });
  return y;
}

} // namespace rbvi
