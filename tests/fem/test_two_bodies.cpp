// Dirichlet conditions by component and the two contact curves: against the geometry of the quarter
// discs, at any number of ranks.
#include "rbvi/contact/curve.hpp"
#include "rbvi/contact/pair.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/fem/distributed_contact.hpp"
#include "rbvi/par/collective.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <set>

namespace rbvi::two_bodies_test {
namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

struct Discs {
  Scene scene;
  Mesh mesh;
  Dofs dofs;
  explicit Discs(MPI_Comm comm = PETSC_COMM_WORLD, int refine = 0, const std::string &degree = "1")
      : scene(make_scene("two_disks", {{"degree", degree}})),
        mesh(make_mesh(comm, scene, {"", refine})), dofs(number_dofs(mesh, 2, scene.fixed)) {}
};

/// The curves of the pair of a scene.
struct ContactCurves {
  Index slave_nodes;
  std::vector<PetscInt> natural_node;
  std::vector<Point> points;
  Trace trace;
};

ContactCurves curves_of(const Mesh &mesh, const Dofs &dofs, const Scene &scene) {
  const InterfacePlaces places = place_interfaces(mesh, dofs, scene);
  const InterfaceMesh &curves = places.meshes.front();
  EXPECT_EQ(curves.parts.size(), 2U);
  for (std::size_t i = 0; i < curves.points.size(); ++i) {
    EXPECT_EQ(curves.dofs[2 * i], -1) << "the pair sees vertical displacements alone";
    EXPECT_EQ(curves.dofs[2 * i + 1], static_cast<int>(i));
  }
  return {curves.parts[0], places.natural_nodes.front(), curves.points, places.trace};
}

bool on_axis(const Point &x) {
  return x[0] == 0;
}

bool on_flat_side(const Point &x) {
  return std::abs(x[1]) == 1.5;
}

/// The message with which `work` is refused as bad input.
std::string refusal(const std::function<void()> &work) {
  try {
    work();
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    return error.what();
  }
  ADD_FAILURE() << "accepted";
  return "";
}

#define EXPECT_CONTAINS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST(FixedComponents, TheAxisHoldsXAndTheFlatSidesBoth) {
  const Discs d;
  for (std::size_t v = 0; v < d.mesh.points.size(); ++v) {
    const Point &x = d.mesh.points[v];
    EXPECT_EQ(d.dofs.free[2 * v] < 0, on_axis(x) || on_flat_side(x)) << x[0] << " " << x[1];
    EXPECT_EQ(d.dofs.free[2 * v + 1] < 0, on_flat_side(x)) << x[0] << " " << x[1];
  }
}

TEST(FixedComponents, AreCountedOnceWhereBoundariesMeet) {
  const Discs d;
  const SerialMesh serial = two_quarter_discs();
  PetscInt axis = 0, flat = 0, both = 0;
  for (const Point &x : serial.points) {
    axis += on_axis(x);
    flat += on_flat_side(x);
    both += on_axis(x) && on_flat_side(x);
  }
  EXPECT_EQ(both, 2);
  EXPECT_GT(axis, 20);
  EXPECT_GT(flat, 20);
  EXPECT_EQ(d.dofs.total, 2 * 6130);
  EXPECT_EQ(d.dofs.total_free, d.dofs.total - axis - 2 * flat + both);
  EXPECT_EQ(static_cast<PetscInt>(gather_all(d.mesh.comm, d.dofs.natural_owned, MPIU_INT).size()),
            d.dofs.total_free);
}

