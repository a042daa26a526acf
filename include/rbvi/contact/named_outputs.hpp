// Outputs that a scene has under names of its own (Scene::outputs): integrals, means, extrema and
// measures over contact interfaces of expressions in what is there, of full and of reduced answers
// alike. An interface is its vertices with straight pieces between them, on which pressure, gap,
// tangential stress and displacement are linear, so that a part on which a condition holds ends
// inside a piece, and its measure is continuous in mu. Axisymmetric: of the whole circumference.
#pragma once

#include "rbvi/contact/contact.hpp"

namespace rbvi {

/// Throws bad_input for an output of an interface that the scene does not have.
void check_outputs(const Scene &scene);

/// u at the nodes of interface number i, node * components + c, without the motion, with the values
/// that boundaries impose.
using InterfaceDisplacement = std::function<Vector(std::size_t i)>;

/// Sets Outputs::named. `lambda`: at the dual dofs. Throws failure for an extremum or a mean over
/// nothing, or a tangential stress where there is no friction.
void add_named_outputs(const Scene &scene, const Contact &contact, const FullMu &mu,
                       const InterfaceDisplacement &u, const Vector &lambda, Outputs &outputs);

} // namespace rbvi
