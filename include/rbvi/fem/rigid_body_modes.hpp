// Displacements of a rigid body: what a multigrid method for elasticity must represent on coarse
// levels, and what a scene must hold (fem/free_motions.hpp).
#pragma once

#include "rbvi/fem/dofs.hpp"
#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// The displacement of a point in direction `component` by mode number `mode`: translations, then
/// rotations, about z, x and y.
double rigid_displacement(int dim, int mode, int component, const Point &x);

/// Translations and rotations on the free dofs, orthonormalised, of the reference mesh: three in
/// the plane, six in space. For matrices with the rows of `dofs` (MatSetNearNullSpace). Collective.
Handle<MatNullSpace> rigid_body_modes(const Mesh &mesh, const Dofs &dofs);

} // namespace rbvi
