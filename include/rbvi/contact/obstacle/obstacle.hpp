// Contact with an obstacle in a region of the body (Niakh 2022, 2.4): u >= psi, held by a pressure
// lambda >= 0 whose functions are the hats of the region's vertices,
//
//   b(mu; v, eta) = -int v eta,   g(mu; eta) = -int psi eta   over the mapped region (2.40).
#pragma once

#include "rbvi/contact/entity_sum.hpp"

namespace rbvi {

struct Obstacle {
  std::string region;
  /// psi(mu) at a point of the mapped domain.
  Named<PointValue> height;
  /// b and g by vertex quadrature: the constraint is a bound at each node. Else exact, g by a rule
  /// of degree 5.
  bool lumped = false;
};

/// For scalar displacements of degree 1.
ContactRecipe obstacle(Obstacle obstacle);

/// "obstacle" in files.
ContactKind obstacle_kind();

} // namespace rbvi
