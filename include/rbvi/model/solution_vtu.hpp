// One solution as VTU files: the bodies and their contact.
#pragma once

#include "rbvi/model/online.hpp"

namespace rbvi {

/// Adds the name of the scene and its parameters, "mu_NAME", as field data.
void name_parameters(const Scene &scene, const FullMu &all_parameters, Grid &grid);

/// "u.vtu", "_mesh" -> "u_mesh.vtu".
std::filesystem::path file_beside(const std::filesystem::path &path, const std::string &suffix);

/// Of the interface of this number: "u.vtu" -> "u_contact.vtu", "u_contact_2.vtu", ...
std::filesystem::path contact_file(const std::filesystem::path &path, std::size_t number = 0);

/// One solution, full or reduced: `u` at all dofs (the motion of the scene is added), `lambda` at
/// the dual dofs, on the mesh of `model` mapped by h(mu) (its fields and interfaces alone are
/// read). The displacement goes to `path`, with the number of the body on each cell
/// and, of elastic bodies, the stresses at its centre; to its contact_file each interface
/// with pressure, gap, normal and (curves) displacement; of two bodies the part of the slave curve
/// that faces the master. A pressure that is constant on edges is also given at the nodes, as the
/// mean of the edges beside them weighted by length. Field data: "mu_NAME" of every parameter.
/// Returns the files written. Throws failure if the model was read without its fields.
std::vector<std::filesystem::path> write_vtu(const std::filesystem::path &path, const Scene &scene,
                                             const FullMu &all_parameters,
                                             const ReducedModel &model, const Vector &u,
                                             const Vector &lambda);

} // namespace rbvi
