#include "gmsh_file.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/mesh/serial.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <set>

namespace rbvi {

namespace {

std::string quoted(const std::vector<std::string> &names) {
  std::string text;
  for (const std::string &name : names)
    text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

/// Elements of one dimension, each once and with all of its groups, in the order of the file.
struct Elements {
  std::vector<std::array<std::size_t, 4>> nodes; ///< numbers in the file
  std::vector<std::set<int>> groups;
};

Elements elements_of(const GmshFile &file, int dim) {
  std::vector<const GmshElement *> own;
  for (const GmshElement &element : file.elements)
    if (element.dim == dim) own.push_back(&element);
  std::vector<std::array<std::size_t, 4>> sorted;
  for (const GmshElement *element : own) {
    sorted.push_back(element->nodes);
    std::sort(sorted.back().begin(), sorted.back().end(), std::greater<>());
  }
  std::vector<std::size_t> order(own.size()), first(own.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return sorted[i] < sorted[j]; });
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] =
        k > 0 && sorted[order[k]] == sorted[order[k - 1]] ? first[order[k - 1]] : order[k];

  Elements result;
  std::vector<std::size_t> position(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (first[i] == i) {
      position[i] = result.nodes.size();
      result.nodes.push_back(own[i]->nodes);
      result.groups.emplace_back();
    }
    const std::vector<int> &groups = file.groups[own[i]->groups];
    result.groups[position[first[i]]].insert(groups.begin(), groups.end());
  }
  return result;
}

/// The name of a group; without one its number.
std::string name_of(const GmshFile &file, int dim, int number) {
  const auto name = file.names.find({dim, number});
  return name == file.names.end() ? std::to_string(number) : name->second;
}

/// The elements in a group of that name.
std::vector<std::size_t> members(const GmshFile &file, const Elements &elements, int dim,
                                 const std::string &name) {
  std::set<int> wanted;
  for (const std::vector<int> &list : file.groups)
    std::ranges::copy_if(list, std::inserter(wanted, wanted.end()),
                         [&](int group) { return name_of(file, dim, group) == name; });
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < elements.groups.size(); ++i)
    if (std::any_of(elements.groups[i].begin(), elements.groups[i].end(),
                    [&](int group) { return wanted.contains(group); }))
      found.push_back(i);
  return found;
}

/// What elements belong to, each once, by the numbers of the groups.
std::vector<std::string> names_in(const GmshFile &file, int dim, const Elements &elements) {
  std::set<int> numbers;
  for (const std::set<int> &own : elements.groups)
    numbers.insert(own.begin(), own.end());
  std::vector<std::string> names;
  for (const int number : numbers)
    if (std::string name = name_of(file, dim, number);
        std::ranges::find(names, name) == names.end())
      names.push_back(std::move(name));
  return names;
}

/// "'a', '7'"
std::string groups_in(const GmshFile &file, int dim, const Elements &elements) {
  const std::string text = quoted(names_in(file, dim, elements));
  return text.empty() ? "none" : text;
}

/// The vertices of the cells, and where each node of the file is among them.
class Vertices {
public:
  Vertices(const GmshFile &file, const Elements &cells, int dim) : nodes_(file.nodes) {
    std::vector<bool> used(nodes_.size(), false);
    for (const auto &cell : cells.nodes)
      for (int i = 0; i <= dim; ++i)
        used[position(cell[i])] = true;
    int count = 0;
    for (const bool one : used)
      index_.push_back(one ? count++ : -1);
  }
  /// -1 for a node of no cell. Throws bad_input for a number that no node has.
  int operator[](std::size_t number) const { return index_[position(number)]; }
  std::vector<Point> points() const {
    std::vector<Point> result;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (index_[i] >= 0) result.push_back(nodes_[i].point);
    return result;
  }

private:
  std::size_t position(std::size_t number) const {
    const auto node =
        std::lower_bound(nodes_.begin(), nodes_.end(), number,
                         [](const GmshNode &n, std::size_t wanted) { return n.number < wanted; });
    if (node == nodes_.end() || node->number != number)
      throw bad_input("has no node " + std::to_string(number) + ", but an element names it");
    return static_cast<std::size_t>(node - nodes_.begin());
  }
  const std::vector<GmshNode> &nodes_;
  std::vector<int> index_;
};

int dimension_of(const GmshFile &file) {
  int dim = 0;
  for (const GmshElement &element : file.elements)
    dim = std::max(dim, element.dim);
  if (dim < 2) throw bad_input("holds no cells");
  return dim;
}

void check_dimension(const GmshFile &file, const Scene &scene) {
  const int dim = dimension_of(file);
  if (dim != scene.dim)
    throw bad_input("is of dimension " + std::to_string(dim) + ": scene " + scene.name + " needs " +
                    std::to_string(scene.dim));
}

