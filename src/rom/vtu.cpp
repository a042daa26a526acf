#include "rbvi/rom/vtu.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/h5.hpp"
#include "rbvi/element/lagrange.hpp"

#include <charconv>

namespace rbvi {

namespace {

template <class Number> void append(std::string &text, Number value, char separator) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  text += separator;
}

void open_array(std::string &text, const std::string &type, const std::string &name,
                Index components) {
  text += "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
          std::to_string(components) + "\" format=\"ascii\">\n";
}

int vtk_cell_type(int per_cell) {
  if (per_cell == 2) return 3;
  if (per_cell == 3) return 5;
  if (per_cell == 4) return 10;
  if (per_cell == 6) return 22;
  if (per_cell == 10) return 24;
  throw failure("no VTU cell type has " + std::to_string(per_cell) + " nodes");
}

void append_cells(std::string &text, const std::vector<int> &cells, int per_cell) {
  const std::size_t count = cells.size() / static_cast<std::size_t>(per_cell);
  const int type = vtk_cell_type(per_cell);
  text += "<Cells>\n";
  open_array(text, "Int32", "connectivity", 1);
  for (const int node : cells)
    append(text, node, '\n');
  text += "</DataArray>\n";
  open_array(text, "Int32", "offsets", 1);
  for (std::size_t i = 1; i <= count; ++i)
    append(text, i * static_cast<std::size_t>(per_cell), '\n');
  text += "</DataArray>\n";
  open_array(text, "UInt8", "types", 1);
  for (std::size_t i = 0; i < count; ++i)
    append(text, type, '\n');
  text += "</DataArray>\n</Cells>\n";
}

void append_field(std::string &text, const Field &field, Index count) {
  if (count == 0 || field.values.size() == 0 || field.values.size() % count != 0)
    throw failure("field " + field.name + " has " + std::to_string(field.values.size()) +
                  " values for " + std::to_string(count) + " nodes or cells");
  const Index components = field.values.size() / count;
  open_array(text, "Float64", field.name, components);
  for (Index i = 0; i < field.values.size(); ++i)
    append(text, field.values[i], (i + 1) % components == 0 ? '\n' : ' ');
  text += "</DataArray>\n";
}

void append_fields(std::string &text, const std::string &where, const std::vector<Field> &fields,
                   Index count) {
  text += "<" + where + ">\n";
  for (const Field &field : fields)
    append_field(text, field, count);
  text += "</" + where + ">\n";
}

Matrix mapped(const Scene &scene, const Mu &all, const Matrix &points) {
  Matrix result(points.rows(), points.cols());
  for (Index i = 0; i < points.rows(); ++i) {
    const Point image = scene.map(all, point_of(points, i));
    for (Index k = 0; k < points.cols(); ++k)
      result(i, k) = image[static_cast<std::size_t>(k)];
  }
  return result;
}

/// motion + u at the mesh nodes; vectors with three components, as ParaView warps by.
Vector displacement(const Scene &scene, const Mu &all, const Matrix &points, const Vector &u) {
  const Index components = scene.components;
  if (components == 1) return u;
  Vector result = Vector::Zero(3 * points.rows());
  for (Index i = 0; i < points.rows(); ++i) {
    const Point motion = scene.motion ? scene.motion(all, point_of(points, i)) : Point{};
    for (Index c = 0; c < components; ++c)
      result[3 * i + c] = motion[static_cast<std::size_t>(c)] + u[components * i + c];
  }
  return result;
}

void write_region(const std::filesystem::path &path, const Scene &scene, const Mu &all,
                  const ReducedModel &model, const Vector &u, const Vector &lambda) {
  const Matrix points = mapped(scene, all, model.contact_points);
  Vector gap(points.rows());
  for (Index i = 0; i < gap.size(); ++i)
    gap[i] = u[model.contact_nodes[static_cast<std::size_t>(i)]] -
             scene.obstacle(all, point_of(points, i));
  write_vtu(path, points, model.contact_cells, scene.dim + 1, {{"pressure", lambda}, {"gap", gap}});
}

void write_curve(const std::filesystem::path &path, const Scene &scene, const Mu &all,
                 const ReducedModel &model, const Vector &displacements, const Vector &u,
                 const Vector &lambda) {
  std::vector<Point> curves;
  Vector vertical(model.contact_points.rows());
  for (Index i = 0; i < vertical.size(); ++i) {
    const int node = model.contact_nodes[static_cast<std::size_t>(i)];
    curves.push_back(point_of(model.contact_points, i));
    vertical[i] = u[node * scene.components + scene.components - 1];
  }
  const PairOperators pair = couple_at(scene, all, curves, model.slave_nodes);
  const auto count = static_cast<Index>(pair.paired.size());
  if (count < 2) { // nothing of the slave curve faces the master curve
    std::filesystem::remove(path);
    return;
  }
  const Vector gap = pair.nodal_gap - pair.nodal_b * vertical;
  const bool constant = scene.pair->discretisation.multiplier == MultiplierSpace::macro_edges;
  Vector moved(3 * count), pressure(constant ? count - 1 : count);
  std::vector<int> edges;
  for (Index k = 0; k < count; ++k) {
    const Index node = pair.paired[static_cast<std::size_t>(k)];
    moved.segment(3 * k, 3) =
        displacements.segment(3 * model.contact_nodes[static_cast<std::size_t>(node)], 3);
    if (k + 1 < count) edges.insert(edges.end(), {static_cast<int>(k), static_cast<int>(k) + 1});
    if (k < pressure.size())
      pressure[k] = lambda[constant ? macro_edge_of(node, model.slave_nodes) : node];
  }
  const Matrix points = mapped(scene, all, model.contact_points(pair.paired, Eigen::all));
  std::vector<Field> nodal{{"u", moved}, {"gap", gap}}, per_edge;
  (constant ? per_edge : nodal).push_back({"pressure", pressure});
  write_vtu(path, points, edges, 2, nodal, per_edge);
}

void write_support(const std::filesystem::path &path, const Scene &scene, const Mu &all,
                   const ReducedModel &model, const Vector &displacements, const Vector &u,
                   const Vector &lambda) {
  const Index count = model.contact_points.rows();
  Vector local(count * scene.components), moved(3 * count);
  std::vector<int> edges;
  for (Index k = 0; k < count; ++k) {
    const Index node = model.contact_nodes[static_cast<std::size_t>(k)];
    local.segment(k * scene.components, scene.components) =
        u.segment(node * scene.components, scene.components);
    moved.segment(3 * k, 3) = displacements.segment(3 * node, 3);
    if (k + 1 < count) edges.insert(edges.end(), {static_cast<int>(k), static_cast<int>(k) + 1});
  }
  std::vector<Field> nodal{{"u", moved},
                           {"gap", normal_gap(scene, all, model.contact_points, local)},
                           {"pressure", lambda.head(count)}};
  if (lambda.size() > count) nodal.push_back({"tangential_stress", lambda.tail(count)});
  write_vtu(path, mapped(scene, all, model.contact_points), edges, 2, nodal);
}

} // namespace

