// Means of the displacement over boundaries (Form::means), as functionals of its dofs.
#pragma once

#include "rbvi/fem/dofs.hpp"

#include <algorithm>

namespace rbvi {

/// Whether both are the same spring, or a spring and its pretension.
inline bool are_same(const std::vector<Mean> &some, const std::vector<Mean> &others) {
  return std::ranges::equal(some, others, [](const Mean &one, const Mean &other) {
    return one.boundary == other.boundary && one.direction == other.direction;
  });
}

/// "'one' and 'other'".
std::string boundaries_of(const std::vector<Mean> &means);

/// The sum of some means by local node * components + component, fixed dofs included: what the
/// facets of this rank give of it. Collective.
Vector mean_functional(const std::vector<Mean> &means, const Mesh &mesh, const Dofs &dofs);

/// Fills in Dofs::couplings for the terms of a that have means. Throws bad_input for boundaries of
/// more dofs than a dense block should have, for one on which displacements are imposed that are
/// not zero, and for a mean that the motion of the scene changes. Collective.
void add_couplings(const Scene &scene, const Mesh &mesh, Dofs &dofs);

} // namespace rbvi
