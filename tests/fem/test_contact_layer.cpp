// The cells beside the curve of a rigid support, and what Nitsche's method takes of them: against
// the geometry of the half disk, at any number of ranks.
#include "rbvi/contact/nitsche_curve.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/fem/distributed_contact.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

namespace rbvi::contact_layer_test {
namespace {

constexpr int edges = 8;

struct ContactLayer {
  std::vector<CurveCell> cells;
  std::vector<PetscInt> natural; ///< natural number of each dof of the layer
  Trace trace;
};

struct Disk {
  Scene scene;
  Mesh mesh;
  Dofs dofs;
  explicit Disk(MPI_Comm comm = PETSC_COMM_WORLD,
                const Scene &of = make_scene("rigid_disk", {{"arc_edges", std::to_string(edges)},
                                                            {"formulation", "nitsche"}}))
      : scene(of), mesh(make_mesh(comm, scene, {})), dofs(number_dofs(mesh, 2, scene.fixed)) {}
  ContactLayer layer() const {
    const InterfacePlaces places = place_interfaces(mesh, dofs, scene);
    const auto interface = scene.contacts.front().make(scene, places.meshes.front());
    return {interface->nitsche()->cells, places.natural_dofs, places.trace};
  }
};

/// Local nodes of the edge on the curve, the one with the smaller x first.
struct Ends {
  std::size_t left, right;
  explicit Ends(const CurveCell &cell)
      : left(simplex_edges[cell.edge][0]), right(simplex_edges[cell.edge][1]) {
    if (cell.cell.reference[left][0] > cell.cell.reference[right][0]) std::swap(left, right);
  }
};

/// Dofs of a local node.
std::array<int, 2> dofs_of(const CurveCell &cell, std::size_t node) {
  return {cell.dofs[2 * node], cell.dofs[2 * node + 1]};
}

TEST(ContactLayer, HoldsTheEdgesOfTheArcFromLeftToRight) {
  const ContactLayer layer = Disk().layer();
  ASSERT_EQ(layer.cells.size(), std::size_t{edges});
  for (std::size_t k = 0; k < layer.cells.size(); ++k) {
    const CurveCell &cell = layer.cells[k];
    const Ends ends(cell);
    const double angle = std::numbers::pi / 4 * (static_cast<double>(k) / edges - 0.5);
    EXPECT_NEAR(cell.cell.reference[ends.left][0], std::sin(angle), 1e-15);
    EXPECT_NEAR(cell.cell.reference[ends.left][1], -std::cos(angle), 1e-15);
    EXPECT_EQ(cell.cell.mapped, cell.cell.reference);
    if (k == 0) continue;
    const Ends before(layer.cells[k - 1]);
    EXPECT_EQ(layer.cells[k - 1].cell.reference[before.right], cell.cell.reference[ends.left]);
  }
}

TEST(ContactLayer, CellsLieInTheBodyAndArePositivelyOriented) {
  for (const CurveCell &cell : Disk().layer().cells) {
    EXPECT_GT(simplex(2, cell.cell.reference).volume, 0);
    const std::size_t apex = 3 - Ends(cell).left - Ends(cell).right;
    const Point &x = cell.cell.reference[apex];
    EXPECT_LT(std::hypot(x[0], x[1]), 0.99);
  }
}

TEST(ContactLayer, NeighboursShareTheDofsOfTheirVertexAlone) {
  const ContactLayer layer = Disk().layer();
  for (std::size_t k = 1; k < layer.cells.size(); ++k) {
    const CurveCell &before = layer.cells[k - 1], &cell = layer.cells[k];
    EXPECT_EQ(dofs_of(before, Ends(before).right), dofs_of(cell, Ends(cell).left));
    const std::array<int, 2> first = dofs_of(cell, Ends(cell).left);
    const std::array<int, 2> last = dofs_of(cell, Ends(cell).right);
    EXPECT_EQ(std::set<int>({first[0], first[1], last[0], last[1]}).size(), 4u);
  }
}

/// Every dof of the layer belongs to some cell, and none is fixed: the arc ends below the flat
/// side.
TEST(ContactLayer, DofsAreNumberedWithoutGaps) {
  const ContactLayer layer = Disk().layer();
  std::set<int> used;
  for (const CurveCell &cell : layer.cells)
    used.insert(cell.dofs.begin(), cell.dofs.end());
  ASSERT_EQ(used.size(), layer.natural.size());
  EXPECT_EQ(*used.begin(), 0);
  EXPECT_EQ(*used.rbegin(), static_cast<int>(used.size()) - 1);
  EXPECT_EQ(std::set<PetscInt>(layer.natural.begin(), layer.natural.end()).size(), used.size());
}

/// A field that is linear in x shows at which nodes the dofs of the cells are.
TEST(ContactLayer, TheTraceBringsAFieldToTheNodesOfTheCells) {
  const Disk d;
  const ContactLayer layer = d.layer();
  const auto field = [](const Point &x, int c) { return c == 0 ? 3 + x[0] - 2 * x[1] : x[0] * 5; };
  Vector natural = Vector::Zero(d.dofs.total);
  for (std::size_t v = 0; v < d.mesh.points.size(); ++v)
    for (int c = 0; d.mesh.owned_node[v] && c < 2; ++c)
      natural[2 * d.mesh.natural_node[v] + c] = field(d.mesh.points[v], c);
  MPI_Allreduce(MPI_IN_PLACE, natural.data(), static_cast<int>(natural.size()), MPI_DOUBLE, MPI_SUM,
                d.mesh.comm);
  const Vector u = restrict_to(layer.trace, from_natural(d.dofs, natural).get());
  ASSERT_EQ(static_cast<std::size_t>(u.size()), layer.natural.size());
  for (Index i = 0; i < u.size(); ++i)
    EXPECT_EQ(u[i], natural[layer.natural[i]]);
  const auto between = [](const Point &x, const Point &y) {
    return Point{(x[0] + y[0]) / 2, (x[1] + y[1]) / 2, 0};
  };
  for (const CurveCell &cell : layer.cells) {
    const auto &x = cell.cell.reference;
    const std::array<Point, 6> nodes{
        x[0], x[1], x[2], between(x[0], x[1]), between(x[1], x[2]), between(x[2], x[0])};
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_NEAR(u[cell.dofs[i]], field(nodes[i / 2], static_cast<int>(i % 2)), 1e-14);
  }
}

TEST(ContactLayer, IsBitwiseTheSameOnAnyNumberOfRanks) {
  const ContactLayer many = Disk().layer(), one = Disk(PETSC_COMM_SELF).layer();
  EXPECT_EQ(many.natural, one.natural);
  EXPECT_EQ(many.trace.size, one.trace.size);
  ASSERT_EQ(many.cells.size(), one.cells.size());
  for (std::size_t k = 0; k < one.cells.size(); ++k) {
    EXPECT_EQ(many.cells[k].cell.reference, one.cells[k].cell.reference);
    EXPECT_EQ(many.cells[k].edge, one.cells[k].edge);
    EXPECT_EQ(many.cells[k].dofs, one.cells[k].dofs);
  }
}

TEST(ContactLayer, OfDegreeOneHasDofsAtVerticesAlone) {
  const Scene scene =
      make_scene("patch", {{"bodies", "one"}, {"degree", "1"}, {"formulation", "nitsche"}});
  const ContactLayer layer = Disk(PETSC_COMM_WORLD, scene).layer();
  EXPECT_FALSE(layer.cells.empty());
  for (const CurveCell &cell : layer.cells)
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_EQ(cell.dofs[i] < 0, i >= 6);
}

TEST(ContactLayer, FixedDofsAreLeftOut) {
  Disk d;
  d.dofs = number_dofs(d.mesh, 2, {{"contact", {0}}});
  const ContactLayer layer = d.layer();
  for (const CurveCell &cell : layer.cells)
    for (const std::size_t end : {Ends(cell).left, Ends(cell).right}) {
      EXPECT_EQ(dofs_of(cell, end)[0], -1);
      EXPECT_GE(dofs_of(cell, end)[1], 0);
    }
  const ContactLayer all = Disk().layer();
  EXPECT_EQ(layer.natural.size() + 2 * edges + 1, all.natural.size())
      << "vertices and middles of the edges lose a component";
}

/// The message with which the layer is refused as bad input.
std::string refusal(const Disk &d) {
  try {
    (void)d.layer();
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    return error.what();
  }
  ADD_FAILURE() << "accepted";
  return "";
}

TEST(ContactLayer, NeedsAnEdgeOnTheBoundary) {
  Disk d;
  d.mesh.curves.at("contact").clear();
  EXPECT_NE(refusal(d).find("boundary 'contact'"), std::string::npos);
}

TEST(ContactLayer, IsForTwoDimensions) {
  Disk d;
  d.mesh.dim = 3;
  EXPECT_NE(refusal(d).find("two dimensions"), std::string::npos);
}

} // namespace
} // namespace rbvi::contact_layer_test