/// Rank after rank, each owner numbers its free dofs without gaps, and every ghost knows the number
/// that its owner gave, whichever of its components are fixed.
TEST(FixedComponents, GhostsHaveTheRowsOfTheirOwners) {
  const Discs d;
  const std::vector<PetscInt> natural_of_row =
      gather_all(d.mesh.comm, d.dofs.natural_owned, MPIU_INT);
  EXPECT_EQ(std::set<PetscInt>(natural_of_row.begin(), natural_of_row.end()).size(),
            natural_of_row.size());
  int ghosts = 0, ranks = 1;
  for (std::size_t v = 0; v < d.mesh.points.size(); ++v)
    for (std::size_t c = 0; c < 2; ++c) {
      const PetscInt row = d.dofs.free[2 * v + c];
      if (row < 0) continue;
      EXPECT_EQ(natural_of_row.at(row), 2 * d.mesh.natural_node[v] + static_cast<PetscInt>(c));
      const bool owned =
          row >= d.dofs.first_free &&
          row < d.dofs.first_free + static_cast<PetscInt>(d.dofs.natural_owned.size());
      EXPECT_EQ(owned, d.mesh.owned_node[v]);
      ghosts += owned ? 0 : 1;
    }
  MPI_Allreduce(MPI_IN_PLACE, &ghosts, 1, MPI_INT, MPI_SUM, d.mesh.comm);
  MPI_Comm_size(d.mesh.comm, &ranks);
  EXPECT_TRUE(ranks != 2 || ghosts == 0) << "each rank has one body";
  EXPECT_TRUE(ranks < 3 || ghosts > 0);
}

TEST(FixedComponents, NoListMeansAllAndTheOrderDoesNotMatter) {
  const Discs d;
  const Dofs listed = number_dofs(d.mesh, 2, {{"bottom", {1, 0}}, {"axis", {0}}, {"top", {0, 1}}});
  EXPECT_EQ(listed.free, d.dofs.free);
  const Dofs none = number_dofs(d.mesh, 2, {});
  EXPECT_EQ(none.total_free, none.total);
}

TEST(FixedComponents, OthersThanTheDisplacementHasAreRefused) {
  const Discs d;
  for (const int component : {-1, 2}) {
    const std::string message = refusal([&] {
      (void)number_dofs(d.mesh, 2, {{"top", {}}, {"axis", {component}}});
    });
    EXPECT_CONTAINS(message, "axis");
    EXPECT_CONTAINS(message, std::to_string(component));
  }
}

TEST(ContactCurves, HoldTheArcsFromTheAxisOutwards) {
  for (const int refine : {0, 1}) {
    const Discs d(PETSC_COMM_WORLD, refine);
    const ContactCurves curves = curves_of(d.mesh, d.dofs, d.scene);
    const Index nodes = (560 << refine) + 1;
    ASSERT_EQ(curves.slave_nodes, nodes);
    ASSERT_EQ(curves.points.size(), at(2 * nodes));
    ASSERT_EQ(curves.natural_node.size(), at(2 * nodes));
    for (Index i = 0; i < nodes; ++i) {
      const double angle = std::numbers::pi / 4 * static_cast<double>(i) / (560 << refine);
      const Point &slave = curves.points[i], &master = curves.points[nodes + i];
      EXPECT_NEAR(slave[0], std::sin(angle), 1e-14);
      EXPECT_NEAR(slave[1], 1.5 - std::cos(angle), 1e-14);
      EXPECT_NEAR(master[0], slave[0], 1e-15);
      EXPECT_NEAR(master[1], -slave[1], 1e-15);
      if (i == 0) continue;
      EXPECT_LT(curves.points[at(i) - 1][0], slave[0]);
      EXPECT_LT(curves.points[at(nodes + i) - 1][0], master[0]);
    }
  }
}

/// With straight edges of the mesh: the middles are brought onto the circle, the dofs are theirs.
TEST(ContactCurves, OfDegreeTwoHaveMiddlesOnTheCircle) {
  for (const int refine : {0, 1}) {
    const Discs d(PETSC_COMM_WORLD, refine, "2");
    const ContactCurves curves = curves_of(d.mesh, d.dofs, d.scene);
    const Index edges = 140 << refine, nodes = 2 * edges + 1;
    ASSERT_EQ(curves.slave_nodes, nodes);
    ASSERT_EQ(curves.points.size(), at(2 * nodes));
    for (Index i = 0; i < nodes; ++i) {
      const double part = i <= edges ? double(i) : double(i - edges) - 0.5;
      const double angle = std::numbers::pi / 4 * part / double(edges);
      const Point &slave = curves.points[i], &master = curves.points[nodes + i];
      EXPECT_NEAR(slave[0], std::sin(angle), 1e-14);
      EXPECT_NEAR(slave[1], 1.5 - std::cos(angle), 1e-14);
      EXPECT_NEAR(master[0], slave[0], 1e-15);
      EXPECT_NEAR(master[1], -slave[1], 1e-15);
      EXPECT_EQ(curves.natural_node[i] < d.mesh.total_vertices, i <= edges);
    }
    EXPECT_EQ(curves.trace.size, 2 * nodes);
  }
}

