#include "rbvi/mesh/serial.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/io/checksum.hpp"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <functional>
#include <iterator>
#include <tuple>

namespace rbvi {

namespace {

/// Facet i of a cell lies opposite to vertex i; its vertices in an order whose parity is that of
/// the cell's orientation, so that two cells on either side of it list opposite parities.
struct OrientedFacet {
  std::array<int, 3> sorted;
  bool even;
  int cell;
  auto key() const { return std::tie(sorted, even); }
};

OrientedFacet facet_of(const SerialMesh &mesh, int cell, int opposite) {
  OrientedFacet facet{{-1, -1, -1}, opposite % 2 == 0, cell};
  std::size_t count = 0;
  for (int i = 0; i <= mesh.dim; ++i)
    if (i != opposite) facet.sorted[count++] = mesh.cells[cell][i];
  // Insertion sort: every exchange of neighbours turns the parity.
  for (std::size_t i = 1; i < count; ++i)
    for (std::size_t j = i; j > 0 && facet.sorted[j] < facet.sorted[j - 1]; --j) {
      std::swap(facet.sorted[j], facet.sorted[j - 1]);
      facet.even = !facet.even;
    }
  return facet;
}

/// `facets`: those of all cells, by increasing vertices.
void check_boundaries(const SerialMesh &mesh, const std::vector<OrientedFacet> &facets,
                      const std::string &source) {
  for (const auto &[name, own] : mesh.boundary)
    for (auto facet : own) {
      std::sort(facet.begin(), facet.end(), std::greater<>()); // the rest, -1, stays last
      std::reverse(facet.begin(), facet.begin() + mesh.dim);
      const auto found = std::lower_bound(
          facets.begin(), facets.end(), facet,
          [](const OrientedFacet &f, const auto &vertices) { return f.sorted < vertices; });
      if (found != facets.end() && found->sorted == facet) continue;
      const Point &x = mesh.points[facet[0]];
      throw bad_input(source + ": a facet of '" + name + "' at (" + std::to_string(x[0]) + ", " +
                      std::to_string(x[1]) +
                      ") is on no cell: the cells beside it must have its nodes");
    }
}

/// Bytes of plain values, one after the other.
template <class T> void append(std::string &bytes, const T &value) {
  bytes.append(reinterpret_cast<const char *>(&value), sizeof value);
}

/// The point at a distance from the centre, on the ray through x.
Point at_distance(double d, const Point &x, const Point &centre) {
  return centre + d / distance(x, centre) * (x - centre);
}

/// Whether each cell is in a region.
std::vector<bool> cells_in(const SerialMesh &mesh, const std::string &region) {
  std::vector<bool> in_region(mesh.cells.size(), false);
  if (mesh.region.contains(region))
    for (const int cell : mesh.region.at(region))
      in_region[cell] = true;
  return in_region;
}

/// Vertices that a region shares with the rest of the mesh.
std::vector<bool> interface_of(const SerialMesh &mesh, const std::string &region) {
  std::vector<bool> inside(mesh.points.size(), false), outside(inside);
  const std::vector<bool> in_region = cells_in(mesh, region);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (int i = 0; i <= mesh.dim; ++i)
      (in_region[c] ? inside : outside)[mesh.cells[c][i]] = true;
  for (std::size_t v = 0; v < inside.size(); ++v)
    inside[v] = inside[v] && outside[v];
  return inside;
}

/// Vertices of a boundary, or of the rim of a region.
std::vector<bool> on_part(const SerialMesh &mesh, const std::string &name) {
  const auto facets = mesh.boundary.find(name);
  if (facets == mesh.boundary.end()) return interface_of(mesh, name);
  std::vector<bool> result(mesh.points.size(), false);
  for (const auto &facet : facets->second)
    for (int i = 0; i < mesh.dim; ++i)
      result[facet[i]] = true;
  return result;
}

/// Edges of triangles that a region shares with the rest of the mesh, each once.
std::vector<std::array<int, 2>> rim_edges(const SerialMesh &mesh, const std::string &region) {
  const std::vector<bool> in_region = cells_in(mesh, region);
  std::vector<std::array<int, 2>> inside, outside, both;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [first, last] = std::minmax(mesh.cells[c][i], mesh.cells[c][(i + 1) % 3]);
      (in_region[c] ? inside : outside).push_back({first, last});
    }
  std::sort(inside.begin(), inside.end());
  std::sort(outside.begin(), outside.end());
  std::set_intersection(inside.begin(), inside.end(), outside.begin(), outside.end(),
                        std::back_inserter(both));
  return both;
}

/// Different sets of vertices among the edges (size 2) or triangles (size 3) of the cells.
template <std::size_t size> std::int64_t count_parts(const SerialMesh &mesh) {
  std::vector<std::array<int, size>> parts;
  const int corners = mesh.dim + 1;
  for (const auto &cell : mesh.cells)
    for (unsigned mask = 0; mask < 1U << corners; ++mask) {
      if (std::popcount(mask) != size) continue;
      std::array<int, size> part{};
      for (std::size_t i = 0, at = 0; i < static_cast<std::size_t>(corners); ++i)
        if ((mask >> i & 1U) != 0) part[at++] = cell[i];
      std::sort(part.begin(), part.end());
      parts.push_back(part);
    }
  std::sort(parts.begin(), parts.end());
  return std::unique(parts.begin(), parts.end()) - parts.begin();
}

} // namespace

