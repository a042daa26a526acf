// The cells of a mesh that outputs of its scene are taken from.
#pragma once

#include "rbvi/element/output_cells.hpp"
#include "rbvi/fem/dofs.hpp"

namespace rbvi {

/// The same on every rank for any number of ranks. Throws bad_input for a point outside of the
/// mesh, for a reaction of a boundary where nothing is fixed in its direction, or that shares nodes
/// with a contact or a spring, whose forces on them are not known apart, and in three dimensions.
/// Collective.
OutputCells cells_of_outputs(const Scene &scene, const Mesh &mesh, const Dofs &dofs);

} // namespace rbvi
