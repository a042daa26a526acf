#include "curve_nodes.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/gather.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Bit c of component c.
PetscInt fixed_components(const Dofs &dofs, std::size_t node, const std::vector<int> &components) {
  PetscInt fixed = 0;
  for (const int c : components)
    if (dofs.free[node * static_cast<std::size_t>(dofs.components) + static_cast<std::size_t>(c)] <
        0)
      fixed |= PetscInt(1) << c;
  return fixed;
}

void check_curve(const std::vector<CurveNode> &nodes, PetscInt vertices, const std::string &name) {
  if (nodes.size() < 2 || nodes[1].natural >= vertices)
    throw bad_input("the contact curve '" + name + "' has no edge");
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const bool first = i == 0 || (nodes[i].natural >= vertices && nodes[i - 1].natural < vertices);
    if (!first && !(nodes[i].point[0] > nodes[i - 1].point[0]))
      throw bad_input("two nodes of the contact curve '" + name + "' have the same x = " +
                      std::to_string(nodes[i].point[0]) + ": it must be a graph over x");
  }
}

} // namespace

std::vector<CurveNode> gather_curve(const Mesh &mesh, const Dofs &dofs, const std::string &boundary,
                                    const std::vector<int> &components, bool may_be_fixed) {
  const std::vector<bool> &on_curve = mesh.boundary.at(boundary);
  std::vector<PetscInt> numbers, fixed;
  std::vector<double> coordinates;
  for (std::size_t node = 0; node < mesh.points.size(); ++node) {
    if (!on_curve[node] || !mesh.owned_node[node]) continue;
    numbers.push_back(mesh.natural_node[node]);
    fixed.push_back(fixed_components(dofs, node, components));
    coordinates.insert(coordinates.end(), mesh.points[node].begin(), mesh.points[node].end());
  }
  numbers = gather_all(mesh.comm, numbers, MPIU_INT);
  fixed = gather_all(mesh.comm, fixed, MPIU_INT);
  coordinates = gather_all(mesh.comm, coordinates, MPI_DOUBLE);
  std::vector<CurveNode> nodes;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (fixed[i] != 0 && !may_be_fixed)
      throw bad_input("the displacement is fixed on the contact curve '" + boundary +
                      "': contact cannot move it");
    nodes.push_back({numbers[i],
                     {coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]},
                     fixed[i]});
  }
  const auto key = [&](const CurveNode &node) {
    return std::pair(node.natural >= mesh.total_vertices, node.point[0]);
  };
  std::sort(nodes.begin(), nodes.end(),
            [&](const CurveNode &a, const CurveNode &b) { return key(a) < key(b); });
  check_curve(nodes, mesh.total_vertices, boundary);
  return nodes;
}

} // namespace rbvi
