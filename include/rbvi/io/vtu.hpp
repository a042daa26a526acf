// Fields on simplices as VTU files (VTK XML), for ParaView.
#pragma once

#include "rbvi/core/dense.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace rbvi {

/// Values per node or per cell, the components of one side by side; or of the whole grid.
struct Field {
  std::string name;
  Vector values;
  std::string unit = ""; ///< "": without dimension
};

struct Grid {
  Matrix points;          ///< nodes x dim (2 or 3), m
  std::vector<int> cells; ///< `per_cell` node numbers each
  int per_cell = 3;       ///< 2 lines, 3 triangles, 4 tetrahedra, 6 and 10 quadratic ones
  std::vector<Field> of_nodes, of_cells, of_all;
  std::string scene = "";              ///< its name
  std::string length = "m", stress = "Pa"; ///< what fields in m and in Pa are in, and points
  std::vector<std::string> contacts{}; ///< of its interfaces; of a grid of one, of that one
};

enum class VtuFormat {
  ascii, ///< every digit, for eyes and small scripts
  base64 ///< the bytes of numbers as text, headers of 64 bits: shorter, and the file stays XML
};

/// ASCII up to 2000 nodes.
VtuFormat vtu_format(const Grid &grid);

/// `of_all`, the names and the units of all fields become field data. Written atomically. Throws
/// failure: sizes that do not fit, directory not writable.
void write_vtu(const std::filesystem::path &path, const Grid &grid, VtuFormat format);

} // namespace rbvi
