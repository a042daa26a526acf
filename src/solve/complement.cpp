#include "rbvi/solve/complement.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/linear.hpp"

#include <algorithm>
#include <numeric>

namespace rbvi {

namespace {

[[noreturn]] void not_positive_definite() {
  throw failure("the matrix is not positive definite: is the stiffness matrix singular, or its "
                "body held nowhere?");
}

/// All of A on the first rank, nothing on the others. Collective.
Handle<Mat> on_first_rank(Mat a) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(a));
  if (ranks_of(comm) == 1) {
    RBVI_CALL(PetscObjectReference(reinterpret_cast<PetscObject>(a)));
    return Handle<Mat>(a);
  }
  PetscInt size = 0;
  RBVI_CALL(MatGetSize(a, &size, nullptr));
  const PetscInt wanted = rank_of(comm) == 0 ? 1 : 0;
  Handle<IS> all;
  Mat *parts = nullptr;
  RBVI_CALL(ISCreateStride(PETSC_COMM_SELF, wanted * size, 0, 1, all.put()));
  const IS rows = all.get();
  RBVI_CALL(MatCreateSubMatrices(a, wanted, &rows, &rows, MAT_INITIAL_MATRIX, &parts));
  Handle<Mat> whole;
  if (wanted == 1) {
    RBVI_CALL(PetscObjectReference(reinterpret_cast<PetscObject>(parts[0])));
    whole = Handle<Mat>(parts[0]);
  }
  RBVI_CALL(MatDestroySubMatrices(wanted, &parts));
  return whole;
}

/// The inverse of the Schur complement of a sequential matrix on these rows.
Matrix inverse_complement(Mat whole, const std::vector<PetscInt> &rows) {
  constexpr int extra_room = 80; // as set_operator
  const auto size = static_cast<PetscInt>(rows.size());
  Handle<Mat> factor;
  Handle<IS> last;
  MatFactorInfo info;
  MatFactorError error = MAT_FACTOR_NOERROR;
  RBVI_CALL(MatSetOption(whole, MAT_SPD, PETSC_TRUE));
  RBVI_CALL(MatGetFactor(whole, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, factor.put()));
  RBVI_CALL(ISCreateGeneral(PETSC_COMM_SELF, size, rows.data(), PETSC_USE_POINTER, last.put()));
  RBVI_CALL(MatFactorSetSchurIS(factor.get(), last.get()));
  RBVI_CALL(MatMumpsSetIcntl(factor.get(), 14, extra_room));
  RBVI_CALL(MatFactorInfoInitialize(&info));
  RBVI_CALL(MatCholeskyFactorSymbolic(factor.get(), whole, nullptr, &info));
  RBVI_CALL(MatCholeskyFactorNumeric(factor.get(), whole, &info));
  RBVI_CALL(MatFactorGetError(factor.get(), &error));
  if (error != MAT_FACTOR_NOERROR) not_positive_definite();
  RBVI_CALL(MatFactorInvertSchurComplement(factor.get()));
  Mat inverse = nullptr;
  const PetscScalar *values = nullptr;
  RBVI_CALL(MatFactorGetSchurComplement(factor.get(), &inverse, nullptr));
  RBVI_CALL(MatDenseGetArrayRead(inverse, &values));
  Matrix result = Eigen::Map<const Matrix>(values, size, size);
  RBVI_CALL(MatDenseRestoreArrayRead(inverse, &values));
  RBVI_CALL(MatFactorRestoreSchurComplement(factor.get(), &inverse, MAT_FACTOR_SCHUR_INVERTED));
  if (!(result.diagonal().minCoeff() > 0)) not_positive_definite();
  return (result + result.transpose()) / 2;
}

/// Each row of the trace among the different ones, whose contact dofs come in `first`.
std::vector<Index> places_of(const std::vector<PetscInt> &rows, std::vector<Index> &first) {
  std::vector<Index> order(rows.size()), place(rows.size());
  const auto row = [&](Index i) { return rows[i]; };
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index i, Index k) { return row(i) < row(k); });
  for (const Index i : order) {
    if (first.empty() || row(first.back()) != row(i)) first.push_back(i);
    place[i] = std::ssize(first) - 1;
  }
  return place;
}

} // namespace

