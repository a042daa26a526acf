// Nodal fields on simplices as VTU files (VTK XML, ASCII with every digit), for ParaView.
#pragma once

#include "rbvi/rom/online.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace rbvi {

/// Values per node or per cell, the components of one side by side.
struct Field {
  std::string name;
  Vector values;
};

/// `points`: nodes x dim (2 or 3); `cells`: `per_cell` node numbers each (2 lines, 3 triangles,
/// 4 tetrahedra, 6 and 10 quadratic ones). Written atomically. Throws failure: sizes that do not
/// fit, directory not writable.
void write_vtu(const std::filesystem::path &path, const Matrix &points,
               const std::vector<int> &cells, int per_cell, const std::vector<Field> &nodal,
               const std::vector<Field> &per_cell_fields = {});

/// "u.vtu" -> "u_contact.vtu".
std::filesystem::path contact_file(const std::filesystem::path &path);

/// One solution, full or reduced: `u` at all dofs (the motion of the scene is added), `lambda` at
/// the dual dofs, on the mesh of `model` mapped by h(mu) (its fields, contact points, nodes and
/// cells alone are read). The displacement goes to `path`; to contact_file(path) pressure and gap:
/// in the contact region, or along the edges of the slave curve that have a partner, with its
/// displacement. Throws failure if the model was read without its fields.
void write_vtu(const std::filesystem::path &path, const Scene &scene, const Mu &all_parameters,
               const ReducedModel &model, const Vector &u, const Vector &lambda);

} // namespace rbvi
