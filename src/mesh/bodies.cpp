#include "rbvi/mesh/serial.hpp"

#include <numeric>

namespace rbvi {

std::vector<int> bodies_of(const SerialMesh &mesh) {
  std::vector<int> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root_of = [&](int vertex) {
    while (parent[vertex] != vertex)
      vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  for (const auto &cell : mesh.cells)
    for (int i = 1; i <= mesh.dim; ++i)
      parent[root_of(cell[i])] = root_of(cell[0]);
  std::vector<int> number(mesh.points.size(), -1), result;
  int count = 0;
  for (const auto &cell : mesh.cells) {
    int &own = number[root_of(cell[0])];
    if (own < 0) own = count++;
    result.push_back(own);
  }
  return result;
}

} // namespace rbvi