double complement_cost(PetscInt dofs, PetscInt size) {
  // Measured on disks from 6 000 to 190 000 dofs.
  constexpr double factorisation = 35, dense = 1600;
  const double n = size;
  return factorisation + n * n * n / (dense * dofs);
}

bool complement_pays(PetscInt dofs, PetscInt size, double solves, bool factored) {
  constexpr double of_many = 0.4, factorisation = 75; // likewise
  return 2 * size <= dofs &&
         of_many * solves + (factored ? 0 : factorisation) > complement_cost(dofs, size);
}

bool solves_directly(const char *prefix) {
  const Handle<KSP> ksp = make_direct_solver(PETSC_COMM_SELF, prefix);
  PC pc = nullptr;
  PetscBool once = PETSC_FALSE, factorises = PETSC_FALSE;
  RBVI_CALL(KSPGetPC(ksp.get(), &pc));
  RBVI_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(ksp.get()), KSPPREONLY, &once));
  RBVI_CALL(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &factorises, PCCHOLESKY,
                                      PCLU, nullptr));
  return once == PETSC_TRUE && factorises == PETSC_TRUE;
}

namespace {

/// Loads on the dofs that they touch, each once.
struct TouchedLoads {
  std::vector<Index> dofs; ///< of the trace
  Matrix loads;            ///< dofs x columns
};

TouchedLoads touched_by(const Matrix &loads, const std::vector<PetscInt> &rows) {
  std::vector<Index> first;
  const std::vector<Index> place = places_of(rows, first);
  Matrix sums = Matrix::Zero(std::ssize(first), loads.cols());
  for (std::size_t i = 0; i < place.size(); ++i)
    sums.row(place[i]) += loads.row(i);
  std::vector<Index> touched;
  TouchedLoads result;
  for (std::size_t k = 0; k < first.size(); ++k)
    if ((sums.row(k).array() != 0).any()) {
      touched.push_back(static_cast<Index>(k));
      result.dofs.push_back(first[k]);
    }
  result.loads = sums(touched, Eigen::all);
  return result;
}

} // namespace

Matrix compliance_by_complement(Mat a, const Trace &trace) {
  const Handle<Mat> whole = on_first_rank(a);
  PetscInt first = 0;
  RBVI_CALL(MatGetOwnershipRange(a, &first, nullptr));
  const std::vector<PetscInt> rows = global_rows(trace, first);
  Matrix compliance(trace.size, trace.size);
  collectively(trace.comm, [&] {
    if (rank_of(trace.comm) == 0) compliance = inverse_complement(whole.get(), rows);
  });
  MPI_Bcast(compliance.data(), static_cast<int>(compliance.size()), MPI_DOUBLE, 0, trace.comm);
  return compliance;
}

Matrix condensed_by_loads(Mat a, const Trace &trace, const char *prefix, const Matrix &loads,
                          ResponseSolver *solver) {
  if (loads.cols() == 0) return {};
  PetscInt size = 0, begin = 0;
  RBVI_CALL(MatGetSize(a, &size, nullptr));
  RBVI_CALL(MatGetOwnershipRange(a, &begin, nullptr));
  const TouchedLoads touched = touched_by(loads, global_rows(trace, begin));
  const double solves = static_cast<double>(loads.cols()) / ranks_of(trace.comm);
  const auto count = static_cast<PetscInt>(touched.dofs.size());
  Matrix made;
  if (solves_directly(prefix) && complement_pays(size, count, solves, solver != nullptr) &&
      factors_fit(trace.comm, size)) {
    const Eigen::SparseMatrix<double> sparse = touched.loads.sparseView();
    made = sparse.transpose() *
           Matrix(compliance_by_complement(a, part_of(trace, touched.dofs)) * sparse);
  } else if (solver != nullptr) {
    made = loads.transpose() * solver->responses(loads);
  } else {
    made = loads.transpose() * ResponseSolver(a, trace, prefix).responses(loads);
  }
  return (made + made.transpose()) / 2;
}

} // namespace rbvi
