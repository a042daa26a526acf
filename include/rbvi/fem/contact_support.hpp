// The curve along which a body can meet a rigid support, whole on every rank: its nodes carry the
// displacements that the contact forms touch. Small beside the domain, so that the contact
// operators are assembled without communication and are bitwise the same for any number of ranks.
#pragma once

#include "rbvi/contact/support/support.hpp"
#include "rbvi/fem/dofs.hpp"
#include "rbvi/fem/trace.hpp"

namespace rbvi {

/// Contact dof = node * components + component.
struct ContactSupport {
  SupportCurve curve;
  std::vector<PetscInt> natural_node; ///< per point of the curve
  Trace trace;
};

/// Collective. Throws bad_input where the curve has no edge, has two nodes of the same x (it must
/// be a graph over x), or has a fixed displacement, and for three dimensions.
ContactSupport make_contact_support(const Mesh &mesh, const Dofs &dofs,
                                    const SupportRecipe &support);

} // namespace rbvi
