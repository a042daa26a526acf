#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/output_cells.hpp"

namespace rbvi {

namespace {

/// The position of each that is taken among those that are; -1 of the others.
std::vector<int> numbered(const std::vector<bool> &taken) {
  std::vector<int> numbers(taken.size(), -1);
  int next = 0;
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (taken[i]) numbers[i] = next++;
  return numbers;
}

} // namespace

SomeOutputCells some_of(const OutputCells &cells, const Scene &scene,
                        const std::vector<bool> &keeps) {
  const auto per_cell = static_cast<std::size_t>(nodes_per_cell(scene.dim, scene.degree));
  const auto components = static_cast<std::size_t>(scene.components);
  std::vector<bool> cell_taken(cells.cells.size() / per_cell), node_taken(cells.nodes.size());
  SomeOutputCells result;
  for (std::size_t part = 0; part < cells.parts.size(); ++part) {
    if (!keeps[part]) continue;
    result.cells.parts.push_back(cells.parts[part]);
    cell_taken[static_cast<std::size_t>(cells.parts[part].cell)] = true;
  }
  for (std::size_t k = 0; k < cells.cells.size(); ++k)
    if (cell_taken[k / per_cell]) node_taken[static_cast<std::size_t>(cells.cells[k])] = true;
  const std::vector<int> cell_number = numbered(cell_taken), node_number = numbered(node_taken);
  for (OutputCells::Part &part : result.cells.parts)
    part.cell = cell_number[static_cast<std::size_t>(part.cell)];
  for (std::size_t k = 0; k < cells.cells.size(); ++k)
    if (cell_taken[k / per_cell])
      result.cells.cells.push_back(node_number[static_cast<std::size_t>(cells.cells[k])]);
  for (std::size_t cell = 0; cell < cells.materials.size(); ++cell)
    if (cell_taken[cell]) result.cells.materials.push_back(cells.materials[cell]);
  for (std::size_t node = 0; node < node_taken.size(); ++node) {
    if (!node_taken[node]) continue;
    result.nodes.push_back(static_cast<Index>(node));
    result.cells.nodes.push_back(cells.nodes[node]);
    if (!cells.imposed_by.empty())
      for (std::size_t dof = node * components; dof < (node + 1) * components; ++dof)
        result.cells.imposed_by.push_back(cells.imposed_by[dof]);
  }
  result.cells.points = cells.points(result.nodes, Eigen::all);
  return result;
}

} // namespace rbvi
