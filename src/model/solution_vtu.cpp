#include "rbvi/model/solution_vtu.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/io/vtu.hpp"

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
  straighten_edges(state.model.mesh_cells, state.scene.dim, state.scene.degree, result);
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
  Grid grid{mapped(state, model.mesh_points), model.mesh_cells, per_cell, {}, {}, {}};
  name_parameters(scene, mu, grid);
  if (model.mesh_cells.empty())
    throw failure("the model was read without its fields: no full field can be written");
  grid.of_nodes = {{"u", moved, "m"}};
  const int first = model.interfaces.front().nodes.front();
  grid.of_cells = {
      {"body", body_numbers(model.mesh_cells, per_cell, model.mesh_points.rows(), first)}};
  if (!scene.material) return grid;
  const Matrix stresses = centre_stresses(scene, mu, model.mesh_points, model.mesh_cells, moved);
  grid.of_cells.push_back({"von_mises", von_mises(stresses), "Pa"});
  const std::vector<std::string> names = stress_components(scene.dim);
  for (Index c = 0; c < stresses.cols(); ++c)
    grid.of_cells.push_back({names[c], stresses.col(c), "Pa"});
  return grid;
}

/// An interface with its share of the multipliers.
Grid interface_grid(const State &state, const Contact &contact, std::size_t number) {
  ContactInterface &interface = *contact.interfaces[number];
  const std::vector<int> &nodes = state.model.interfaces[number].nodes;
  const Index components = state.scene.components;
  Vector u(std::ssize(nodes) * components);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    u.segment(static_cast<Index>(k) * components, components) =
        state.u.segment(nodes[k] * components, components);
  Grid grid = interface.fields(
      state.mu, u, state.lambda.segment(contact.first_row[number], interface.dual().size()));
  name_parameters(state.scene, state.mu, grid);
  return grid;
}

} // namespace

void name_parameters(const Scene &scene, const FullMu &all_parameters, Grid &grid) {
  grid.scene = scene.name;
  for (std::size_t i = 0; i < all_parameters.size(); ++i) {
    const Parameter &parameter = scene.parameters.all[i];
    grid.of_all.push_back(
        {"mu_" + parameter.name, Vector::Constant(1, all_parameters[i]), parameter.unit});
  }
}

std::filesystem::path file_beside(const std::filesystem::path &path, const std::string &suffix) {
  return path.parent_path() / (path.stem().string() + suffix + path.extension().string());
}

std::filesystem::path contact_file(const std::filesystem::path &path, std::size_t number) {
  return file_beside(path, number == 0 ? "_contact" : "_contact_" + std::to_string(number + 1));
}

std::vector<std::filesystem::path> write_vtu(const std::filesystem::path &path, const Scene &scene,
                                             const FullMu &all, const ReducedModel &model,
                                             const Vector &u, const Vector &lambda) {
  const State state{scene, all, model, u, lambda, displacement(scene, all, model.mesh_points, u)};
  const Grid whole = bodies(state);
  const Contact contact = contact_of(model, scene);
  std::vector<Grid> interfaces;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i)
    interfaces.push_back(interface_grid(state, contact, i));
  write_vtu(path, whole, vtu_format(whole));
  std::vector<std::filesystem::path> written{path};
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const std::filesystem::path file = contact_file(path, i);
    if (interfaces[i].cells.empty()) {
      std::filesystem::remove(file);
      continue;
    }
    write_vtu(file, interfaces[i], vtu_format(interfaces[i]));
    written.push_back(file);
  }
  return written;
}

} // namespace rbvi
