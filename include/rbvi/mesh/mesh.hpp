// The reference mesh: built in or read from Gmsh, partitioned by METIS, held by DMPlex, and handed
// to the cell loops as plain arrays.
#pragma once

#include "rbvi/core/scene.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/par/petsc.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rbvi {

/// The undistributed mesh on one process, vertices and cells in natural order.
struct SerialMesh {
  int dim = 2;
  std::vector<Point> points;
  std::vector<std::array<int, 4>> cells; ///< dim + 1 vertices, the rest -1; positively oriented
  std::map<std::string, std::vector<int>> region; ///< cells of each named region
  /// Facets of each named boundary: dim vertices each, the rest -1.
  std::map<std::string, std::vector<std::array<int, 3>>> boundary;
};

/// The undistributed meshes that a mesh was refined from, by their numbers of refinements, before
/// their inclusions are balanced; on the first rank, elsewhere none.
using MeshLevels = std::shared_ptr<const std::vector<SerialMesh>>;

struct MeshOptions {
  std::string file;    ///< Gmsh file; "" for the scene's built-in generator
  int refine = 0;      ///< uniform refinements; vertices of curves are brought back (snap_curves)
  MeshLevels levels{}; ///< of a finer mesh of this file and scene, whose part this one is
};

/// A facet of a cell: owned cell, and which of its facets (facet_cell).
struct CellFacet {
  std::size_t cell;
  int facet;
};

/// A chain of edges of a boundary in two dimensions, from vertex to vertex with the body on the
/// left.
struct CurvePiece {
  std::vector<PetscInt> vertices; ///< natural numbers, each once
  bool loop = false;              ///< the last vertex is followed by the first
  /// At the first and the last vertex, whether the body ends there: its surface turns away, at the
  /// foot of a block or on an axis of symmetry. Where it goes on smoothly, what is beside the
  /// boundary would touch next. A loop has no ends.
  std::array<bool, 2> closed_ends{true, true};
};

/// This rank's part of the mesh: its own cells and their nodes. Nodes are the vertices and, where
/// the displacement of the scene has degree 2, the middles of the edges behind them. Numbers called
/// `natural` are those of the undistributed mesh, the same for any number of ranks.
struct Mesh {
  MPI_Comm comm = MPI_COMM_NULL;
  Handle<DM> dm;
  int dim = 2, degree = 1;
  PetscInt total_vertices = 0, total_cells = 0; ///< of the undistributed mesh
  PetscInt total_nodes = 0;
  std::string fingerprint; ///< hash of the undistributed mesh, 16 hex digits
  MeshLevels levels;       ///< that it was refined from

  std::vector<Point> points;          ///< local nodes, reference coordinates; vertices first
  std::vector<PetscInt> natural_node; ///< per local node; vertices have the lowest numbers
  std::vector<PetscInt> dm_point;     ///< DMPlex point per local node
  std::vector<bool> owned_node;       ///< per local node: each has one owner

  std::vector<std::array<int, 4>> cells;        ///< owned cells: dim + 1 local vertices, rest -1
  std::vector<std::array<int, 6>> cell_middles; ///< degree 2: local nodes of their edges, rest -1
  std::vector<PetscInt> natural_cell;           ///< per owned cell
  std::vector<int> body; ///< per owned cell: which of the connected parts of the mesh it is in
  int bodies = 0;        ///< connected parts, by common vertices

  std::map<std::string, std::vector<bool>> region;       ///< per name: owned cells in it
  std::map<std::string, std::vector<bool>> boundary;     ///< per name: local nodes on it
  std::map<std::string, std::vector<CellFacet>> facets;  ///< per boundary: each has one owner
  std::map<std::string, std::vector<CurvePiece>> curves; ///< per boundary with contact in 2D
  /// Per boundary with contact in 3D: natural numbers of the vertices on its rim beside which the
  /// surface of the body goes on smoothly, rising.
  std::map<std::string, std::vector<PetscInt>> open_rims;
};

/// Local nodes of an owned cell in the order of its kernels' dofs (see Form): nodes_per_cell(dim,
/// degree) numbers, the rest -1.
std::array<int, most_nodes> nodes_of(const Mesh &mesh, std::size_t cell);

/// Unit square [-1/2, 1/2]^2 with a fitted disc of radius 0.2 about its centre (region "obstacle",
/// boundary "boundary"): 3573 nodes, 469 of them in the closed disc, aspect ratios <= 1.55.
/// Deterministic: concentric rings of 6 k nodes in the disc, then 23 rings that turn from the
/// circle into the square.
SerialMesh square_with_disc();

