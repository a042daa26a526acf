#include "seen.hpp"

#include "rbvi/element/facets.hpp"
#include "rbvi/par/collective.hpp"

#include <numeric>
#include <set>

namespace rbvi {

SeenNodes gather_nodes(const Mesh &mesh, const Dofs &dofs, std::vector<int> mine) {
  std::ranges::sort(mine);
  mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
  const auto components = static_cast<std::size_t>(dofs.components);
  std::vector<PetscInt> natural, fixed;
  std::vector<double> x;
  for (const int local : mine) {
    const auto node = static_cast<std::size_t>(local);
    natural.push_back(mesh.natural_node[node]);
    x.insert(x.end(), mesh.points[node].begin(), mesh.points[node].end());
    fixed.push_back(0);
    for (std::size_t c = 0; c < components; ++c)
      if (dofs.free[node * components + c] < 0) fixed.back() |= PetscInt{1} << c;
  }
  natural = gather_all(mesh.comm, natural, MPIU_INT);
  fixed = gather_all(mesh.comm, fixed, MPIU_INT);
  x = gather_all(mesh.comm, x, MPI_DOUBLE);
  std::vector<std::size_t> order(natural.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return natural[k]; });
  SeenNodes all;
  for (const std::size_t k : order) {
    if (!all.natural.empty() && all.natural.back() == natural[k]) continue;
    all.natural.push_back(natural[k]);
    all.fixed.push_back(fixed[k]);
    all.points.push_back({x[3 * k], x[3 * k + 1], x[3 * k + 2]});
  }
  return all;
}

SeenCells gather_cells(const Mesh &mesh, const Dofs &dofs, const std::vector<SeenCell> &mine,
                       int nodes_of_each) {
  const auto per_cell = static_cast<std::size_t>(nodes_of_each);
  std::vector<int> nodes;
  std::vector<PetscInt> packed;
  for (const SeenCell &cell : mine) {
    nodes.insert(nodes.end(), cell.nodes.begin(),
                 cell.nodes.begin() + static_cast<std::ptrdiff_t>(per_cell));
    packed.insert(packed.end(), {cell.number, cell.edge});
    for (std::size_t i = 0; i < per_cell; ++i)
      packed.push_back(mesh.natural_node[cell.nodes[i]]);
  }
  SeenCells all{{}, gather_nodes(mesh, dofs, std::move(nodes))};
  packed = gather_all(mesh.comm, packed, MPIU_INT);
  for (std::size_t at = 0; at < packed.size(); at += 2 + per_cell) {
    SeenCell &cell = all.cells.emplace_back(SeenCell{packed[at], packed[at + 1], {}});
    for (std::size_t i = 0; i < per_cell; ++i)
      cell.nodes[i] = static_cast<int>(all.nodes.position(packed[at + 2 + i]));
  }
  return all;
}

SeenCurve gather_curve(const Mesh &mesh, const Dofs &dofs, const std::string &boundary) {
  std::vector<int> mine;
  std::vector<PetscInt> middles;
  for (const auto &[cell, facet] : mesh.facets.at(boundary)) {
    const std::array<int, most_nodes> nodes = nodes_of(mesh, cell);
    std::vector<int> own;
    for (const int i : facet_nodes(2, mesh.degree, facet))
      own.push_back(nodes[i]);
    mine.insert(mine.end(), own.begin(), own.end());
    if (mesh.degree == 1) continue;
    for (const int node : own)
      middles.push_back(mesh.natural_node[node]);
  }
  SeenCurve curve{gather_nodes(mesh, dofs, std::move(mine)), {}};
  middles = gather_all(mesh.comm, middles, MPIU_INT);
  for (std::size_t i = 0; i < middles.size(); i += 3)
    curve.middle[middles[i]] = middles[i + 2];
  return curve;
}

void move_middles(const Mesh &mesh, const Scene &scene, const std::string &boundary,
                  SeenNodes &nodes) {
  if (mesh.degree == 1 || scene.curves.empty()) return;
  std::set<std::pair<std::size_t, int>> left; // a boundary may hold several curves
  for (const auto &[cell, facet] : mesh.facets.at(boundary))
    left.emplace(cell, facet);
  std::vector<PetscInt> middles;
  std::vector<double> places;
  for (const auto &[name, curve] : scene.curves) {
    const auto own = mesh.facets.find(name);
    if (own == mesh.facets.end()) continue;
    for (const auto &[cell, facet] : own->second) {
      if (left.erase({cell, facet}) == 0) continue;
      const int middle = nodes_of(mesh, cell)[facet_nodes(2, 2, facet)[2]];
      const Point x = curve(mesh.points[middle]);
      middles.push_back(mesh.natural_node[middle]);
      places.insert(places.end(), x.begin(), x.end());
    }
  }
  middles = gather_all(mesh.comm, middles, MPIU_INT);
  places = gather_all(mesh.comm, places, MPI_DOUBLE);
  for (std::size_t k = 0; k < middles.size(); ++k)
    nodes.points[nodes.position(middles[k])] = {places[3 * k], places[3 * k + 1],
                                                places[3 * k + 2]};
}

} // namespace rbvi
