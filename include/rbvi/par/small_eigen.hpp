// Eigenpairs of small symmetric matrices by SLEPc (EPSLAPACK), with the number converged checked.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/par/petsc.hpp"

#include <string>

namespace rbvi {

/// One EPS for matrices of any size, one after the other. Serial.
class SmallEigen {
public:
  /// `prefix`: of its options ("pga_": -pga_eps_view, ...). Throws failure for a value that SLEPc
  /// refuses.
  explicit SmallEigen(const char *prefix);

  /// All n eigenvalues, decreasing; the lower triangle of `matrix` (n x n) is read. Throws failure
  /// if an entry is not finite or SLEPc does not return every pair.
  Vector values(const Matrix &matrix);

  /// Eigenvectors of the first `count` of them, n x count, orthonormal columns.
  Matrix vectors(Index count) const;

private:
  std::string prefix_;
  Handle<EPS> eps_;
  Index size_ = 0; ///< of the last matrix
};

} // namespace rbvi
