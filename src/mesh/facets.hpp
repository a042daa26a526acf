// Facets of a mesh on one process.
#pragma once

#include "rbvi/mesh/serial.hpp"

namespace rbvi {

using Facet = std::array<int, 3>; ///< decreasing vertices, the rest -1

Facet sorted_facet(Facet facet);

/// Those of one cell alone, sorted.
std::vector<Facet> outer_facets(const SerialMesh &mesh);

/// Those of a boundary, each once, sorted.
std::vector<Facet> facets_of(const SerialMesh &mesh, const std::string &boundary);

} // namespace rbvi
