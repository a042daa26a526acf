// The steps from a mesh description to the checked, undistributed mesh, all on one process, and
// the bridge between its plain arrays and DMPlex.
#pragma once

#include "rbvi/element/geometry.hpp"
#include "rbvi/mesh/mesh.hpp"

#include <cmath>
#include <cstdint>

namespace rbvi {

/// Reads a Gmsh file (2.2, 4.0, 4.1; text or binary) with the regions and boundaries of the
/// scene's recipe: the same mesh from each of them. Vertices and cells come by increasing number in
/// the file, nodes of no cell are left out; cells are turned to be positively oriented. Throws
/// bad_input (see make_mesh).
SerialMesh read_gmsh(const std::string &file, const Scene &scene);
/// The largest of its elements. Throws bad_input where there are none.
int dimension_of_gmsh(const std::string &file);
/// The names of its physical groups of cells and of facets on their vertices, in a mesh of that
/// dimension; each once. Throws bad_input.
std::pair<std::vector<std::string>, std::vector<std::string>> parts_of_gmsh(const std::string &file,
                                                                            int dim);

/// The mesh that make_mesh distributes, built in or read, checked and refined. Leaves in `levels`
/// those that it was refined from, where they are not known. Throws bad_input (see make_mesh).
SerialMesh undistributed_mesh(const Scene &scene, const MeshOptions &options,
                              std::vector<SerialMesh> &levels);

/// Every simplex split by DMPlex into 2^dim; regions and boundaries are inherited.
SerialMesh refined(const SerialMesh &mesh);

/// Nodes of the mesh once it is refined so many times, found by counting its edges and triangles:
/// refinement splits each of them in the same way.
std::int64_t nodes_when_refined(const SerialMesh &mesh, int times, int degree);

/// Moves the vertices of each of Scene::curves, of a region those that it shares with the rest,
/// onto it, and those of the rim of the scene's inclusion onto its circle.
void snap_curves(SerialMesh &mesh, const Scene &scene);

/// Throws bad_input, naming `source` and the part, where a vertex of one of Scene::curves is
/// farther than 1e-6 of the extent from it: refinement and contact would move it there.
void check_curves(const SerialMesh &mesh, const Scene &scene, const std::string &source);

/// Moves the vertices of the rim of the scene's inclusion (2D), which are on its circle, outwards
/// by some h^2 / (12 radius), h the length of an edge: as much as gives the polygon the area of the
/// disc. With chords of the circle the energy is that of a smaller inclusion, wrong by O(h^2); so
/// the first variation of the energy vanishes up to the variation of the fields along an edge.
void balance_inclusion(SerialMesh &mesh, const Scene &scene);

/// Throws bad_input, naming `source`: a degenerate or inverted cell (volume <= 1e-12 times its
/// longest edge to the power dim). All that can be wrong with a mesh refined from one that
/// check_mesh passed.
void check_volumes(const SerialMesh &mesh, const std::string &source);

/// The same, and further: two cells on the same side of their common facet, or a facet of a
/// boundary that is on no cell.
void check_mesh(const SerialMesh &mesh, const std::string &source);

/// Throws bad_input, naming `source` and the part, where a vertex of a part is farther than 1e-6 of
/// the extent from the place that the facts of the scene's recipe name.
void check_places(const SerialMesh &mesh, const Scene &scene, const std::string &source);

/// As check_places, and further that the parts are whole. Regions hold every cell in their place,
/// whose rim the mesh fits; boundaries exactly the facets of the surface along theirs; together
/// they are the surface, where the recipe says so; sizes are right; every cell is in a region of a;
/// no facets lie on top of others without common nodes, unless they are a pair's; loads and contact
/// are on the surface. For a mesh
/// that is not refined: a rim that Scene::curves does not have is fitted by the file alone.
void check_facts(const SerialMesh &mesh, const Scene &scene, const std::string &source);

/// The connected part of each cell, from 0 in the order of the cells; cells with a common vertex
/// are connected.
std::vector<int> bodies_of(const SerialMesh &mesh);

/// The longest side of its box, wherever that lies.
double extent_of(const SerialMesh &mesh);

/// Hash of points (to 6e-8 of the mesh's extent: the last digits depend on the processor), cells,
/// regions and boundaries: 16 hex digits.
std::string fingerprint_of(const SerialMesh &mesh);

/// Part (0 .. parts-1) of each cell: METIS, recursive bisection of the graph of cells that share a
/// facet; the same on every run. Throws bad_input if there are fewer cells than parts.
std::vector<int> partition_cells(const SerialMesh &mesh, int parts);

/// Collective. A DMPlex that the first rank holds whole (`mesh` is read there alone): points 0 ..
/// cells-1 are the cells in order, then the vertices in order, then, where it is interpolated,
/// edges and triangles, which takes longer than all else.
Handle<DM> make_plex(MPI_Comm comm, const SerialMesh &mesh, bool interpolated);

/// A facet of a boundary with its cell, of two the first; `dim` vertices, the rest -1.
struct SerialFacet {
  int cell;
  std::array<int, 3> vertices;
};
/// In the order of the boundary, each once. Throws failure for a facet of no cell.
std::vector<SerialFacet> facets_with_cells(const SerialMesh &mesh, const std::string &boundary);

/// Swaps two vertices of the cells with a negative volume: DMPlex has its own order.
void orient_cells(int dim, const std::vector<Point> &points,
                  std::vector<std::array<int, 4>> &cells);

/// Coordinates of the local vertices of a DM, in the order of its vertex points.
std::vector<Point> vertex_points(DM dm);

/// Vertex points of a local cell or facet: dim + 1 or dim of them, the rest -1.
std::array<PetscInt, 4> vertices_of(DM dm, PetscInt point);

inline double distance(const Point &x, const Point &y) {
  return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

} // namespace rbvi
