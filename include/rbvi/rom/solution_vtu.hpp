// One solution as VTU files: the bodies and their contact.
#pragma once

#include "rbvi/rom/online.hpp"

namespace rbvi {

/// "u.vtu" -> "u_contact.vtu".
std::filesystem::path contact_file(const std::filesystem::path &path);

/// One solution, full or reduced: `u` at all dofs (the motion of the scene is added), `lambda` at
/// the dual dofs, on the mesh of `model` mapped by h(mu) (its fields, contact points, nodes and
/// cells alone are read). The displacement goes to `path`, with the number of the body on each cell
/// and, of elastic bodies, the stresses at its centre; to contact_file(path) pressure and gap: in
/// the contact region, or along the edges of the slave curve that have a partner, with its
/// displacement. A pressure that is constant on edges is also given at the nodes, as the mean of
/// the edges beside them weighted by length. Field data: "mu_NAME" of every parameter. Returns the
/// files written. Throws failure if the model was read without its fields.
std::vector<std::filesystem::path> write_vtu(const std::filesystem::path &path, const Scene &scene,
                                             const FullMu &all_parameters,
                                             const ReducedModel &model, const Vector &u,
                                             const Vector &lambda);

} // namespace rbvi
