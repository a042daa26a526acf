// A contact interface on a mesh, evaluated at (mu, state). It owns the entities that its kernels
// see (cells of a region, edges of one or two boundaries, cells beside a boundary) and a dual
// space, and returns the operators of the linearised condition
//
//   B(mu, s) u <= g(mu, s),   lambda >= 0,   and with friction |lambda_tau| <= bound(mu)
//
// on the displacement dofs that it sees (the columns of B). Solvers, sweep, reduction and the
// online solver see operators and laws, never kinds of contact. Serial: whoever holds the
// interface's mesh, a rank or the online program, evaluates it alike.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/locking.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/io/vtu.hpp"
#include "rbvi/method/nodal.hpp"
#include "rbvi/method/node_laws.hpp"

#include <array>
#include <memory>
#include <vector>

namespace rbvi {

/// The entities of an interface with their nodes, in the order of the undistributed mesh: vertices
/// first, then (degree 2) the middles of edges; two boundaries one after the other. Vertices and
/// edges of a boundary come piece by piece, along each from left to right if it is a graph over x,
/// otherwise with the body on the left; those of the first of two boundaries always with the body
/// on the left, of the second with it on the right, so that they run alike where they face each
/// other. An edge itself goes from vertex to vertex with the body on its left.
struct InterfaceMesh {
  int dim = 2, degree = 1;
  int components = 1;        ///< of the displacement
  std::vector<Point> points; ///< of the nodes, reference coordinates
  std::vector<int> entities; ///< nodes of each entity, `per_entity` of them
  int per_entity = 2;
  std::vector<int> edges; ///< cells beside a boundary: the local edge of each that is on it
  std::vector<int> parts; ///< number of nodes of each boundary, or region
  /// Of each piece of each boundary 1 or 0 for its first and for its last end: whether the body
  /// ends there, so that contact may reach it; 1 of a closed curve. Empty: of one piece, nowhere.
  /// Of a surface for each node: 0 on its rim where the surface of the body goes on smoothly.
  std::vector<int> closed_ends = {};
  /// node * components + c: column of B, a contact dof of the problem; -1: fixed, or not seen.
  std::vector<int> dofs;
  Index columns = 0; ///< of the problem
  /// Like `dofs`: the fixed boundary that imposes a value (Cell::imposed_by), -1 elsewhere; empty
  /// where none does.
  std::vector<int> imposed_by = {};
  std::vector<int> materials = {}; ///< of the cell of each entity, or beside it; empty: the first

  Index nodes() const { return static_cast<Index>(points.size()); }
  Index count() const { return static_cast<Index>(entities.size()) / per_entity; }
  /// Of each entity, a cell or a facet; the first of its nodes.
  int vertices() const { return per_entity == nodes_per_cell(dim, degree) ? dim + 1 : dim; }
  int material_of(Index entity) const { return materials.empty() ? 0 : materials[entity]; }
  /// Of a piece, counted over all boundaries.
  std::array<bool, 2> closed(std::size_t piece) const {
    if (closed_ends.empty()) return {};
    return {closed_ends[2 * piece] != 0, closed_ends[2 * piece + 1] != 0};
  }
  const int *nodes_of(Index entity) const { return entities.data() + entity * per_entity; }
};

/// Where multipliers live.
struct DualSpace {
  std::vector<Point> points;   ///< of its nodes, reference coordinates
  std::vector<Index> vertices; ///< its nodes in the mesh; empty where they are none of its nodes
  int components = 1;          ///< multipliers of a node: normal, and with friction tangential ones
  /// Gram matrix of W. Rows: the normal multipliers of all nodes, then the tangential ones.
  SparseMatrix gram;
  Index nodes() const { return static_cast<Index>(points.size()); }
  Index size() const { return nodes() * components; }
};

/// What the condition may depend on beside mu: where the bodies are now, which small deformations
/// ignore, and how far they have slipped before.
struct ContactState {
  /// At the columns of B, beside the motion of the scene and the imposed values; empty: zero.
  Vector displacement{};
  /// The history of friction (contact/history.hpp), of all interfaces: what stacks their operators
  /// takes it into g, an interface does not. Empty: they were at rest.
  Vector slip{};
};

struct ContactOperators {
  SparseMatrix b;       ///< dual x columns
  Vector g;             ///< dual; with what linearisation adds
  Vector weights;       ///< normal multipliers: integral of the basis function, mapped surface
  SparseMatrix nodal_b; ///< the constraint at single nodes, nodal_b u <= nodal_gap
  Vector nodal_gap;
  std::vector<Index> uncovered; ///< multipliers that do not face a partner everywhere
  /// Of two meshes: the slave edges where each part begins and ends that faces one master edge.
  std::vector<Index> segments;
  ContactState state; ///< where they were evaluated, if the interface follows it
};

/// The derivative of B(s)^T lambda by the state s, at the columns: -(S^T E + E^T S).
struct Curvature {
  SparseMatrix s, e; ///< any number of rows each
};

/// At one point: direction . u <= gap, u the displacement without the motion of the scene, with the
/// values that boundaries impose.
struct PointConstraint {
  Point direction;
  double gap;
};

/// Per dual node; empty: all of them.
using WantedNodes = std::vector<bool>;

inline bool is_wanted(const WantedNodes &wanted, Index node) {
  return wanted.empty() || wanted[node];
}

/// What contact pushes a body with at one of the points that it is integrated over.
struct PointForce {
  int part; ///< of the mesh: its boundary
  Point at; ///< on the straight edge, mapped and not displaced
  Point force;
};
using PointForces = std::vector<PointForce>;

class EntitySum;
struct NitscheLayer;

class ContactInterface {
public:
  ContactInterface(const Scene &scene, InterfaceMesh mesh)
      : scene_(scene), mesh_(std::move(mesh)) {}
  virtual ~ContactInterface() = default;
  ContactInterface(const ContactInterface &) = delete;
  ContactInterface &operator=(const ContactInterface &) = delete;

