#include "rbvi/model/cell_outputs.hpp"

#include "rbvi/element/imposed.hpp"
#include "rbvi/element/lagrange.hpp"

#include <algorithm>
#include <optional>

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

/// The parts of some outputs, with their cells and nodes alone.
OutputModel restricted(const OutputModel &model, const Scene &scene,
                       const std::function<bool(int output)> &keeps) {
  const OutputCells &cells = model.cells;
  const auto per_cell = static_cast<std::size_t>(nodes_per_cell(scene.dim, scene.degree));
  const auto components = static_cast<std::size_t>(scene.components);
  std::vector<bool> cell_taken(cells.cells.size() / per_cell), node_taken(cells.nodes.size());
  OutputModel result;
  for (const OutputCells::Part &part : cells.parts) {
    if (!keeps(part.output)) continue;
    result.cells.parts.push_back(part);
    cell_taken[static_cast<std::size_t>(part.cell)] = true;
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
  std::vector<Index> nodes, dofs;
  for (std::size_t node = 0; node < node_taken.size(); ++node) {
    if (!node_taken[node]) continue;
    nodes.push_back(static_cast<Index>(node));
    result.cells.nodes.push_back(cells.nodes[node]);
    for (std::size_t dof = node * components; dof < (node + 1) * components; ++dof) {
      dofs.push_back(static_cast<Index>(dof));
      if (!cells.imposed_by.empty()) result.cells.imposed_by.push_back(cells.imposed_by[dof]);
    }
  }
  result.cells.points = cells.points(nodes, Eigen::all);
  result.basis = model.basis(dofs, Eigen::all);
  return result;
}

} // namespace

bool fits(const OutputModel &outputs, const Scene &scene, Index cells) {
  const Index terms = std::ssize(scene.a) + std::ssize(scene.f);
  return std::ranges::all_of(outputs.cells.parts, [&](const OutputCells::Part &part) {
    const auto below = [](int i, Index bound) { return i >= 0 && i < bound; };
    return below(part.output, std::ssize(scene.outputs)) && below(part.cell, cells) &&
           below(part.facet + 1, scene.dim + 2) && part.term < std::max<Index>(terms, 2) &&
           contact_of_part(part) < std::ssize(scene.contacts);
  });
}

CellOutputs::CellOutputs(const OutputModel &model, const Scene &scene,
                         const std::vector<std::string> &only)
    : model_(model), scene_(scene) {
  const auto asked = [&](int output) { return is_asked(only, scene.outputs[output].name); };
  for (int output = 0; output < std::ssize(scene.outputs); ++output)
    if (auto sum = asked(output) ? separated_reaction(scene, output, model.cells) : std::nullopt)
      reactions_[output] = {*sum, sum->rows * model.basis};
  others_ = restricted(model, scene,
                       [&](int output) { return asked(output) && !reactions_.contains(output); });
}

Vector imposed_at(const Scene &scene, const FullMu &mu, const Matrix &nodes,
                  const std::vector<int> &imposed_by) {
  if (std::ranges::all_of(imposed_by, [](int boundary) { return boundary < 0; })) return {};
  std::vector<Point> points;
  for (Index i = 0; i < nodes.rows(); ++i)
    points.push_back(point_of(nodes, i));
  return imposed_values(scene, mu, points, imposed_by);
}

std::function<double(int output)> CellOutputs::at(const FullMu &mu, const Vector &u) const {
  return [this, &mu, &u, lift = std::optional<Vector>(),
          at_cells = std::optional<Vector>()](int output) mutable {
    const auto found = reactions_.find(output);
    if (found != reactions_.end()) {
      const auto &[sum, projected] = found->second;
      Vector of_terms = projected * u;
      if (!lift) lift = imposed_at(scene_, mu, model_.cells.points, model_.cells.imposed_by);
      if (lift->size() > 0) of_terms += sum.rows * *lift;
      return reaction_value(sum, scene_, mu, of_terms);
    }
    if (!at_cells) {
      const OutputCells &cells = others_.cells;
      at_cells = others_.basis * u;
      const Vector given = imposed_at(scene_, mu, cells.points, cells.imposed_by);
      if (given.size() > 0) *at_cells += given;
    }
    return cell_output(scene_, output, mu, others_.cells, *at_cells);
  };
}

} // namespace rbvi