void write_vtu(const std::filesystem::path &path, const Matrix &points,
               const std::vector<int> &cells, int per_cell, const std::vector<Field> &nodal,
               const std::vector<Field> &per_cell_fields) {
  const Index nodes = points.rows();
  std::string text = "<?xml version=\"1.0\"?>\n"
                     "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">\n<UnstructuredGrid>\n"
                     "<Piece NumberOfPoints=\"" +
                     std::to_string(nodes) + "\" NumberOfCells=\"" +
                     std::to_string(cells.size() / static_cast<std::size_t>(per_cell)) +
                     "\">\n<Points>\n";
  open_array(text, "Float64", "points", 3);
  for (Index i = 0; i < nodes; ++i) {
    const Point point = point_of(points, i);
    append(text, point[0], ' ');
    append(text, point[1], ' ');
    append(text, point[2], '\n');
  }
  text += "</DataArray>\n</Points>\n";
  append_cells(text, cells, per_cell);
  append_fields(text, "PointData", nodal, nodes);
  append_fields(text, "CellData", per_cell_fields, static_cast<Index>(cells.size()) / per_cell);
  text += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  write_atomically(path, text);
}

std::filesystem::path contact_file(const std::filesystem::path &path) {
  return path.parent_path() / (path.stem().string() + "_contact" + path.extension().string());
}

void write_vtu(const std::filesystem::path &path, const Scene &scene, const Mu &all,
               const ReducedModel &model, const Vector &u, const Vector &lambda) {
  const Vector moved = displacement(scene, all, model.mesh_points, u);
  write_vtu(path, mapped(scene, all, model.mesh_points), model.mesh_cells,
            nodes_per_cell(scene.dim, scene.degree), {{"u", moved}});
  if (scene.support)
    write_support(contact_file(path), scene, all, model, moved, u, lambda);
  else if (model.two_bodies())
    write_curve(contact_file(path), scene, all, model, moved, u, lambda);
  else
    write_region(contact_file(path), scene, all, model, u, lambda);
}

} // namespace rbvi
