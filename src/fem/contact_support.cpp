#include "rbvi/fem/contact_support.hpp"

#include "curve_nodes.hpp"
#include "rbvi/core/error.hpp"

#include <numeric>

namespace rbvi {

ContactSupport make_contact_support(const Mesh &mesh, const Dofs &dofs,
                                    const SupportRecipe &support) {
  if (mesh.dim != 2)
    throw bad_input("a body can meet a rigid support in two dimensions only: the mesh has " +
                    std::to_string(mesh.dim));
  std::vector<int> components(static_cast<std::size_t>(dofs.components));
  std::iota(components.begin(), components.end(), 0);
  ContactSupport contact;
  std::vector<PetscInt> natural_dofs;
  for (const CurveNode &node : gather_curve(mesh, dofs, support.boundary, components)) {
    contact.natural_node.push_back(node.natural);
    contact.curve.points.push_back(node.point);
    if (node.natural < mesh.total_vertices) ++contact.curve.vertices;
    for (const int c : components)
      natural_dofs.push_back(node.natural * dofs.components + c);
  }
  contact.trace = make_trace(dofs, natural_dofs);
  return contact;
}

} // namespace rbvi
