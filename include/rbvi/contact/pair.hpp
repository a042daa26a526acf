// Two bodies that meet along two curves: the operators of contact_pair.hpp, with the motion of the
// scene and the values that boundaries impose taken into gaps and slips. At rest the partners are
// those of the curves mapped by h(mu), found once at each mu.
//
// Where they now are (large deformations: Niakh 2022, appendix A) a point x of the slave curve is
// at y = x + motion + w, and its partner is found on the current master curve along the field nu of
// normals. With nu and the partner xi frozen at a state,
//
//   nu . (y(x) - y(xi)) >= 0,    y = x + motion + u on both sides,
//
// weighted with the functions of the multipliers over the undeformed slave curve, which is cut
// where vertices of the master project onto it. The second derivative of nu . (y(x) - y(xi)) is
//
//   -(s(v) nu . d_xi w_2 + s(w) nu . d_xi v_2 + k s(v) s(w)),    s(v) = tau . (v(x) - v(xi)),
//
// with tau' = k nu along the current master curve: the curvature of this interface.
#pragma once

#include "rbvi/contact/contact_pair.hpp"
#include "rbvi/contact/friction.hpp"
#include "rbvi/contact/interface.hpp"

namespace rbvi {

/// Of degree 2 the middles of edges are on Scene::curves, undeformed.
struct Pair {
  std::string slave, master; ///< boundaries
  PairDiscretisation discretisation{};
  bool large = false;  ///< where the bodies now are
  Friction friction{}; ///< Tresca's threshold holds where there is contact
};

/// Throws bad_input for large deformations with friction, along e_y or without intersection.
ContactRecipe two_bodies(Pair pair);

} // namespace rbvi
