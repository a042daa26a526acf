#include "rbvi/model/solution_vtu.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/io/vtu.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// A solution at one mu.
struct State {
  const Scene &scene;
  const FullMu &mu; ///< all parameters
  const ReducedModel &model;
  const Vector &u, &lambda;
  Vector moved; ///< motion + u at the mesh nodes; vectors with three components
};

Matrix mapped(const State &state, const Matrix &points) {
  Matrix result(points.rows(), points.cols());
  for (Index i = 0; i < points.rows(); ++i) {
    const Point image = state.scene.map(state.mu, point_of(points, i));
    for (Index k = 0; k < points.cols(); ++k)
      result(i, k) = image[k];
  }
  straighten_edges(state.model.fields.cells, state.scene.dim, state.scene.degree, result);
  return result;
}

/// ParaView warps by vectors with three components.
Vector displacement(const Scene &scene, const FullMu &mu, const Matrix &points, const Vector &u) {
  const Index components = scene.components;
  if (components == 1) return u;
  Vector result = Vector::Zero(3 * points.rows());
  for (Index i = 0; i < points.rows(); ++i) {
    const Point motion = scene.motion ? scene.motion(mu, point_of(points, i)) : Point{};
    for (Index c = 0; c < components; ++c)
      result[3 * i + c] = motion[c] + u[components * i + c];
  }
  return result;
}

Grid bodies(const State &state) {
  const auto &[scene, mu, model, u, lambda, moved] = state;
  const int per_cell = nodes_per_cell(scene.dim, scene.degree);
  Grid grid{mapped(state, model.fields.points), model.fields.cells, per_cell, {}, {}, {}};
  name_parameters(scene, mu, grid);
  if (model.fields.cells.empty())
    throw failure("the model was read without its fields: no full field can be written");
  grid.of_nodes = {{"u", moved, "m"}};
  for (std::size_t i = 0; i < scene.contacts.size(); ++i)
    grid.contacts.push_back(contact_name(scene, i));
  const int first = model.contact.interfaces.front().nodes.front();
  grid.of_cells = {
      {"body", body_numbers(model.fields.cells, per_cell, model.fields.points.rows(), first)}};
  if (scene.materials.empty()) return grid;
  const Matrix stresses = centre_stresses(scene, mu, model.fields.points, model.fields.cells,
                                          model.fields.materials, moved);
  grid.of_cells.push_back({"von_mises", von_mises(stresses), "Pa"});
  const std::vector<std::string> names = stress_components(scene.dim);
  for (Index c = 0; c < stresses.cols(); ++c)
    grid.of_cells.push_back({names[c], stresses.col(c), "Pa"});
  return grid;
}

/// An interface with its share of the multipliers.
Grid interface_grid(const State &state, const Contact &contact, std::size_t number) {
  ContactInterface &interface = *contact.interfaces[number];
  const std::vector<int> &nodes = state.model.contact.interfaces[number].nodes;
  const Index components = state.scene.components;
  Vector u(std::ssize(nodes) * components);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    u.segment(static_cast<Index>(k) * components, components) =
        state.u.segment(nodes[k] * components, components);
  Grid grid =
      contact_fields(interface, state.mu, u,
                     state.lambda.segment(contact.first_row[number], interface.dual().size()));
  name_parameters(state.scene, state.mu, grid);
  grid.contacts = {contact.names[number]};
  return grid;
}

} // namespace

void name_parameters(const Scene &scene, const FullMu &all_parameters, Grid &grid) {
  grid.scene = scene.name;
  if (scene.units) {
    grid.length = unit_in(*scene.units, dimension_of("m"));
    grid.stress = unit_in(*scene.units, dimension_of("Pa"));
  }
  for (std::size_t i = 0; i < all_parameters.size(); ++i) {
    const Parameter &parameter = scene.parameters.all[i];
    grid.of_all.push_back(
        {"mu_" + parameter.name, Vector::Constant(1, all_parameters[i]), parameter.unit});
  }
}

Grid body_grid(const Scene &scene, const FullMu &all, const ReducedModel &model, const Vector &u) {
  const Vector none;
  return bodies({scene, all, model, u, none, displacement(scene, all, model.fields.points, u)});
}

std::vector<Grid> solution_grids(const Scene &scene, const FullMu &all, const ReducedModel &model,
                                 const Vector &u, const Vector &lambda) {
  const State state{scene, all, model, u, lambda, displacement(scene, all, model.fields.points, u)};
  const Contact contact = contact_of(model, scene);
  std::vector<Grid> grids{bodies(state)};
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i)
    grids.push_back(interface_grid(state, contact, i));
  return grids;
}

} // namespace rbvi
