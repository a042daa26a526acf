#include "rbvi/rom/solution_vtu.hpp"

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
      result(i, k) = image[static_cast<std::size_t>(k)];
  }
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
      result[3 * i + c] = motion[static_cast<std::size_t>(c)] + u[components * i + c];
  }
  return result;
}

/// The scene and its parameters.
Grid make_grid(const State &state, const Matrix &points, std::vector<int> cells, int per_cell) {
  Grid grid{mapped(state, points), std::move(cells), per_cell, {}, {}, {}, state.scene.name};
  for (std::size_t i = 0; i < state.mu.size(); ++i) {
    const Parameter &parameter = state.scene.parameters.all[i];
    grid.of_all.push_back(
        {"mu_" + parameter.name, Vector::Constant(1, state.mu[i]), parameter.unit});
  }
  return grid;
}

Grid bodies(const State &state) {
  const auto &[scene, mu, model, u, lambda, moved] = state;
  const int per_cell = nodes_per_cell(scene.dim, scene.degree);
  Grid grid = make_grid(state, model.mesh_points, model.mesh_cells, per_cell);
  if (model.mesh_cells.empty())
    throw failure("the model was read without its fields: no full field can be written");
  grid.of_nodes = {{"u", moved, "m"}};
  const int first = model.contact_nodes.empty() ? 0 : model.contact_nodes.front();
  grid.of_cells = {
      {"body", body_numbers(model.mesh_cells, per_cell, model.mesh_points.rows(), first)}};
  if (!scene.material) return grid;
  const Matrix stresses = centre_stresses(scene, mu, model.mesh_points, model.mesh_cells, moved);
  grid.of_cells.push_back({"von_mises", von_mises(stresses), "Pa"});
  const std::vector<std::string> names = stress_components(scene.dim);
  for (Index c = 0; c < stresses.cols(); ++c)
    grid.of_cells.push_back({names[static_cast<std::size_t>(c)], stresses.col(c), "Pa"});
  return grid;
}

Grid region(const State &state) {
  const ReducedModel &model = state.model;
  Grid grid = make_grid(state, model.contact_points, model.contact_cells, state.scene.dim + 1);
  Vector gap(grid.points.rows());
  for (Index i = 0; i < gap.size(); ++i)
    gap[i] = state.u[model.contact_nodes[static_cast<std::size_t>(i)]] -
             state.scene.obstacle(state.mu, point_of(grid.points, i));
  grid.of_nodes = {{"pressure", state.lambda, "Pa"}, {"gap", gap, "m"}};
  return grid;
}

/// The edges between successive ones of the contact nodes, with their displacement.
Grid polyline(const State &state, const std::vector<Index> &nodes) {
  std::vector<int> edges;
  Vector moved(3 * static_cast<Index>(nodes.size()));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const int node = state.model.contact_nodes[static_cast<std::size_t>(nodes[k])];
    moved.segment(3 * static_cast<Index>(k), 3) = state.moved.segment(3 * node, 3);
    if (k > 0) edges.insert(edges.end(), {static_cast<int>(k) - 1, static_cast<int>(k)});
  }
  Grid grid = make_grid(state, state.model.contact_points(nodes, Eigen::all), edges, 2);
  grid.of_nodes = {{"u", moved, "m"}};
  return grid;
}

/// Values of the edges of a polyline at its nodes, weighted by length.
Vector means_at_nodes(const Matrix &points, const Vector &of_edges) {
  Vector sum = Vector::Zero(points.rows()), weight = Vector::Zero(points.rows());
  for (Index e = 0; e < of_edges.size(); ++e) {
    const double length = (points.row(e + 1) - points.row(e)).norm();
    sum.segment<2>(e).array() += length * of_edges[e];
    weight.segment<2>(e).array() += length;
  }
  return sum.cwiseQuotient(weight);
}

/// The slave curve of two bodies; without cells where nothing of it faces the master curve.
Grid curve(const State &state) {
  const auto &[scene, mu, model, u, lambda, moved] = state;
  std::vector<Point> curves;
  Vector vertical(model.contact_points.rows());
  for (Index i = 0; i < vertical.size(); ++i) {
    const int node = model.contact_nodes[static_cast<std::size_t>(i)];
    curves.push_back(point_of(model.contact_points, i));
    vertical[i] = u[node * scene.components + scene.components - 1];
  }
  const PairOperators pair = couple_at(scene, mu, curves, model.slave_nodes);
  const auto count = static_cast<Index>(pair.paired.size());
  if (count < 2) return {};
  Grid grid = polyline(state, {pair.paired.begin(), pair.paired.end()});
  grid.of_nodes.push_back({"gap", pair.nodal_gap - pair.nodal_b * vertical, "m"});
  const bool constant = scene.pair->discretisation.multiplier == MultiplierSpace::macro_edges;
  Vector pressure(constant ? count - 1 : count);
  for (Index k = 0; k < pressure.size(); ++k) {
    const Index node = pair.paired[static_cast<std::size_t>(k)];
    pressure[k] = lambda[constant ? macro_edge_of(node, model.slave_nodes, scene.degree) : node];
  }
  if (constant) grid.of_cells.push_back({"pressure", pressure, "Pa"});
  grid.of_nodes.push_back(
      {"pressure", constant ? means_at_nodes(grid.points, pressure) : pressure, "Pa"});
  return grid;
}

Grid support(const State &state) {
  const auto &[scene, mu, model, u, lambda, moved] = state;
  const Index count = model.contact_points.rows(), components = scene.components;
  std::vector<Index> nodes;
  Vector local(count * components);
  for (Index k = 0; k < count; ++k) {
    nodes.push_back(k);
    local.segment(k * components, components) =
        u.segment(model.contact_nodes[static_cast<std::size_t>(k)] * components, components);
  }
  Grid grid = polyline(state, nodes);
  grid.of_nodes.push_back({"gap", normal_gap(scene, mu, model.contact_points, local), "m"});
  grid.of_nodes.push_back({"pressure", lambda.head(count), "Pa"});
  if (lambda.size() > count)
    grid.of_nodes.push_back({"tangential_stress", lambda.tail(count), "Pa"});
  return grid;
}

} // namespace

std::filesystem::path contact_file(const std::filesystem::path &path) {
  return path.parent_path() / (path.stem().string() + "_contact" + path.extension().string());
}

std::vector<std::filesystem::path> write_vtu(const std::filesystem::path &path, const Scene &scene,
                                             const FullMu &all, const ReducedModel &model,
                                             const Vector &u, const Vector &lambda) {
  const State state{scene, all, model, u, lambda, displacement(scene, all, model.mesh_points, u)};
  const Grid whole = bodies(state);
  const Grid contact = scene.support        ? support(state)
                       : model.two_bodies() ? curve(state)
                                            : region(state);
  write_vtu(path, whole, vtu_format(whole));
  if (contact.cells.empty()) {
    std::filesystem::remove(contact_file(path));
    return {path};
  }
  write_vtu(contact_file(path), contact, vtu_format(contact));
  return {path, contact_file(path)};
}

} // namespace rbvi
