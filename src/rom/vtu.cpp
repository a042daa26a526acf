#include "rbvi/rom/vtu.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/h5.hpp"

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

void append_field(std::string &text, const NodalField &field, Index nodes) {
  if (nodes == 0 || field.values.size() == 0 || field.values.size() % nodes != 0)
    throw failure("field " + field.name + " has " + std::to_string(field.values.size()) +
                  " values for " + std::to_string(nodes) + " nodes");
  const Index components = field.values.size() / nodes;
  open_array(text, "Float64", field.name, components);
  for (Index i = 0; i < field.values.size(); ++i)
    append(text, field.values[i], (i + 1) % components == 0 ? '\n' : ' ');
  text += "</DataArray>\n";
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

} // namespace

void write_vtu(const std::filesystem::path &path, const Matrix &points,
               const std::vector<int> &cells, int per_cell, const std::vector<NodalField> &fields) {
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
  text += "<PointData>\n";
  for (const NodalField &field : fields)
    append_field(text, field, nodes);
  text += "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  write_atomically(path, text);
}

std::filesystem::path contact_file(const std::filesystem::path &path) {
  return path.parent_path() / (path.stem().string() + "_contact" + path.extension().string());
}

void write_vtu(const std::filesystem::path &path, const OnlineSolver &solver, const Mu &mu,
               const ReducedSolution &solution) {
  const ReducedModel &model = solver.model();
  const Scene &scene = solver.scene();
  const Mu all = expand(scene.parameters, mu);
  write_vtu(path, mapped(scene, all, model.mesh_points), model.mesh_cells, scene.dim + 1,
            {{"u", solver.field(solution)}});
  std::vector<NodalField> fields{{"pressure", solver.multiplier(solution)}};
  if (scene.obstacle) fields.push_back({"gap", solver.contact_gap(mu, solution)});
  write_vtu(contact_file(path), mapped(scene, all, model.contact_points), model.contact_cells,
            scene.dim + 1, fields);
}

} // namespace rbvi