/// That square, disc and names, graded: the finest edges are in the disc about its centre, to
/// 0.65 of its radius, 0.65 of the `circle_edges` equal edges of the circle; outside they are of
/// nearly one length. With 60 edges 3399 nodes, 631 of them in the closed disc. Aspect ratios
/// <= 1.65. Deterministic: concentric rings of 6 k nodes, rings of as many nodes as the circle has,
/// then rings that turn into the square. Throws bad_input unless `circle_edges` is a multiple
/// of 12.
SerialMesh square_with_disc(int circle_edges);

/// Two quarter discs of radius 1, x >= 0. Region "upper": the lower quarter of the disc about
/// (0, 1.5); region "lower": its image by y -> -y, mesh included. Boundaries: "axis" (x = 0), "top"
/// and "bottom" (the flat sides y = 1.5 and y = -1.5), "slave" and "master" (the contact arcs of
/// the upper and of the lower body, from the axis to the polar angle pi/4: 560 equal edges each),
/// "arc" (all of both circles). 6130 nodes, edges from 0.0014 at the contact arc to about 0.1,
/// aspect ratios <= 1.65. Deterministic: rings at growing distances from the contact arc, which
/// turn into the flat side.
SerialMesh two_quarter_discs();

/// These two bodies, regions and boundaries with `edges` equal edges on each contact arc, graded
/// to the corners where the flat sides, which are clamped, meet the circles. Throws bad_input
/// unless there are at least 8.
SerialMesh two_graded_quarter_discs(int edges);

/// Two blocks with meshes that do not match, for patch tests: region "upper" is
/// [0, 1] x [0.25, 0.75], "lower" [0, 1] x [-0.75, -0.25]. Boundaries: "sides" (x = 0 and x = 1),
/// "top", "bottom", "slave" (y = 0.25, 10 edges), "master" (y = -0.25, 7 edges). 106 nodes,
/// irregular spacing, aspect ratios <= 1.9.
SerialMesh two_blocks();

/// Lower half of the disc of radius 1 about the origin, mirrored exactly about x = 0 (coordinates,
/// cells and edges). Region "core": |x| <= 0.6, which the mesh fits. Boundaries: "top" (the flat
/// side y = 0), "contact" (the arc of polar angle -5 pi / 8 to -3 pi / 8, `edges` equal edges),
/// "arc" (the whole half-circle). With the default of 100 edges 787 nodes; edges from
/// pi / (4 `edges`) at the contact arc to about 0.2, aspect ratios <= 1.65, graded to the singular
/// points of the flat side: the corners, and the ends of the core's rim. Deterministic: rings at
/// growing distances from the contact arc, which turn into the core's arc, then rows along the rest
/// of that arc and rings in the core. Throws bad_input unless `edges` is even and >= 8.
SerialMesh half_disc(int edges = 100);

/// The same with the contact arc of polar angle -3 pi / 4 to -pi / 4, for large deformations.
SerialMesh wide_half_disc(int edges = 200);

/// One block for patch tests, [0, 1] x [0, 0.5]. Boundaries: "sides" (x = 0 and x = 1), "top",
/// "contact" (y = 0, 8 edges of four different lengths). 54 nodes, irregular spacing mirrored about
/// x = 1/2, aspect ratios <= 1.9.
SerialMesh one_block();

/// The disc of radius 1 about the origin without the disc of radius 0.3. Boundaries: "rim" (the
/// outer circle), "top" and "bottom" (its arcs within 45 degrees of (0, 1) and (0, -1), `edges`
/// equal edges each), "hub" (the inner circle). Deterministic: rings that coarsen towards the hub.
/// Throws bad_input for fewer than 8 edges.
SerialMesh annulus(int edges = 48);

/// Collective on `comm`. Builds or reads the mesh on the first rank, refines it, partitions the
/// cell graph by METIS (more than one rank) through a shell partitioner, and distributes it. Throws
/// bad_input: file missing or not a Gmsh mesh that is read, regions or boundaries of the scene's
/// recipe not in it, the wrong dimension, cells other than triangles or tetrahedra, elements of
/// order 2, an inverted or degenerate cell, something else than the facts of the recipe say (see
/// check_facts), fewer cells than ranks, refine < 0.
Mesh make_mesh(MPI_Comm comm, const Scene &scene, const MeshOptions &options);

/// Nodes that this mesh would have, from its first level alone, on the first rank. Collective.
/// Throws bad_input as make_mesh does for that level.
PetscInt count_nodes(MPI_Comm comm, const Scene &scene, const MeshOptions &options);

} // namespace rbvi
