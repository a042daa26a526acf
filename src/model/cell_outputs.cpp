#include "rbvi/model/cell_outputs.hpp"

#include "rbvi/element/imposed.hpp"

#include <algorithm>
#include <optional>

namespace rbvi {

namespace {

/// The parts of some outputs, with their cells and nodes alone.
OutputModel restricted(const OutputModel &model, const Scene &scene,
                       const std::function<bool(int output)> &keeps) {
  std::vector<bool> parts;
  for (const OutputCells::Part &part : model.cells.parts)
    parts.push_back(keeps(part.output));
  const auto [cells, nodes] = some_of(model.cells, scene, parts);
  std::vector<Index> dofs;
  for (const Index node : nodes)
    for (Index c = 0; c < scene.components; ++c)
      dofs.push_back(node * scene.components + c);
  return {cells, model.basis(dofs, Eigen::all)};
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
