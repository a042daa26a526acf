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
#include <string>

namespace rbvi {

/// What holds k free motions Z at an answer, and what pushes along them.
struct FreeMotions {
  NodeLaws laws;
  Matrix held;        ///< B Z, rows of the laws x k
  Vector load, terms; ///< Z^T F without the springs, and the sums of the sizes of its terms
  /// Of the multipliers by what springs are relaxed at, while active sets stay; empty: not known.
  Matrix slope{};
};

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
/// The same of multipliers x: pressures that carry, traction where it sticks, and in space its
/// turning where it slips. There the answer is one of many.
Matrix loose_motions(const NodeLaws &laws, const Matrix &held, const Vector &x);
/// The part of a load on the free motions that no pressure and no friction balance; zero where they
/// can, thresholds not looked at. `terms`: the sums of the sizes of what the load is made of.
Vector unbalanced_load(const NodeLaws &laws, const Matrix &held, const Vector &load,
                       const Vector &terms);
/// The sizes of all forces on the free motions, friction as large as pressures allow: what their
/// sum has round-off of.
Vector forces_on_motions(const NodeLaws &laws, const Matrix &held, const Vector &terms,
                         const Vector &x);

/// "the body can move along (1, 0)", of motions x any number; for messages.
using MotionText = std::function<std::string(const Matrix &motions)>;

/// Throws failure where loads push along motions that no pressure and no friction balance.
void check_held(const FreeMotions &motions, const MotionText &describe);

/// Of bodies with springs relaxed at some beta; what it refers to lives until the next answer.
struct HeldAnswer {
  const FreeMotions *motions;
  const Vector *x; ///< multipliers
  Vector lengths;  ///< of the springs
};

/// Bodies that contact alone holds, full or reduced.
struct HeldBodies {
  std::function<HeldAnswer(const Vector &beta)> solve;
  MotionText describe;
  Matrix lengths;     ///< of the springs by each motion, k x k
  double stiffness;   ///< forces on motions over lengths of springs
  std::string advice; ///< where forces do not balance
};

/// The beta at which forces balance, from this one; `solve` is called last with it. Throws failure
/// where they do not balance, or where nothing holds a motion at the answer.
Vector balance_bodies(Vector beta, const HeldBodies &bodies);

} // namespace rbvi
