#include "rbvi/fem/contact_curves.hpp"

#include "curve_nodes.hpp"
#include "rbvi/core/error.hpp"

namespace rbvi {

ContactCurves make_contact_curves(const Mesh &mesh, const Dofs &dofs, const Scene &scene) {
  const PairRecipe &pair = scene.pair.value();
  if (mesh.dim != 2)
    throw bad_input("two bodies can meet in two dimensions only: the mesh has " +
                    std::to_string(mesh.dim));
  const int vertical = dofs.components - 1;
  ContactCurves curves;
  std::vector<PetscInt> natural_dofs;
  for (const std::string &name : {pair.slave, pair.master}) {
    const std::vector<CurveNode> nodes = gather_curve(mesh, dofs, name, {vertical});
    if (name == pair.slave) curves.slave_nodes = static_cast<Index>(nodes.size());
    for (const CurveNode &node : nodes) {
      curves.natural_node.push_back(node.natural);
      const bool middle = node.natural >= mesh.total_vertices;
      curves.points.push_back(middle && scene.snap ? scene.snap(node.point) : node.point);
      natural_dofs.push_back(node.natural * dofs.components + vertical);
    }
  }
  curves.trace = make_trace(dofs, natural_dofs);
  return curves;
}

} // namespace rbvi
