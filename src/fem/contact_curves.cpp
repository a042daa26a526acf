#include "rbvi/fem/contact_curves.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/gather.hpp"

#include <algorithm>

namespace rbvi {

namespace {

struct CurveNode {
  double x;
  PetscInt natural;
  Point point;
  bool fixed;
};

/// Everybody's owned vertices on a boundary, by increasing x.
std::vector<CurveNode> gather_curve(const Mesh &mesh, const Dofs &dofs, const std::string &name) {
  const std::vector<bool> &on_curve = mesh.boundary.at(name);
  const auto components = static_cast<std::size_t>(dofs.components);
  std::vector<PetscInt> numbers, fixed;
  std::vector<double> coordinates;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    if (!on_curve[v] || !mesh.owned_vertex[v]) continue;
    numbers.push_back(mesh.natural_vertex[v]);
    fixed.push_back(dofs.free[v * components + components - 1] < 0);
    coordinates.insert(coordinates.end(), mesh.points[v].begin(), mesh.points[v].end());
  }
  numbers = gather_all(mesh.comm, numbers, MPIU_INT);
  fixed = gather_all(mesh.comm, fixed, MPIU_INT);
  coordinates = gather_all(mesh.comm, coordinates, MPI_DOUBLE);
  std::vector<CurveNode> nodes;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Point x{coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]};
    nodes.push_back({x[0], numbers[i], x, fixed[i] != 0});
  }
  std::sort(nodes.begin(), nodes.end(),
            [](const CurveNode &a, const CurveNode &b) { return a.x < b.x; });
  return nodes;
}

void check_curve(const std::vector<CurveNode> &nodes, const std::string &name) {
  if (nodes.size() < 2) throw bad_input("the contact curve '" + name + "' has no edge");
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].fixed)
      throw bad_input("the vertical displacement is fixed on the contact curve '" + name +
                      "': contact cannot move it");
    if (i > 0 && !(nodes[i].x > nodes[i - 1].x))
      throw bad_input("two nodes of the contact curve '" + name + "' have the same x = " +
                      std::to_string(nodes[i].x) + ": vertical pairing needs a graph over x");
  }
}

} // namespace

ContactCurves make_contact_curves(const Mesh &mesh, const Dofs &dofs, const PairRecipe &pair) {
  if (mesh.dim != 2)
    throw bad_input("two bodies can meet in two dimensions only: the mesh has " +
                    std::to_string(mesh.dim));
  ContactCurves curves;
  for (const std::string &name : {pair.slave, pair.master}) {
    const std::vector<CurveNode> nodes = gather_curve(mesh, dofs, name);
    check_curve(nodes, name);
    if (name == pair.slave) curves.slave_nodes = static_cast<Index>(nodes.size());
    for (const CurveNode &node : nodes) {
      curves.natural_vertex.push_back(node.natural);
      curves.points.push_back(node.point);
    }
  }
  std::vector<PetscInt> vertical;
  for (const PetscInt vertex : curves.natural_vertex)
    vertical.push_back(vertex * dofs.components + dofs.components - 1);
  curves.trace = make_trace(dofs, vertical);
  return curves;
}

} // namespace rbvi
