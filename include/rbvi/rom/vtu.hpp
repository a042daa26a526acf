// Nodal fields on simplices as VTU files (VTK XML, ASCII with every digit), for ParaView.
#pragma once

#include "rbvi/rom/online.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace rbvi {

struct NodalField {
  std::string name;
  Vector values; ///< nodes * components, the components of a node side by side
};

/// `points`: nodes x dim (2 or 3); `cells`: `per_cell` node numbers each (2 lines, 3 triangles,
/// 4 tetrahedra). Written atomically. Throws failure: sizes that do not fit, directory not
/// writable.
void write_vtu(const std::filesystem::path &path, const Matrix &points,
               const std::vector<int> &cells, int per_cell, const std::vector<NodalField> &fields);

/// "u.vtu" -> "u_contact.vtu".
std::filesystem::path contact_file(const std::filesystem::path &path);

/// The displacement of an answer on the mesh mapped by h(mu), and in contact_file(path) the
/// pressure and, where the scene has an obstacle, the gap of the contact region. Throws failure if
/// the model was read without its fields.
void write_vtu(const std::filesystem::path &path, const OnlineSolver &solver, const Mu &mu,
               const ReducedSolution &solution);

} // namespace rbvi
