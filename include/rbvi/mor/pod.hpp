// Proper orthogonal decomposition in the V product: QR of the snapshots, then SVD of the small
// factor (B.1), never the eigenvalues of a squared Gram matrix alone.
// Niakh (2022): (2.10), (A.11)-(A.15), (B.2)-(B.8).
#pragma once

#include "rbvi/solve/response_solver.hpp"

#include <string>
#include <vector>

namespace rbvi {

/// V-orthonormal columns, distributed like the snapshots.
struct LinearBasis {
  Handle<BV> columns; ///< its matrix (BVSetMatrix) is the V product
  PetscInt size() const;
};

struct PodOptions {
  double tolerance = 1e-6; ///< on e_POD (2.11), in [0, 1)
  PetscInt max_size = 0;   ///< 0: no bound
};

struct Pod {
  LinearBasis basis;
  std::vector<double> singular_values; ///< all (rank many), decreasing
  std::vector<double> error;           ///< e_POD(n), n = 0, 1, ..., rank (2.11)
};

/// Root of the sum of squares of the singular values (decreasing) behind the first n, relative to
/// that of all: n = 0, 1, ...
std::vector<double> projection_errors(const Vector &values);

/// Collective. `snapshots`: free dofs, all of one layout; `product`: Gram matrix of V. Columns
/// whose remainder is below 1e-13 of their norm are dropped; singular values equal to 1e-8 relative
/// are kept or cut together. The sign of each mode is fixed (largest projection coefficient
/// positive). Throws failure if there is no snapshot, if all are zero or one is not finite;
/// bad_input for an option out of its range or a size bound below the multiplicity of the first
/// singular value.
Pod pod(const std::vector<Vec> &snapshots, Mat product, const PodOptions &options);

/// Collective. The basis times orthonormal columns, as many rows as it has functions.
void rotate(LinearBasis &basis, const Matrix &rotation);

/// Collective. Appends `columns` (dense, distributed like the basis) after V-orthonormalisation
/// against it; a column with a remainder below `tolerance` of its norm is left out. Returns
/// the positions of the columns taken.
std::vector<int> append_orthonormalised(LinearBasis &basis, Mat columns, double tolerance);

/// Collective. The same of A^-1 E loads, some columns at a time: at most those are held beside the
/// basis. `traces`, where given: E^T A^-1 E loads.
std::vector<int> append_fields(ResponseSolver &solver, const Matrix &loads, LinearBasis &basis,
                               double tolerance, Matrix *traces = nullptr);

} // namespace rbvi