double extent_of(const SerialMesh &mesh) {
  double largest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto [low, high] =
        std::ranges::minmax(mesh.points, {}, [c](const Point &x) { return x[c]; });
    largest = std::max(largest, high[c] - low[c]);
  }
  return largest;
}

void check_volumes(const SerialMesh &mesh, const std::string &source) {
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    std::array<Point, 4> vertices{};
    double longest = 0;
    for (int i = 0; i <= mesh.dim; ++i) {
      vertices[i] = mesh.points[mesh.cells[c][i]];
      for (int j = 0; j < i; ++j) {
        longest = std::max(longest, distance(vertices[i], vertices[j]));
      }
    }
    if (!(simplex(mesh.dim, vertices).volume > 1e-12 * std::pow(longest, mesh.dim)))
      throw bad_input(source + ": cell " + std::to_string(c) + " near (" +
                      std::to_string(vertices[0][0]) + ", " + std::to_string(vertices[0][1]) +
                      ") is degenerate or inverted");
  }
}

void check_mesh(const SerialMesh &mesh, const std::string &source) {
  check_volumes(mesh, source);
  std::vector<OrientedFacet> facets;
  for (int cell = 0; cell < static_cast<int>(mesh.cells.size()); ++cell)
    for (int i = 0; i <= mesh.dim; ++i)
      facets.push_back(facet_of(mesh, cell, i));
  std::sort(facets.begin(), facets.end(),
            [](const auto &x, const auto &y) { return x.key() < y.key(); });
  const auto twice =
      std::adjacent_find(facets.begin(), facets.end(),
                         [](const auto &x, const auto &y) { return x.key() == y.key(); });
  if (twice != facets.end())
    throw bad_input(source + ": cells " + std::to_string(twice->cell) + " and " +
                    std::to_string((twice + 1)->cell) +
                    " lie on the same side of their common facet: one of them is inverted");
  check_boundaries(mesh, facets, source);
}

void snap_curves(SerialMesh &mesh, const Scene &scene) {
  const Inclusion &inclusion = scene.mesh.inclusion;
  const std::vector<bool> on_rim = interface_of(mesh, inclusion.region);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (on_rim[v]) mesh.points[v] = at_distance(inclusion.radius, mesh.points[v], inclusion.centre);
  std::vector<bool> moved(mesh.points.size(), false); // where two curves meet, by the first
  for (const auto &[name, curve] : scene.curves) {
    const std::vector<bool> on_curve = on_part(mesh, name);
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
      if (!on_curve[v] || moved[v]) continue;
      mesh.points[v] = curve(mesh.points[v]);
      moved[v] = true;
    }
  }
}

void check_curves(const SerialMesh &mesh, const Scene &scene, const std::string &source) {
  const double tolerance = 1e-6 * extent_of(mesh);
  for (const auto &[name, curve] : scene.curves) {
    const std::vector<bool> on_curve = on_part(mesh, name);
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
      if (!on_curve[v]) continue;
      const Point &x = mesh.points[v];
      if (const double away = distance(curve(x), x); !(away <= tolerance))
        throw bad_input("the vertex (" + short_number(x[0]) + ", " + short_number(x[1]) + ") of '" +
                        name + "' of " + source + " is " + short_number(away) +
                        " away from its circle: correct the circle under curves, or leave it out");
    }
  }
}

