// What free rigid motions are called.
#pragma once

#include "rbvi/fem/free_motions.hpp"

namespace rbvi {

/// Squares of sines between motions and what holds them, and energies relative to those of a rough
/// field: less is round-off.
inline constexpr double motion_is_held = 1e-12;

/// "(0.5, 1)".
std::string vector_text(int dim, const Point &x);

/// "move along (0, 1) and turn about (0.5, 0)": the columns of `free`, modes x any number,
/// orthonormal combinations of rigid_displacement() about the centre of a body, in its sizes.
std::string motions_text(int dim, const MeshPart &body, const Matrix &free);

} // namespace rbvi
