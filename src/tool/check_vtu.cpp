// Pictures of a case before anything is made of it.
#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/io/vtu.hpp"
#include "rbvi/model/solution_vtu.hpp"
#include "rbvi/mor/reduce.hpp"
#include "rbvi/tool/commands.hpp"

#include <algorithm>
#include <array>

namespace rbvi {

namespace {

constexpr std::array places_in_box{"middle", "least", "largest"};

std::filesystem::path partners_file(const std::string &vtu, const Scene &scene, std::size_t contact,
                                    const std::string &place) {
  return file_beside(contact_files(vtu, scene, "_partners")[contact], "_" + place);
}

Vector as_numbers(const std::vector<bool> &flags) {
  Vector numbers(std::ssize(flags));
  for (std::size_t i = 0; i < flags.size(); ++i)
    numbers[static_cast<Index>(i)] = flags[i] ? 1 : 0;
  return numbers;
}

Matrix coordinates(const SerialMesh &mesh) {
  Matrix points(std::ssize(mesh.points), mesh.dim);
  for (Index i = 0; i < points.rows(); ++i)
    for (Index k = 0; k < points.cols(); ++k)
      points(i, k) = mesh.points[i][k];
  return points;
}

/// The first `count` of each.
template <class Simplices> std::vector<int> vertices(const Simplices &simplices, int count) {
  std::vector<int> all;
  for (const auto &simplex : simplices)
    all.insert(all.end(), simplex.begin(), simplex.begin() + count);
  return all;
}

/// 1 in the cells of each region, 0 elsewhere.
Grid grid_of(const SerialMesh &mesh) {
  Grid grid{coordinates(mesh), vertices(mesh.cells, mesh.dim + 1), mesh.dim + 1, {}, {}, {}};
  for (const auto &[name, cells] : mesh.region) {
    std::vector<bool> in(mesh.cells.size(), false);
    for (const int cell : cells)
      in[cell] = true;
    grid.of_cells.push_back({name, as_numbers(in)});
  }
  return grid;
}

/// 1 on the facets of each group, and on those of which the scene says nothing.
Grid grid_of(const SerialMesh &mesh, const MeshSurface &surface) {
  Grid grid{coordinates(mesh), vertices(surface.facets, mesh.dim), mesh.dim, {}, {}, {}};
  for (const auto &[name, in] : surface.groups)
    grid.of_cells.push_back({name, as_numbers(in)});
  grid.of_cells.push_back({"(free)", as_numbers(surface.free)});
  return grid;
}

/// A contact of bodies that are moved by the motion of the scene and not deformed: points, gaps,
/// normals and the way to the partner.
Grid partners_of(const Scene &scene, ContactInterface &interface, const FullMu &mu) {
  const InterfaceMesh &mesh = interface.mesh();
  Grid grid = interface.fields(mu, Vector::Zero(mesh.nodes() * mesh.components),
                               Vector::Zero(interface.dual().size()), false);
  grid.of_cells.clear();
  const auto named = [&](const std::string &name) {
    return std::ranges::find(grid.of_nodes, name, &Field::name);
  };
  if (const auto moved = named("u"); moved != grid.of_nodes.end() && mesh.components > 1)
    for (Index i = 0; i < grid.points.rows(); ++i)
      grid.points.row(i) += moved->values.segment(3 * i, grid.points.cols()).transpose();
  grid.of_nodes = {*named("gap"), *named("normal"), *named("to_partner")};
  name_parameters(scene, mu, grid);
  return grid;
}

/// At the middle of the box, and at the corners and centres of faces where the least gap is least
/// and largest, of equal ones the mean; no grid where nothing faces anything, or no gap varies.
std::vector<Grid> partners_in_box(const Scene &scene, ContactInterface &interface) {
  const ParameterSpace &space = scene.parameters;
  constexpr double round_off = 1e-9, share_of_mean = 1e-6;
  std::vector<std::pair<double, Mu>> found;
  double size = 0;
  for (const Mu &mu : corners_and_faces(space)) {
    const Grid grid = partners_of(scene, interface, expand(space, mu));
    if (grid.cells.empty()) continue;
    const Vector &gap = grid.of_nodes.front().values;
    found.emplace_back(gap.minCoeff() + share_of_mean * gap.mean(), mu);
    size = std::max(size, gap.cwiseAbs().maxCoeff());
  }
  std::vector<Grid> grids(3);
  grids[0] = partners_of(scene, interface, expand(space, box_centre(space)));
  const auto [least, largest] = std::ranges::minmax_element(found);
  if (found.empty() || largest->first - least->first <= round_off * share_of_mean * size)
    return grids;
  grids[1] = partners_of(scene, interface, expand(space, least->second));
  grids[2] = partners_of(scene, interface, expand(space, largest->second));
  return grids;
}

} // namespace

std::vector<NamedFile> files_of_check(const std::string &vtu, const Scene &scene) {
  if (vtu.empty()) return {};
  std::vector<NamedFile> files{{"-vtu", file_beside(vtu, "_mesh")},
                               {"-vtu", file_beside(vtu, "_surface")}};
  for (std::size_t i = 0; i < scene.contacts.size(); ++i)
    for (const char *place : places_in_box)
      files.push_back({"-vtu", partners_file(vtu, scene, i, place)});
  return files;
}

std::vector<std::filesystem::path> write_check(const std::string &vtu, const Problem &problem,
                                               const SerialMesh &mesh) {
  const Scene &scene = problem.scene();
  std::vector<std::filesystem::path> written;
  const auto write = [&](const std::filesystem::path &file, Grid grid) {
    if (grid.cells.empty()) {
      std::filesystem::remove(file); // of an earlier check
      return;
    }
    grid.scene = scene.name;
    write_vtu(file, grid, vtu_format(grid));
    written.push_back(file);
  };
  write(file_beside(vtu, "_mesh"), grid_of(mesh));
  write(file_beside(vtu, "_surface"), grid_of(mesh, surface_of(mesh, scene)));
  for (std::size_t i = 0; i < problem.contact().interfaces.size(); ++i) {
    std::vector<Grid> grids = partners_in_box(problem.scene(), *problem.contact().interfaces[i]);
    for (std::size_t k = 0; k < grids.size(); ++k) {
      grids[k].contacts = {problem.contact().names[i]};
      write(partners_file(vtu, scene, i, places_in_box[k]), grids[k]);
    }
  }
  return written;
}

} // namespace rbvi
