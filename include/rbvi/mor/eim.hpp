// Empirical interpolation of parameter-dependent matrices and vectors (B.3).
//
// The snapshots stay where they were assembled: each rank holds some of the entries, for all mu.
// A step finds the largest residual over all ranks (a reduction of P numbers, a gather of the
// lowest keys) and shares the residual row of that entry (P numbers); residuals are updated in
// place, never recomputed. Niakh (2022): (B.27)-(B.29).
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/par/petsc.hpp"

#include <compare>
#include <string>
#include <vector>

namespace rbvi {

/// An entry by the numbers of the undistributed mesh; a vector has column 0.
struct EntryKey {
  PetscInt row, column;
  friend auto operator<=>(const EntryKey &, const EntryKey &) = default;
};

struct EimOptions {
  double tolerance = 1e-4; ///< on (B.32)
  int max_size = 0;        ///< 0: no bound
};

struct Eim {
  std::vector<int> snapshots;    ///< training index of each term, J of them
  std::vector<EntryKey> entries; ///< sampled entry of each term
  Matrix interpolation;          ///< Q: J x J, lower triangular, unit diagonal (B.34)
  Matrix combination; ///< J x J upper triangular: term j = sum_{i <= j} A(mu_i) combination(i, j)
  std::vector<double> error; ///< e_EIM(j), j = 0, 1, ..., J (B.32): error[0] = 1
  std::string reason;        ///< "separable: rank 1, error at round-off", "tolerance reached", ...
  int size() const { return static_cast<int>(snapshots.size()); }
  /// The sum of these terms is the operator at every training mu, to round-off, and there are more
  /// that differ than terms.
  bool exact() const { return reason.starts_with("separable"); }
  /// There are no more that differ: what the sum misses at other mu is not known.
  bool unproved() const { return reason.starts_with("a term for each"); }
};

/// Collective. `values`: local entries x P; `keys`: one per local entry, each owned by one rank.
/// Ties within 1e-10 relative go to the lowest training index, then the lowest key, so that the
/// outcome does not depend on the number of ranks. All zero: J = 0. Throws failure on every rank if
/// an entry is not finite, bad_input for an option out of its range.
Eim eim(MPI_Comm comm, const Matrix &values, const std::vector<EntryKey> &keys,
        const EimOptions &options);

} // namespace rbvi
