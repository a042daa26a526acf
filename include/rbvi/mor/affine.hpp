// Separation of mu and space: empirical interpolation over the training set of B, G and of what is
// not a sum of exact terms in A and F, with the small meshes on which the sampled entries are
// re-assembled online. Niakh (2022): (1.27)-(1.29), (3.47)-(3.51).
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/mor/eim.hpp"

#include <optional>

namespace rbvi {

struct AffineOperators {
  Eim a, f;         ///< of the terms that depend on the map alone; size 0: all are exact
  Eim b, g;         ///< size 0: they do not separate
  Eim b_tangential; ///< B^tau, where b is B^n alone; size 0 where b is all rows
  /// Of the domain (a, f), of each interface (b, g); sample_b: entries of b, then b_tangential.
  std::vector<SampleMesh> sample_a, sample_b, sample_f, sample_g;
  int b_size() const { return b.size() + b_tangential.size(); }
};

/// B^n and B^tau apart: the rows of the multipliers lambda_n, and those of lambda_tau (3.46).
struct RowOptions {
  EimOptions normal, tangential;
};

/// An interpolation, and the rows of B that it is of.
struct RowsOfB {
  const Eim &eim;
  Index first, count;
};

/// All rows together, or B^n and B^tau. `affine` must outlive it.
std::vector<RowsOfB> rows_of_b(const AffineOperators &affine, const Problem &problem);

/// Of the terms that are not exact: the first mu of the set with each value of the parameters that
/// the sum depends on, by number; none where all are exact.
std::vector<int> interpolated_samples(const Sum &sum, const ParameterSpace &space,
                                      const std::vector<Mu> &set);

/// Those of A and F: of an elastic body their tolerance is a millionth, as forces of bending, and
/// of stretching around an axis, are what is left of sums of much larger entries.
EimOptions eim_of_body(const Scene &scene, EimOptions options);

/// Collective. Assembles the operators at every mu of `training` (of A and F the terms that are not
/// exact, of A the lower triangle, at interpolated_samples()) and
/// interpolates each (A and F as eim_of_body says). `apart`: of B in place of `options`, where
/// there is one interface. B stays one where it is a multiple of one form at all `training`, since
/// then one term serves all rows, and without friction, where there is only B^n.
AffineOperators separate(Problem &problem, const std::vector<Mu> &training,
                         const EimOptions &options, const std::optional<RowOptions> &apart = {});

/// The energy of the imposed displacements: its exact terms, and the others as one term, which is
/// integrated online over the cells beside the boundaries. No term where nothing is imposed.
/// Collective.
AffineTerms separate_imposed_energy(const Problem &problem);

} // namespace rbvi
