// Bodies that contact alone holds. Springs that are relaxed at beta hold them in addition
// (fem/free_motions.hpp), so that each contact problem has an answer; of beta, one number for each
// free motion, forces balance where the springs are relaxed at the answer,
//
//   lengths(beta) = beta.
//
// Without friction lengths is a contraction, piecewise affine: a proximal step of the energy over
// the free motions. Newton's method where the slope of the piece is known, else Anderson's
// acceleration with as many images as motions, which is the same after as many steps. With friction
// neither need come to an end: where all nodes slip, forces along the foot do not change with beta
// at all. Then the path is followed along which what the springs bear at the first beta is let go.
#pragma once

#include "rbvi/method/node_laws.hpp"

#include <functional>

namespace rbvi {

/// Of springs at an answer: their lengths, and how long all forces on the bodies would make them.
struct SpringState {
  Vector lengths;
  double scale = 0;
  Matrix slope{}; ///< of lengths - beta by beta, while active sets stay; empty: not known
};

struct Balance {
  Vector beta, excess; ///< excess: lengths - beta
  int solves = 0;
  bool converged = false;
  bool flies = false; ///< ever further, under a load that nothing takes up
};

/// `lengths`: solves the contact problem with springs relaxed at beta; called with the last beta
/// last where it converges. What it throws at the first one passes; elsewhere the step is
/// shortened. Converged to 1e-12 of the scale, or to what round-off leaves below 1e-10.
Balance find_balance(Vector beta, const std::function<SpringState(const Vector &beta)> &lengths);

/// Orthonormal combinations of the free motions that no multiplier resists, whatever it is:
/// motions x any number. `held`: B Z, rows of multipliers x motions.
Matrix unresisted_motions(const NodeLaws &laws, const Matrix &held);
/// The same of multipliers x: pressures that carry, and traction where it sticks. There the answer
/// is one of many.
Matrix loose_motions(const NodeLaws &laws, const Matrix &held, const Vector &x);
/// The part of a load on the free motions that no pressure and no friction balance; zero where they
/// can, thresholds not looked at. `terms`: the sums of the sizes of what the load is made of.
Vector unbalanced_load(const NodeLaws &laws, const Matrix &held, const Vector &load,
                       const Vector &terms);
/// The sizes of all forces on the free motions, friction as large as pressures allow: what their
/// sum has round-off of.
Vector forces_on_motions(const NodeLaws &laws, const Matrix &held, const Vector &terms,
                         const Vector &x);

} // namespace rbvi