  const InterfaceMesh &mesh() const { return mesh_; }
  const DualSpace &dual() const { return dual_; }
  const MirrorPlanes &mirrors() const { return scene_.mirrors; }
  /// Dual nodes that are fixed in some directions, as on an axis of symmetry: they carry no
  /// tangential traction, which for a symmetric answer is zero there.
  virtual std::vector<Index> partly_fixed() const;
  /// Of each dual node how many of its tangents, from the first, can have a traction along them.
  virtual std::vector<int> free_tangents() const;

  /// All of ContactOperators; by Nitsche's method nodal_b and nodal_gap alone. Rows of dual nodes
  /// that are not wanted may be left zero.
  virtual void assemble(const FullMu &mu, const ContactState &state, const WantedNodes &wanted,
                        ContactOperators &operators) = 0;
  void assemble_all(const FullMu &mu, const ContactState &state, ContactOperators &operators) {
    assemble(mu, state, {}, operators);
  }
  /// At rest, all of them but perhaps B, for less work.
  virtual void assemble_gaps(const FullMu &mu, ContactOperators &operators) {
    assemble_all(mu, {}, operators);
  }
  /// Whether assemble() does leave them zero, for less work. The nodal constraint is then one of
  /// the dual nodes.
  virtual bool can_be_split() const { return false; }
  /// weights, nodal_b and nodal_gap alone, which `outputs` and gaps need; weights that nothing is
  /// multiplied with, where `lambda` is zero, may be left out (empty: all are wanted).
  virtual void assemble_nodal(const FullMu &mu, const ContactState &state,
                              const Vector & /*lambda*/, ContactOperators &operators) {
    assemble_all(mu, state, operators);
  }
  /// Whether B and g depend on the state (large deformations).
  virtual bool follows_state() const { return false; }
  /// Whether it has a curvature; without friction Newton's method is then quadratic.
  virtual bool has_curvature() const { return false; }
  /// Of multipliers at a state. Throws failure where there is none.
  virtual Curvature curvature(const FullMu &mu, const ContactState &state,
                              const Vector &lambda) const;
  /// Whether it has one normal at each point of a curve: what method/nodal.hpp needs.
  virtual bool is_nodal() const { return false; }
  /// That header's A; and the condition at a mu, without B. Only where it is nodal. The interface
  /// must outlive what is returned.
  virtual SparseMatrix averages() const;
  virtual NodalEvaluation nodal_at(const FullMu &mu) const;
  /// Of |lambda_tau| at every node. Throws failure, naming the value, for a negative one.
  virtual FrictionBound bound(const FullMu &mu) const;
  /// The constraint at a point of the reference boundary or region; `mapped`: where h(mu) takes it;
  /// `displacement`: the state there, the imposed values included.
  virtual PointConstraint constraint_at(const FullMu &mu, const Point &x, const Point &mapped,
                                        const Point &displacement) const;
  PointConstraint constraint_at(const FullMu &mu, const Point &x,
                                const Point &displacement = {}) const {
    return constraint_at(mu, x, scene_.map(mu, x), displacement);
  }

