// One solution as VTU files: the bodies and their contact.
#pragma once

#include "rbvi/model/online.hpp"

namespace rbvi {

/// Adds the name of the scene and its parameters, "mu_NAME", as field data.
void name_parameters(const Scene &scene, const FullMu &all_parameters, Grid &grid);

/// "u.vtu", "_mesh" -> "u_mesh.vtu".
std::filesystem::path file_beside(const std::filesystem::path &path, const std::string &suffix);

/// Of the interfaces of a scene: "u.vtu", "_contact" -> "u_contact.vtu"; of several by their names,
/// "u_contact_upper_plate.vtu", or "u_contact_1.vtu" where they have none.
std::vector<std::filesystem::path> contact_files(const std::filesystem::path &path,
                                                 const Scene &scene,
                                                 const std::string &suffix = "_contact");

/// The bodies as write_vtu has them. Throws failure if the model was read without its fields.
Grid body_grid(const Scene &scene, const FullMu &all_parameters, const ReducedModel &model,
               const Vector &u);

/// The bodies, then each interface, as write_vtu has them; of an interface that faces nothing
/// without cells. Throws likewise.
std::vector<Grid> solution_grids(const Scene &scene, const FullMu &all_parameters,
                                 const ReducedModel &model, const Vector &u, const Vector &lambda);

/// One solution, full or reduced: `u` at all dofs (the motion of the scene is added), `lambda` at
/// the dual dofs, on the mesh of `model` mapped by h(mu) (its fields and interfaces alone are
/// read). The displacement goes to `path`, with the number of the body on each cell
/// and, of elastic bodies, the stresses at its centre; to its contact_files each interface
/// with pressure, gap, normal and (curves) displacement; of two bodies the part of the slave curve
/// that faces the master. A pressure that is constant on edges is also given at the nodes, as the
/// mean of the edges beside them weighted by length. Field data: "mu_NAME" of every parameter, the
/// names of the interfaces. Returns the files written. Throws failure if the model was read without
/// its fields.
std::vector<std::filesystem::path> write_vtu(const std::filesystem::path &path, const Scene &scene,
                                             const FullMu &all_parameters,
                                             const ReducedModel &model, const Vector &u,
                                             const Vector &lambda);

} // namespace rbvi
