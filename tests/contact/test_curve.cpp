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
  return refuses(says, [&] { (void)curve_shape(mesh, part, "lid"); });
}

TEST(CurveShape, CountsTheVerticesOfAPart) {
  for (const int degree : {1, 2}) {
    EXPECT_EQ(curve_shape(two_curves(degree), 0, "lid").vertices(), 4);
    EXPECT_EQ(curve_shape(two_curves(degree), 1, "lid").vertices(), 3);
  }
}

TEST(CurveShape, NamesWhatIsNoCurve) {
  using M = InterfaceMesh;
  for (const int degree : {1, 2})
    for (const std::size_t part : {0, 1}) {
      const std::size_t edge = part == 0 ? 0 : static_cast<std::size_t>(3 * (degree + 1));
      EXPECT_TRUE(refused(degree, part, "the lid is a curve in two dimensions: the mesh has 3",
                          [](M &m) { m.dim = 3; }));
      EXPECT_TRUE(refused(degree, part, "the lid needs at least one edge, but has 0 nodes",
                          [&](M &m) { m.parts.resize(part); }));
      for (std::size_t node = 0; node <= static_cast<std::size_t>(degree); ++node)
        EXPECT_TRUE(refused(degree, part, "the edges of the lid do not go from vertex to vertex",
                            [&](M &m) { m.entities[edge + node] += 1; }));
      EXPECT_TRUE(refused(degree, part, "edge", [&](M &m) { m.entities.resize(edge); }));
      EXPECT_TRUE(refused(degree, part, "edge", [](M &m) { m.per_entity = 4; }));
    }
  EXPECT_TRUE(refused(2, 0, "of its 6 nodes of degree 2", [](M &m) { m.parts[0] = 6; }));
}

using Edges = std::vector<std::array<int, 2>>;

TEST(CurveShape, FollowsChainsOpenAndClosedInEitherDirection) {
  // Against the direction of their edges, an open piece; a triangle; a single edge.
  const auto [vertices, shape] =
      chained(Edges{{7, 3}, {9, 7}, {2, 9}, {4, 5}, {5, 8}, {8, 4}, {0, 1}});
  EXPECT_EQ(vertices, (std::vector{3, 7, 9, 2, 4, 5, 8, 0, 1}));
  ASSERT_EQ(shape.pieces.size(), 3U);
  EXPECT_FALSE(shape.pieces[0].loop || shape.pieces[2].loop);
  EXPECT_TRUE(shape.pieces[1].loop);
  EXPECT_EQ(shape.vertices(), 9);
  using Ends = std::vector<std::array<Index, 2>>;
  EXPECT_EQ(shape.ends, (Ends{{0, 1}, {1, 2}, {2, 3}, {4, 5}, {5, 6}, {6, 4}, {7, 8}}));
  EXPECT_EQ(shape.node(5, 2), 14) << "middles behind all vertices";
}

TEST(LinearGram, DoesNotJoinPieces) {
  const auto shape = chained(Edges{{0, 1}, {2, 3}, {3, 4}, {4, 2}}).shape;
  const Curve points{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {3, 1, 0}, {2, 2, 0}};
  const Matrix gram = linear_gram(points, shape, 1);
  EXPECT_EQ(gram(1, 2), 0);
  EXPECT_NEAR(gram.row(1).sum(), 1, 1e-15);
  EXPECT_NEAR(gram(2, 4), 1.0 / 6, 1e-15) << "closed";
  EXPECT_NEAR(gram.sum(), 2 + 2 + std::sqrt(2), 1e-15);
}

TEST(LinearGram, IsTheMassMatrixOfEachCopy) {
  Random random(3);
  const Curve curve = random_curve(random, 6, 0, 1, 0);
  Matrix mass = Matrix::Zero(7, 7);
  for (Index e = 0; e < 6; ++e)
    mass.block<2, 2>(e, e) += length(curve, e) / 6 * Matrix{{2, 1}, {1, 2}};
  for (const int copies : {1, 2}) {
    const SparseMatrix gram = linear_gram(
        curve, chained(Edges{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}}).shape, copies);
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
  const std::vector<Index> nodes{1, 2};
  const Grid grid = polyline(scene, {2}, mesh, {{1, 0}, {2, 0}, {1, 0.25}}, {0, 2, 2, 1}, u);
  EXPECT_EQ(grid.cells, (std::vector{0, 2, 2, 1}));
  EXPECT_EQ(grid.per_cell, 2);
  ASSERT_EQ(grid.of_nodes.size(), 1U);
  EXPECT_EQ(grid.of_nodes.front().name, "u");
  const auto at_node = [&](Index k) -> Vector {
    return grid.of_nodes.front().values.segment<3>(3 * k);
  };
  EXPECT_NEAR((at_node(2) - 0.75 * at_node(0) - 0.25 * at_node(1)).norm(), 0, 1e-14);
  EXPECT_NEAR((grid.points.row(2) - 0.75 * grid.points.row(0) - 0.25 * grid.points.row(1)).norm(),
              0, 1e-14);
  for (Index k = 0; k < 2; ++k) {
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
