// Contact of two deformable bodies where they now are: large deformations (Niakh 2022, appendix A).
// A point x of the slave (upper) curve is at y = x + motion + w, and is projected onto the current
// master curve along a continuous field nu of normals of that curve, towards the slave. With nu and
// the partner xi frozen at a state,
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
#include "rbvi/core/contact_recipe.hpp"

namespace rbvi {

/// Of degree 2 Scene::snap brings the middles of edges onto the undeformed curves.
struct LargePair {
  std::string slave, master; ///< boundaries
  MultiplierSpace multiplier = MultiplierSpace::macro_edges;
};

ContactRecipe deformed_bodies(LargePair pair);

/// "deformed_bodies" in files.
ContactKind deformed_bodies_kind();

} // namespace rbvi