/// The field with the value k at natural dof k shows which dofs the trace takes.
TEST(ContactCurves, TheTraceIsTheVerticalDisplacement) {
  const Discs d;
  const ContactCurves curves = curves_of(d.mesh, d.dofs, d.scene);
  const Vector numbers = Vector::LinSpaced(d.dofs.total, 0, static_cast<double>(d.dofs.total - 1));
  const Vector trace = restrict_to(curves.trace, from_natural(d.dofs, numbers).get());
  ASSERT_EQ(trace.size(), 2 * 561);
  for (Index i = 0; i < trace.size(); ++i)
    EXPECT_EQ(trace[i], 2 * curves.natural_node[i] + 1);
}

TEST(ContactCurves, AreTheSameOnAnyNumberOfRanks) {
  const Discs world, alone(PETSC_COMM_SELF);
  const ContactCurves many = curves_of(world.mesh, world.dofs, world.scene);
  const ContactCurves one = curves_of(alone.mesh, alone.dofs, alone.scene);
  EXPECT_EQ(many.slave_nodes, one.slave_nodes);
  EXPECT_EQ(many.natural_node, one.natural_node);
  EXPECT_EQ(many.points, one.points);
  Vector field(alone.dofs.total);
  for (Index i = 0; i < field.size(); ++i)
    field[i] = std::sin(static_cast<double>(i));
  EXPECT_EQ(restrict_to(many.trace, from_natural(world.dofs, field).get()),
            restrict_to(one.trace, from_natural(alone.dofs, field).get()));
  EXPECT_EQ(at(many.trace.size), many.points.size());
}

TEST(ContactCurves, MayBeHeldSidewaysButNotVertically) {
  const Discs d;
  for (const std::string name : {"slave", "master"}) {
    const auto curves_where = [&](int fixed) {
      std::vector<FixedBoundary> conditions = d.scene.fixed;
      conditions.push_back({name, {fixed}});
      return curves_of(d.mesh, number_dofs(d.mesh, 2, conditions), d.scene);
    };
    EXPECT_EQ(curves_where(0).points.size(), 2U * 561U);
    const std::string message = refusal([&] { (void)curves_where(1); });
    EXPECT_CONTAINS(message, "displacement is fixed on the contact curve");
    EXPECT_CONTAINS(message, "'" + name + "'");
  }
}

TEST(ContactCurves, NeedAnEdge) {
  Discs d;
  d.mesh.curves.at("master").clear();
  EXPECT_CONTAINS(refusal([&] { (void)curves_of(d.mesh, d.dofs, d.scene); }),
                  "'master' has no edge");
}

/// Both upright sides of two blocks, against the foot of the upper one.
TEST(ContactCurves, MayBeUprightAndInSeveralPieces) {
  Scene scene = make_scene("patch", {{"degree", "2"}});
  scene.contacts = {two_bodies({"slave", "sides", {}})};
  const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {});
  const InterfacePlaces places = place_interfaces(mesh, number_dofs(mesh, 2, {}), scene);
  const InterfaceMesh &curves = places.meshes.front();
  const CurveShape sides = curve_shape(curves, 1, "sides");
  EXPECT_EQ(sides.pieces.size(), 4U);
  EXPECT_EQ(curves.closed_ends.size(), 2U + 8U);
  for (const CurveChain &piece : sides.pieces) { // the body is on the right
    const auto x = [&](Index k) { return curves.points[curves.parts[0] + piece.first_vertex + k]; };
    for (Index k = 0; k < piece.edges; ++k) {
      EXPECT_EQ(x(k)[0], x(k + 1)[0]) << "upright";
      EXPECT_EQ(x(k)[1] < x(k + 1)[1], x(k)[0] < 0.5);
    }
  }
}

TEST(ContactCurves, AreForTwoDimensions) {
  Discs d;
  d.mesh.dim = 3;
  EXPECT_CONTAINS(refusal([&] { (void)curves_of(d.mesh, d.dofs, d.scene); }), "two dimensions");
}

} // namespace
} // namespace rbvi::two_bodies_test