  /// The gap that is left, no displacement counts, at every node that cannot move and has no
  /// multiplier, and the size of what it is a difference of.
  virtual std::vector<std::array<double, 2>> held_gaps(const FullMu & /*mu*/) const { return {}; }
  /// The forces that outputs are sums of, on both sides; empty where they are none of points.
  virtual PointForces point_forces(const FullMu & /*mu*/, const ContactState & /*state*/,
                                   const Vector & /*lambda*/) const {
    return {};
  }
  /// B^T lambda at all nodes of the mesh, node * components + c, those that are held included.
  /// Throws failure by Nitsche's method.
  virtual Vector nodal_forces(const FullMu &mu, const ContactState &state,
                              const Vector &lambda) const;

  /// Fills the outputs of contact of the domain, with the numbers of nodes of the whole body:
  /// contact_outputs makes the others the whole's. `operators`: at least those of assemble_nodal,
  /// with the state; `lambda`: a node with at most `least` counts as free.
  virtual void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
                       double least, Outputs &outputs) const = 0;
  /// Outputs::gap_error of an answer, 0 where contact follows the displacement or what is faced is
  /// flat. `u`: as in fields().
  virtual double gap_error(const FullMu & /*mu*/, const Vector & /*u*/,
                           const Vector & /*lambda*/) const {
    return 0;
  }
  /// The mapped interface with its pressure, gap, normal (out of the body; of a membrane in space,
  /// downwards), to_partner, ... `u`: at its nodes, node * components + c, without the motion.
  /// `whole`: what integrals are taken of: also where nothing is faced, without a pressure (gap and
  /// slip are NaN there), and of curves u, gap and slip at the middles of lines as fields of cells,
  /// "u_middle" to "slip_middle".
  virtual Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool whole) = 0;

  /// Separable interfaces: this one, as the sum over its entities. Null: the others.
  virtual const EntitySum *entity_sum() const { return nullptr; }
  /// Nitsche's method: the terms along its curve, the only one of that layer. Null: mixed
  /// interfaces.
  virtual const NitscheLayer *nitsche() const { return nullptr; }

protected:
  /// nodal_b and nodal_gap from constraint_at at the wanted vertices of the dual space, the imposed
  /// values taken into the gap; zero at the others. `mapped`: per node of the mesh that is a
  /// vertex.
  void set_constraints(const FullMu &mu, const std::vector<Point> &mapped,
                       const ContactState &state, const WantedNodes &wanted,
                       ContactOperators &operators) const;

  const Scene &scene_;
  const InterfaceMesh mesh_;
  DualSpace dual_;
};

/// Outputs::gap_error from points: where they touch gaps differ, elsewhere deformed bodies overlap
/// that the answer has apart.
class GapErrors {
public:
  explicit GapErrors(const Vector &pressures)
      : touching_(1e-3 * std::max(0.0, pressures.size() > 0 ? pressures.maxCoeff() : 0.0)) {}
  /// `way`: along the normal; `left`: of the gap by small kinematics; `real`: that of the deformed
  /// bodies.
  void add(double pressure, double way, double left, double real) {
    const bool touches = pressure > touching_;
    error_ = std::max(error_, touches ? std::abs(real - left) : std::min(left, 0.0) - real);
    approach_ = std::max(approach_, std::abs(way));
  }
  double largest() const { return approach_ > 0 ? error_ / approach_ : 0; }

private:
  double touching_, error_ = 0, approach_ = 0;
};

/// u at the columns that a mesh sees, zero at the others, from u at its nodes.
Vector at_columns(const InterfaceMesh &mesh, const Vector &nodal);

/// Points mapped by h(mu): points x dim.
Matrix mapped_points(const Scene &scene, const FullMu &mu, const std::vector<Point> &points);

/// Forces and measures of a pressure without friction: normal_force, contact_measure (the weights
/// of the active nodes), contact_nodes, free_nodes, peak_pressure. `images` of each node, all of
/// which are counted.
void pressure_outputs(const Vector &images, const Vector &weights, const Vector &lambda,
                      double least, Outputs &outputs);

/// Adds gap, normal and to_partner, what leads from each node to the point that it faces: along the
/// normal, or other ways.
void add_gap(const Vector &gap, const std::vector<Point> &normals, Grid &grid,
             const std::vector<Point> &ways = {});

/// motion + u at nodes of the mesh, three components each, for pictures.
Vector moved_nodes(const Scene &scene, const FullMu &mu, const InterfaceMesh &mesh,
                   const Vector &nodal);

} // namespace rbvi
