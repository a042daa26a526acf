// What interfaces along curves share: which meshes are curves, the product of hats, pictures.
#include "../core/refuses.hpp"
#include "curves.hpp"
#include "rbvi/contact/curve.hpp"

#include <gtest/gtest.h>

namespace rbvi::curve_test {
namespace {

/// Two polygons of `degree`, the nodes of one after those of the other.
InterfaceMesh two_curves(int degree) {
  InterfaceMesh mesh = curve_mesh(line(3, 0, 1, 1), degree);
  const InterfaceMesh lower = curve_mesh(line(2, 0, 1, -1), degree);
  mesh.parts = {static_cast<int>(mesh.nodes()), static_cast<int>(lower.nodes())};
  for (const int node : lower.entities)
    mesh.entities.push_back(mesh.parts[0] + node);
  mesh.points.insert(mesh.points.end(), lower.points.begin(), lower.points.end());
  return mesh;
}

/// Whether part 0 or 1 is refused, once changed, in these words.
template <class Change>
testing::AssertionResult refused(int degree, std::size_t part, const std::string &says,
                                 Change change) {
  InterfaceMesh mesh = two_curves(degree);
  change(mesh);
  return refuses(says, [&] { (void)check_curve(mesh, part, "lid"); });
}

TEST(CheckCurve, CountsTheVerticesOfAPart) {
  for (const int degree : {1, 2}) {
    EXPECT_EQ(check_curve(two_curves(degree), 0, "lid"), 4);
    EXPECT_EQ(check_curve(two_curves(degree), 1, "lid"), 3);
  }
}

TEST(CheckCurve, NamesWhatIsNoCurve) {
  using M = InterfaceMesh;
  for (const int degree : {1, 2})
    for (const std::size_t part : {0, 1}) {
      const std::size_t first =
          part == 0 ? 0 : static_cast<std::size_t>(two_curves(degree).parts[0]);
      const std::size_t edge = part == 0 ? 0 : static_cast<std::size_t>(3 * (degree + 1));
      EXPECT_TRUE(refused(degree, part, "the lid is a curve in two dimensions: the mesh has 3",
                          [](M &m) { m.dim = 3; }));
      EXPECT_TRUE(refused(degree, part, "the lid needs at least one edge, but has 1 node of degree",
                          [&](M &m) { m.parts[part] = 1; }));
      EXPECT_TRUE(refused(degree, part, "the lid needs at least one edge, but has 0 nodes",
                          [&](M &m) { m.parts.resize(part); }));
      EXPECT_TRUE(refused(degree, part, "x must increase along the lid, but vertex 2",
                          [&](M &m) { m.points[first + 2][0] = m.points[first + 1][0]; }));
      EXPECT_TRUE(
          refused(degree, part, "vertex 1", [&](M &m) { m.points[first + 1][0] = std::nan(""); }));
      for (std::size_t node = 0; node <= static_cast<std::size_t>(degree); ++node)
        EXPECT_TRUE(refused(degree, part, "edge 0 of the lid",
                            [&](M &m) { m.entities[edge + node] += 1; }));
      EXPECT_TRUE(refused(degree, part, "edge", [&](M &m) { m.entities.resize(edge); }));
      EXPECT_TRUE(refused(degree, part, "edge 0", [](M &m) { m.per_entity = 4; }));
    }
  EXPECT_TRUE(refused(2, 0, "has 6 nodes of degree 2", [](M &m) { m.parts[0] = 6; }));
}

TEST(LinearGram, IsTheMassMatrixOfEachCopy) {
  Random random(3);
  const Curve curve = random_curve(random, 6, 0, 1, 0);
  Matrix mass = Matrix::Zero(7, 7);
  for (Index e = 0; e < 6; ++e)
    mass.block<2, 2>(e, e) += length(curve, e) / 6 * Matrix{{2, 1}, {1, 2}};
  for (const int copies : {1, 2}) {
    const SparseMatrix gram = linear_gram(curve, copies);
    ASSERT_EQ(gram.rows(), 7 * copies);
    for (Index k = 0; k < copies; ++k)
      EXPECT_LE((Matrix(gram).block<7, 7>(7 * k, 7 * k) - mass).norm(), 1e-15);
    EXPECT_NEAR(gram.sum(), copies * length(curve), 1e-14);
    EXPECT_EQ(gram.nonZeros(), copies * (3 * 7 - 2)) << "neighbours of one copy";
    expect_sorted(gram);
  }
}

TEST(Polyline, ShowsMotionAndDisplacementAtTheMappedNodes) {
  Scene scene;
  scene.components = 2;
  scene.map = [](const FullMu &mu, const Point &x) { return Point{mu[0] * x[0], x[1] + 1, 0}; };
  scene.motion = [](const FullMu &mu, const Point &x) { return Point{mu[0], x[0], 0}; };
  InterfaceMesh mesh = two_curves(1);
  mesh.components = 2;
  const Vector u = Vector::LinSpaced(14, 0, 13);
  const std::vector<Index> nodes{1, 2, 3};
  const Grid grid = polyline(scene, {2}, mesh, nodes, u);
  EXPECT_EQ(grid.cells, (std::vector{0, 1, 1, 2}));
  EXPECT_EQ(grid.per_cell, 2);
  ASSERT_EQ(grid.of_nodes.size(), 1U);
  EXPECT_EQ(grid.of_nodes.front().name, "u");
  for (Index k = 0; k < 3; ++k) {
    const Index node = nodes[k];
    const Point &x = mesh.points[node];
    EXPECT_EQ(grid.points(k, 0), 2 * x[0]);
    EXPECT_EQ(grid.points(k, 1), x[1] + 1);
    const Vector moved = grid.of_nodes.front().values.segment<3>(3 * k);
    EXPECT_EQ(moved, Vector({{2 + u[2 * node], x[0] + u[2 * node + 1], 0}}));
  }
}

} // namespace
} // namespace rbvi::curve_test
