// A Gmsh mesh file as it stands: its nodes, and its linear elements with their physical groups.
#pragma once

#include "rbvi/core/scene.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rbvi {

struct GmshNode {
  std::size_t number;
  Point point;
};

/// A point, a line, a triangle or a tetrahedron.
struct GmshElement {
  std::size_t number;
  int dim;
  int groups;                       ///< index into GmshFile::groups
  std::array<std::size_t, 4> nodes; ///< numbers of dim + 1 nodes, the rest 0
};

/// Nodes and elements by increasing number, whatever the order of the file. An element of several
/// groups stands in a file of version 2.2 once for each of them.
struct GmshFile {
  std::map<std::pair<int, int>, std::string> names; ///< of a group: dimension, number
  std::vector<GmshNode> nodes;
  std::vector<std::vector<int>> groups; ///< lists of group numbers; an element's are of its dim
  std::vector<GmshElement> elements;
};

/// Versions 2.2, 4.0 and 4.1, text or binary. Physical groups alone count: what a version also says
/// of elementary entities stays apart. Throws bad_input, naming the file: it is missing, not a Gmsh
/// mesh, of another version or byte order, truncated, partitioned; a section is malformed; a node
/// is listed twice or not finite; elements are not linear simplices.
GmshFile read_gmsh_file(const std::string &file);

} // namespace rbvi
