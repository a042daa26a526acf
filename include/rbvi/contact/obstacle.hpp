// Contact with an obstacle in a region of the body (Niakh 2022, 2.4): u >= psi, held by a pressure
// lambda >= 0 whose functions are the hats of the region's vertices, whatever the degree of u,
//
//   b(mu; v, eta) = -int v eta,   g(mu; eta) = -int psi eta   over the mapped region (2.40);
//
// or u <= psi, where b and g have the other sign.
// Niakh (2022): (2.39).
#pragma once

#include "rbvi/contact/entity_sum.hpp"
#include "rbvi/contact/friction.hpp"

namespace rbvi {

struct Obstacle {
  std::string region; ///< beside it the body goes on, which outputs count contact at its rim for
  /// psi(mu) at a point of the mapped domain.
  std::function<PointValue> height;
  /// b and g by vertex quadrature: the constraint is a bound at each vertex. Else exact, g by a
  /// rule of degree 5. Of degree 2 the pressure of vertex quadrature pushes at the vertices alone:
  /// what lies between them is in equilibrium with the load, and u is of order 1 as with degree 1.
  bool lumped = false;
  std::function<Coefficient> adhesion{}; ///< Friction::adhesion
  double side = 1;                       ///< where the membrane is: 1, above it, or -1
};

/// For scalar displacements of degree 1 and 2.
ContactRecipe obstacle(Obstacle obstacle);

/// The load that pulls the membrane onto it, -side int a v, as that of contact/facing.hpp.
Term adhesive_load(const Obstacle &obstacle, const Scene &scene);

} // namespace rbvi