void check_names(const GmshFile &file, const Elements &cells, const Elements &facets,
                 const Scene &scene) {
  std::vector<std::string> regions, boundaries;
  for (const std::string &name : scene.mesh.regions)
    if (members(file, cells, scene.dim, name).empty()) regions.push_back(name);
  for (const std::string &name : scene.mesh.boundaries)
    if (members(file, facets, scene.dim - 1, name).empty()) boundaries.push_back(name);
  if (regions.empty() && boundaries.empty()) return;
  std::string missing;
  if (!regions.empty()) missing = "physical region " + quoted(regions) + " of cells";
  if (!boundaries.empty())
    missing += (missing.empty() ? "" : " and no ") + ("physical boundary " + quoted(boundaries)) +
               " of facets";
  const bool grouped = std::any_of(file.groups.begin(), file.groups.end(),
                                   [](const std::vector<int> &own) { return !own.empty(); });
  throw bad_input("has no " + missing + " (it has: cells in " + groups_in(file, scene.dim, cells) +
                  "; facets in " + groups_in(file, scene.dim - 1, facets) +
                  (grouped ? "" : "; version 2.2 has no groups where Mesh.SaveAll = 1") +
                  "); rbvi -help -case FILE lists what the mesh of a case needs");
}

/// A mesh of the plane lies in one plane z = constant, but for round-off, and then in z = 0.
void flatten(SerialMesh &mesh) {
  const double extent = extent_of(mesh), z = mesh.points.front()[2];
  for (Point &x : mesh.points) {
    if (!(std::abs(x[2] - z) <= 1e-9 * extent))
      throw bad_input("has the vertex (" + short_number(x[0]) + ", " + short_number(x[1]) + ", " +
                      short_number(x[2]) + ") and one at z = " + short_number(z) +
                      ": scenes in two dimensions lie in a plane z = constant");
    x[2] = 0;
  }
}

SerialMesh mesh_of(const GmshFile &file, const Scene &scene) {
  check_dimension(file, scene);
  const int dim = scene.dim;
  const Elements cells = elements_of(file, dim), facets = elements_of(file, dim - 1);
  check_names(file, cells, facets, scene);
  const Vertices vertices(file, cells, dim);
  SerialMesh mesh;
  mesh.dim = dim;
  mesh.points = vertices.points();
  if (dim == 2) flatten(mesh);
  for (const auto &nodes : cells.nodes) {
    std::array<int, 4> cell{-1, -1, -1, -1};
    for (int i = 0; i <= dim; ++i)
      cell[i] = vertices[nodes[i]];
    mesh.cells.push_back(cell);
  }
  orient_cells(dim, mesh.points, mesh.cells);
  for (const std::string &name : scene.mesh.regions)
    for (const std::size_t cell : members(file, cells, dim, name))
      mesh.region[name].push_back(static_cast<int>(cell));
  for (const std::string &name : scene.mesh.boundaries)
    for (const std::size_t member : members(file, facets, dim - 1, name)) {
      std::array<int, 3> facet{-1, -1, -1};
      for (int i = 0; i < dim; ++i) {
        const std::size_t number = facets.nodes[member][i];
        facet[i] = vertices[number];
        if (facet[i] < 0)
          throw bad_input("has '" + name + "' on node " + std::to_string(number) +
                          ", which is in no cell: mesh every surface, and put it in a physical "
                          "group (or set Mesh.SaveAll = 1)");
      }
      std::sort(facet.begin(), facet.end(), std::greater<>());
      mesh.boundary[name].push_back(facet);
    }
  for (auto &[name, own] : mesh.boundary)
    std::sort(own.begin(), own.end());
  return mesh;
}

} // namespace

int dimension_of_gmsh(const std::string &file) {
  return dimension_of(read_gmsh_file(file));
}

std::pair<std::vector<std::string>, std::vector<std::string>> parts_of_gmsh(const std::string &file,
                                                                            int dim) {
  const GmshFile content = read_gmsh_file(file);
  const Elements cells = elements_of(content, dim), facets = elements_of(content, dim - 1);
  std::set<std::size_t> nodes; // of cells
  for (const auto &cell : cells.nodes)
    nodes.insert(cell.begin(), cell.begin() + dim + 1);
  const auto on_cells = [&](std::size_t facet) {
    return std::all_of(facets.nodes[facet].begin(), facets.nodes[facet].begin() + dim,
                       [&](std::size_t node) { return nodes.contains(node); });
  };
  std::pair<std::vector<std::string>, std::vector<std::string>> parts{names_in(content, dim, cells),
                                                                      {}};
  for (std::string &name : names_in(content, dim - 1, facets))
    if (std::ranges::all_of(members(content, facets, dim - 1, name), on_cells))
      parts.second.push_back(std::move(name));
  return parts;
}

SerialMesh read_gmsh(const std::string &file, const Scene &scene) {
  const GmshFile content = read_gmsh_file(file);
  try {
    return mesh_of(content, scene);
  } catch (const Error &error) {
    throw bad_input("mesh file '" + file + "' " + error.what());
  }
}

} // namespace rbvi
