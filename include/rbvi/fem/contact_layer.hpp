// The cells beside the contact curve of a rigid support, all of them on every rank: what Nitsche's
// terms see of the displacement. Small beside the domain, so that the terms are evaluated without
// communication and are bitwise the same for any number of ranks.
#pragma once

#include "rbvi/contact/nitsche/nitsche_curve.hpp"
#include "rbvi/fem/dofs.hpp"
#include "rbvi/fem/trace.hpp"

namespace rbvi {

struct ContactLayer {
  std::vector<CurveCell> cells;  ///< along the curve, by increasing x
  std::vector<PetscInt> natural; ///< natural number of each dof of the layer
  Trace trace;                   ///< these dofs, all of them free
};

/// Collective. Triangles with an edge on `boundary`. Throws bad_input where there is none, and for
/// three dimensions.
ContactLayer make_contact_layer(const Mesh &mesh, const Dofs &dofs, const std::string &boundary);

} // namespace rbvi
