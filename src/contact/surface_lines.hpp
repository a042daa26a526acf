// Surfaces of contact in space as lines across their triangles (contact/named_outputs.hpp).
#pragma once

#include "rbvi/contact/named_outputs.hpp"

namespace rbvi {

/// contact_lines of a grid of triangles, of degree 1 or 2.
std::vector<ContactLine> surface_lines(const Grid &grid, const FrictionBound &bound, double least);

} // namespace rbvi
