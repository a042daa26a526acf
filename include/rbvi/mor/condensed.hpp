// The condensed operator H = B A^-1 B^T on a basis of the multipliers: what changes with mu in A is
// interpolated on a sparse grid, what changes in B is separated already.
//
// The law of contact and friction is not smooth in mu, and no linear space or cone of few functions
// follows it; H is, and converges exponentially. So the multipliers keep their nodes, and the body
// between them is reduced.
#pragma once

#include "rbvi/mor/affine.hpp"
#include "rbvi/mor/pod.hpp"

namespace rbvi {

/// The tolerance of the responses to the loads of the scene: the gap that they leave is what the
/// multipliers answer to.
inline constexpr double load_tolerance = 1e-9;

struct CondensedOptions {
  double tolerance = 1e-9; ///< of the interpolation, relative
  int max_points = 33;     ///< along one parameter
  double responses = 1e-4; ///< tolerance of responses of further A (condense); 0: none are appended
  /// Where only the responses to answers of the law join the modes: what of these displacements may
  /// be left, relative, in the energy. Multipliers do not depend on it.
  double answers = 1e-5;
  /// The ring of columns_near_contact. The training samples only have to say roughly where contact
  /// is: where a query of the self-check finds it at the edge, reduce() keeps all columns.
  double ring = 0.5;
  double large_fields = 2e7; ///< numbers of fields that are many: 160 MB
};

/// Appends to the modes the responses of the body to the terms of F, which the condensed operator
/// does not see: the gap without multipliers is that of Galerkin's method in the modes. `training`:
/// what `affine` was made at. Returns how many. Collective.
int add_load_responses(Problem &problem, const AffineOperators &affine,
                       const std::vector<Mu> &training, LinearBasis &modes);

struct Condensation {
  CondensedOperator condensed;
  int responses = 0;      ///< functions appended to the modes
  int factorisations = 0; ///< of A
};

/// The loads on the contact dofs that A^-1 is asked for.
struct CondensedLoads {
  Matrix columns; ///< contact dofs x any number
  Index size;     ///< the order of a block of H
  /// The contact dofs of unit loads, rising; empty: the loads are others.
  std::vector<int> units{};
  bool join = false; ///< the responses to all of them can join the modes
  /// The contact dofs whose unit loads have responses that can join the modes instead: those beside
  /// multipliers that are positive in some sample.
  std::vector<Index> dofs{};

  /// Responses that can join.
  Index joining() const { return join ? columns.cols() : std::ssize(dofs); }
};

/// The loads of a basis of the multipliers. Where b separates (`affine`, over the samples at
/// `training`) these are its terms on the basis, side by side; all of them join where there is one
/// term, single dofs where there are more. Where b is evaluated at each mu these are the unit
/// vectors of the contact dofs that the rows of the basis and their neighbours meet at the training
/// parameters, at random ones and in the corners of the box; of all contact dofs where contact
/// follows the displacement. `multipliers`: dual dofs x P. Not collective.
CondensedLoads condensed_loads(Problem &problem, const AffineOperators &affine,
                               const std::vector<Mu> &training, const Matrix &multipliers,
                               const Matrix &basis);

/// H = loads^T A^-1 loads in its blocks, times the common coefficient of A. One factorisation and a
/// solve for each load at each point of the grid, shared among the ranks. Collective. Where the
/// tolerance needs more points than the most, says so on standard error, and the error stands in
/// the operator.
///
/// `modes`, where given: the responses A^-1 loads are appended to them, with A at the first five
/// points along each of its free parameters, so that the displacement is as exact as the
/// multipliers (snapshots alone do not contain the responses to new active sets). All responses of
/// the first A are appended (remainders below 1e-8 of their norm left out), of every other A those
/// parts that are larger than options.responses. Where all loads join and A is a sum of more than
/// two exact terms, fewer A are factorised: responses are appended until those to multipliers like
/// `multipliers` (coefficients of the loads x samples) are in the span to 3e-7, and H is taken from
/// Galerkin's method in this span.
Condensation condense(Problem &problem, const CondensedLoads &loads, const FullMu &all_parameters,
                      const CondensedOptions &options, LinearBasis *modes = nullptr,
                      const Matrix &multipliers = {});

} // namespace rbvi