void balance_inclusion(SerialMesh &mesh, const Scene &scene) {
  const Inclusion &inclusion = scene.mesh.inclusion;
  if (!mesh.region.contains(inclusion.region)) return;
  // At each vertex the lengths of the halves of its edges, and what the polygon lacks there.
  std::vector<double> length(mesh.points.size(), 0), lacks(length);
  for (const auto &ends : rim_edges(mesh, inclusion.region)) {
    const double chord = distance(mesh.points[ends[0]], mesh.points[ends[1]]);
    const double angle = 2 * std::asin(chord / (2 * inclusion.radius));
    const double segment = inclusion.radius * inclusion.radius * (angle - std::sin(angle)) / 2;
    for (const int v : ends) {
      length[v] += chord / 2;
      lacks[v] += segment / 2;
    }
  }
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (length[v] > 0)
      mesh.points[v] =
          at_distance(inclusion.radius + lacks[v] / length[v], mesh.points[v], inclusion.centre);
}

std::string fingerprint_of(const SerialMesh &mesh) {
  std::string bytes;
  append(bytes, mesh.dim);
  // A power of two, which round-off of the extent leaves as it is (but beside 1.23 2^k): far from
  // the origin all coordinates would tell of it.
  const long long size = std::llround(std::log2(extent_of(mesh)) + 0.2);
  const double scale = std::exp2(24 - static_cast<double>(size));
  for (const Point &x : mesh.points)
    for (const double coordinate : x)
      append(bytes, std::llround(coordinate * scale));
  append(bytes, size);
  for (const auto &cell : mesh.cells)
    append(bytes, cell);
  for (const auto &[name, cells] : mesh.region) {
    bytes += name + '\n';
    for (const int cell : cells)
      append(bytes, cell);
  }
  for (const auto &[name, facets] : mesh.boundary) {
    bytes += name + '\n';
    for (const auto &facet : facets)
      append(bytes, facet);
  }
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx",
                static_cast<unsigned long long>(fnv1a(bytes.data(), bytes.size())));
  return text.data();
}

std::vector<SerialFacet> facets_with_cells(const SerialMesh &mesh, const std::string &boundary) {
  using Vertices = std::array<int, 3>;
  const auto sorted = [](Vertices vertices) {
    std::ranges::sort(vertices);
    return vertices;
  };
  const auto corners = static_cast<std::size_t>(mesh.dim) + 1;
  std::vector<SerialFacet> facets;
  std::map<Vertices, std::size_t> number;
  std::vector<char> on_boundary(mesh.points.size(), 0);
  for (const Vertices &vertices : mesh.boundary.at(boundary)) {
    if (!number.emplace(sorted(vertices), facets.size()).second) continue;
    facets.push_back({-1, vertices});
    for (const int vertex : vertices)
      if (vertex >= 0) on_boundary[vertex] = 1;
  }
  for (std::size_t cell = 0; cell < mesh.cells.size(); ++cell)
    for (std::size_t left_out = 0; left_out < corners; ++left_out) {
      Vertices vertices{-1, -1, -1};
      bool may_be_one = true;
      for (std::size_t i = 0; i + 1 < corners; ++i) {
        vertices[i] = mesh.cells[cell][i < left_out ? i : i + 1];
        may_be_one = may_be_one && on_boundary[vertices[i]] != 0;
      }
      if (!may_be_one) continue;
      const auto found = number.find(sorted(vertices));
      if (found != number.end() && facets[found->second].cell < 0)
        facets[found->second].cell = static_cast<int>(cell);
    }
  if (std::ranges::any_of(facets, [](const SerialFacet &facet) { return facet.cell < 0; }))
    throw failure("a boundary facet is not a facet of any cell of the mesh");
  return facets;
}

std::vector<int> bodies_of(const SerialMesh &mesh) {
  if (mesh.cells.empty()) return {};
  std::vector<int> vertices;
  for (const auto &cell : mesh.cells)
    vertices.insert(vertices.end(), cell.begin(), cell.begin() + mesh.dim + 1);
  const Vector numbers =
      body_numbers(vertices, mesh.dim + 1, std::ssize(mesh.points), vertices.front());
  std::vector<int> result;
  for (const double number : numbers) // from 1
    result.push_back(static_cast<int>(number) - 1);
  return result;
}

std::int64_t nodes_when_refined(const SerialMesh &mesh, int times, int degree) {
  std::int64_t vertices = std::ssize(mesh.points), edges = count_parts<2>(mesh),
               cells = std::ssize(mesh.cells), triangles = mesh.dim == 2 ? 0 : count_parts<3>(mesh);
  for (int level = 0; level < times; ++level) {
    vertices += edges;
    if (mesh.dim == 2) {
      edges = 2 * edges + 3 * cells;
      cells *= 4;
    } else {
      edges = 2 * edges + 3 * triangles + cells;
      triangles = 4 * triangles + 8 * cells;
      cells *= 8;
    }
  }
  return degree == 2 ? vertices + edges : vertices;
}

} // namespace rbvi
