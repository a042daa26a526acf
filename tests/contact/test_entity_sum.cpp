// Interfaces that are sums over their entities: against dense sums, with dofs that are not seen,
// and an obstacle against closed forms.
#include "../core/refuses.hpp"
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/contact/support_outputs.hpp"
#include "support_scenes.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

namespace rbvi::entity_sum_test {
namespace {

/// A scalar membrane over psi = height(mu, x), stretched by mu[0] along x.
Scene membrane(Obstacle over) {
  Scene scene;
  scene.name = "toy";
  scene.parameters.all = {{"stretch", "", 0, 2, 1}};
  scene.map = [](const FullMu &mu, const Point &x) { return Point{mu[0] * x[0], x[1], 0}; };
  scene.contacts = {obstacle(std::move(over))};
  return scene;
}

/// The unit square in n x n squares of two triangles; every node has the column of its number.
InterfaceMesh square(int n) {
  InterfaceMesh mesh;
  mesh.per_entity = 3;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      mesh.points.push_back({static_cast<double>(i) / n, static_cast<double>(j) / n, 0});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int k = j * (n + 1) + i;
      mesh.entities.insert(mesh.entities.end(), {k, k + 1, k + n + 2, k, k + n + 2, k + n + 1});
    }
  mesh.parts = {static_cast<int>(mesh.nodes())};
  mesh.columns = mesh.nodes();
  for (int i = 0; i < mesh.columns; ++i)
    mesh.dofs.push_back(i);
  return mesh;
}

/// The same with the middles of all edges behind the vertices.
InterfaceMesh quadratic_square(int n) {
  InterfaceMesh linear = square(n), mesh = linear;
  mesh.degree = 2;
  mesh.per_entity = 6;
  mesh.entities.clear();
  std::map<std::pair<int, int>, int> middles;
  for (Index e = 0; e < linear.count(); ++e) {
    const int *v = linear.nodes_of(e);
    mesh.entities.insert(mesh.entities.end(), v, v + 3);
    for (int k = 0; k < 3; ++k) {
      const auto [at, is_new] =
          middles.emplace(std::minmax(v[k], v[(k + 1) % 3]), static_cast<int>(mesh.nodes()));
      mesh.entities.push_back(at->second);
      if (!is_new) continue;
      const Point &a = linear.points[v[k]], &b = linear.points[v[(k + 1) % 3]];
      mesh.points.push_back({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0});
    }
  }
  mesh.parts = {static_cast<int>(mesh.nodes())};
  mesh.columns = mesh.nodes();
  mesh.dofs.resize(mesh.points.size());
  std::iota(mesh.dofs.begin(), mesh.dofs.end(), 0);
  return mesh;
}

/// Every third dof is not seen, the others are numbered backwards among more columns.
InterfaceMesh partly_seen(InterfaceMesh mesh) {
  mesh.columns += 5;
  for (int i = 0; i < static_cast<int>(mesh.dofs.size()); ++i)
    mesh.dofs[i] = i % 3 == 1 ? -1 : static_cast<int>(mesh.columns) - 1 - i;
  return mesh;
}

double quadratic(const FullMu &mu, const Point &x) {
  return 0.3 - mu[0] * x[0] * x[0] + 2 * x[0] * x[1];
}

/// What the entities add, one after the other.
struct Sum {
  Matrix b;
  Vector g, weights;
  Sum(const Scene &scene, const EntitySum &interface, const FullMu &mu)
      : b(Matrix::Zero(interface.dual().size(), interface.mesh().columns)),
        g(Vector::Zero(b.rows())), weights(Vector::Zero(interface.dual().nodes())) {
    for (Index e = 0; e < interface.mesh().count(); ++e) {
      Cell entity = interface.reference_entity(e);
      for (std::size_t i = 0; i <= static_cast<std::size_t>(interface.entity_dim()); ++i)
        entity.mapped[i] = scene.map(mu, entity.reference[i]);
      EntityValues values = interface.shape();
      interface.integrate(mu, entity, values);
      interface.weigh(mu, entity, values);
      const auto rows = interface.rows_of(e);
      const std::vector<Index> columns = interface.columns_of(e);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto row = static_cast<Index>(i);
        if (rows[i] < 0) continue;
        g[rows[i]] += values.g[row];
        for (std::size_t j = 0; j < columns.size(); ++j)
          if (columns[j] >= 0) b(rows[i], columns[j]) += values.b(row, static_cast<Index>(j));
      }
      for (Index i = 0; i < values.weights.size(); ++i)
        if (const Index row = rows[i]; row >= 0) weights[row] += values.weights[i];
    }
  }
};

/// Assembled twice into the same operators, at one mu and then at another.
void expect_sum(const Scene &scene, const InterfaceMesh &mesh) {
  const auto interface = scene.contacts.front().make(scene, mesh);
  ASSERT_NE(interface->entity_sum(), nullptr);
  ContactOperators operators, nodal;
  for (const FullMu &mu : {FullMu{0.8}, FullMu{1.3}}) {
    interface->assemble_all(mu, {}, operators);
    const Sum sum(scene, *interface->entity_sum(), mu);
    EXPECT_LE((Matrix(operators.b) - sum.b).norm(), 1e-15 * sum.b.norm());
    EXPECT_LE((operators.g - sum.g).norm(), 1e-15 * sum.g.norm());
    EXPECT_LE((operators.weights - sum.weights).norm(), 1e-15 * sum.weights.norm());
    EXPECT_TRUE(operators.uncovered.empty());
    expect_sorted(operators.b);
    interface->assemble_nodal(mu, {}, {}, nodal);
    EXPECT_EQ(nodal.weights, operators.weights);
    EXPECT_EQ(Matrix(nodal.nodal_b), Matrix(operators.nodal_b));
    EXPECT_EQ(nodal.nodal_gap, operators.nodal_gap);
    Vector lambda =
        Vector::Zero(interface->dual().size()); // weights are wanted where it is not zero
    lambda[1] = 3;
    interface->assemble_nodal(mu, {}, lambda, nodal);
    EXPECT_EQ(nodal.weights[1], operators.weights[1]);
    EXPECT_EQ(nodal.nodal_gap, operators.nodal_gap);
  }
}

TEST(EntitySum, IsTheSumOverTheCellsOfARegion) {
  for (const bool lumped : {false, true}) {
    const Scene scene = membrane({"region", quadratic, lumped});
    expect_sum(scene, square(3));
    expect_sum(scene, partly_seen(square(3)));
    expect_sum(scene, quadratic_square(3));
    expect_sum(scene, partly_seen(quadratic_square(3)));
  }
}

TEST(EntitySum, IsTheSumOverTheEdgesOfACurve) {
  Random random(1);
  const Curve vertices = random_curve(random, 7, -0.5, 0.8, -0.3);
  for (const int degree : {1, 2})
    for (const bool friction : {true, false}) {
      SupportScene scene = crooked(degree);
      if (!friction) scene.support.friction = {};
      scene.contacts = {rigid_support(scene.support)};
      expect_sum(scene, support_curve(vertices, degree));
      expect_sum(scene, partly_seen(support_curve(vertices, degree)));
    }
}

/// Of nodes that are wanted, from the entities that see them alone; zero elsewhere.
TEST(EntitySum, RowsThatAreWantedAreThoseOfTheWhole) {
  const auto expect_rows = [](const Scene &scene, const InterfaceMesh &mesh) {
    const auto interface = scene.contacts.front().make(scene, mesh);
    ASSERT_TRUE(interface->can_be_split());
    const Index nodes = interface->dual().nodes(), tangents = interface->dual().components - 1;
    ContactOperators whole, part;
    interface->assemble_all({0.8}, {}, whole);
    for (const Index step : {2, 3, 5}) { // other rows each time
      WantedNodes wanted;
      for (Index i = 0; i < nodes; ++i)
        wanted.push_back(i % step == 1);
      interface->assemble({0.8}, {}, wanted, part);
      for (Index i = 0; i < nodes; ++i) {
        const double seen = i % step == 1 ? 1 : 0;
        const auto expect_row = [&](Index row) {
          EXPECT_EQ(Matrix(part.b.row(row)), Matrix(seen * whole.b.row(row)));
          EXPECT_EQ(part.g[row], seen * whole.g[row]);
        };
        expect_row(i);
        for (Index k = 0; k < tangents; ++k)
          expect_row(nodes + i * tangents + k);
        EXPECT_EQ(part.weights[i], seen * whole.weights[i]);
        EXPECT_EQ(Matrix(part.nodal_b.row(i)), Matrix(seen * whole.nodal_b.row(i)));
        EXPECT_EQ(part.nodal_gap[i], seen * whole.nodal_gap[i]);
      }
    }
  };
  const Scene scene = membrane({"region", quadratic});
  expect_rows(scene, quadratic_square(4));
  Random random(1);
  SupportScene curve = crooked(2);
  curve.contacts = {rigid_support(curve.support)};
  expect_rows(curve, support_curve(random_curve(random, 9, -0.5, 0.8, -0.3), 2));
}

/// The same mesh with nodes that are fixed.
template <class IsFixed> InterfaceMesh with_fixed(InterfaceMesh mesh, IsFixed &&is_fixed) {
  for (Index node = 0; node < mesh.nodes(); ++node)
    for (int c = 0; c < mesh.components; ++c)
      if (is_fixed(mesh.points[node])) mesh.dofs[node * mesh.components + c] = -1;
  return mesh;
}

/// Hats -> dual functions: those of vertices that move, that of a fixed one added to `beside` it.
Matrix joined(const DualSpace &dual, Index vertices, const std::map<Index, Index> &beside) {
  const Index tangents = dual.components - 1;
  Matrix sum = Matrix::Zero(dual.size(), vertices * dual.components);
  for (Index v = 0; v < vertices; ++v) {
    const auto found = beside.find(v);
    const auto at = std::ranges::find(dual.vertices, found == beside.end() ? v : found->second);
    if (at == dual.vertices.end()) continue;
    const Index i = at - dual.vertices.begin();
    sum(i, v) = 1;
    for (Index k = 0; k < tangents; ++k)
      sum(dual.nodes() + i * tangents + k, vertices + v * tangents + k) = 1;
  }
  return sum;
}

/// Of interfaces on `all` and, with some of its nodes fixed, on `held`: B, g, the weights and the
/// Gram matrix are sums of the rows of hats; the nodal constraint is one of vertices that move.
void expect_joined(const Scene &scene, const InterfaceMesh &all, const InterfaceMesh &held,
                   const std::map<Index, Index> &beside) {
  const auto whole = scene.contacts.front().make(scene, all),
             part = scene.contacts.front().make(scene, held);
  const DualSpace &hats = whole->dual(), &dual = part->dual();
  const Matrix sum = joined(dual, hats.nodes(), beside);
  ContactOperators of_hats, op;
  whole->assemble_all({0.8}, {}, of_hats);
  part->assemble_all({0.8}, {}, op);
  Matrix expected = sum * of_hats.b;
  for (std::size_t k = 0; k < held.dofs.size(); ++k)
    if (held.dofs[k] < 0) expected.col(static_cast<Index>(k)).setZero();
  EXPECT_LE((Matrix(op.b) - expected).norm(), 1e-15);
  EXPECT_LE((op.g - sum * of_hats.g).norm(), 1e-15);
  EXPECT_LE((op.weights - sum.topLeftCorner(dual.nodes(), hats.nodes()) * of_hats.weights).norm(),
            1e-15);
  EXPECT_LE((Matrix(dual.gram) - sum * hats.gram * sum.transpose()).norm(), 1e-15);
  ASSERT_EQ(op.nodal_b.rows(), dual.nodes());
  for (Index i = 0; i < dual.nodes(); ++i) {
    const Index vertex = dual.vertices[i];
    EXPECT_EQ(Matrix(op.nodal_b.row(i)), Matrix(of_hats.nodal_b.row(vertex)));
    EXPECT_EQ(op.nodal_gap[i], of_hats.nodal_gap[vertex]);
  }
}

TEST(EntitySum, TheFunctionOfAFixedVertexJoinsThatBesideIt) {
  const Scene scene = membrane({"region", quadratic});
  const auto on_the_left = [](const Point &x) { return x[0] < 0.01; };
  const std::map<Index, Index> to_the_right{{0, 1}, {4, 5}, {8, 9}, {12, 13}};
  for (const InterfaceMesh &mesh : {square(3), quadratic_square(3)}) {
    const InterfaceMesh held = with_fixed(mesh, on_the_left);
    expect_joined(scene, mesh, held, to_the_right);
    expect_sum(scene, held);
  }
  Random random(1);
  const Curve vertices = random_curve(random, 7, -0.5, 0.8, -0.3);
  for (const int degree : {1, 2}) { // normal and tangential functions
    SupportScene clamped = crooked(degree);
    clamped.contacts = {rigid_support(clamped.support)};
    const InterfaceMesh mesh = support_curve(vertices, degree);
    const InterfaceMesh held = with_fixed(
        mesh, [&](const Point &x) { return x == vertices.front() || x == vertices.back(); });
    expect_joined(clamped, mesh, held, {{0, 1}, {7, 6}});
    expect_sum(clamped, held);
  }
}

/// A function of vertex quadrature acts on its own vertex alone.
TEST(EntitySum, WithVertexQuadratureItIsLeftOut) {
  const Scene scene = membrane({"region", quadratic, true});
  const InterfaceMesh all = square(3),
                      held = with_fixed(all, [](const Point &x) { return x[0] < 0.01; });
  expect_joined(scene, all, held, {});
  expect_sum(scene, held);
}

/// No function is above zero there, and no gap counts.
TEST(EntitySum, WhatCannotMoveAtAllIsNoContact) {
  const Scene scene = membrane({"region", quadratic});
  const auto interface = scene.contacts.front().make(
      scene, with_fixed(square(3), [](const Point &x) { return x[0] < 0.4; }));
  EXPECT_EQ(interface->dual().nodes(), 8);
  ContactOperators op;
  interface->assemble_all({0.8}, {}, op);
  EXPECT_NEAR(op.weights.sum(), 0.8 * 2 / 3, 1e-15);
  EXPECT_TRUE(refuses("fixed on all of a contact interface", [&] {
    scene.contacts.front().make(scene, with_fixed(square(3), [](const Point &) { return true; }));
  }));
}

/// -B 1 = the weights, whose sum is the mapped area; -g over all rows is the integral of psi.
TEST(ObstacleInterface, IntegratesOverTheMappedRegion) {
  for (const bool lumped : {false, true}) {
    const Scene scene = membrane({"region", quadratic, lumped});
    const auto interface = scene.contacts.front().make(scene, square(4));
    const double stretch = 1.4;
    ContactOperators op;
    interface->assemble_all({stretch}, {}, op);
    EXPECT_NEAR(op.weights.sum(), stretch, 1e-14);
    EXPECT_LE((op.b * Vector::Ones(25) + op.weights).norm(), 1e-14);
    EXPECT_EQ(op.b.isApprox(SparseMatrix(op.b.transpose())), true);
    // Over (0, s) x (0, 1): 0.3 s - s^4 / 3 + s^2 / 2.
    const double s = stretch, exact = 0.3 * s - std::pow(s, 4) / 3 + s * s / 2;
    EXPECT_NEAR(-op.g.sum(), exact, lumped ? 0.1 : 1e-14);
    if (!lumped) continue;
    EXPECT_LE((Matrix(op.b) + Matrix(op.weights.asDiagonal())).norm(), 1e-15);
    EXPECT_LE((op.g - op.weights.cwiseProduct(op.nodal_gap)).norm(), 1e-15);
  }
}

TEST(ObstacleInterface, BoundsTheVerticesFromBelow) {
  const Scene scene = membrane({"region", quadratic});
  const InterfaceMesh mesh = square(2);
  const auto interface = scene.contacts.front().make(scene, mesh);
  const FullMu mu{0.7};
  ContactOperators op;
  interface->assemble_nodal(mu, {}, {}, op);
  EXPECT_EQ(Matrix(op.nodal_b), Matrix(-Matrix::Identity(9, 9)));
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    EXPECT_EQ(op.nodal_gap[static_cast<Index>(i)], -quadratic(mu, scene.map(mu, mesh.points[i])));
  const PointConstraint at = interface->constraint_at(mu, {0.3, 0.6, 0});
  EXPECT_EQ(at.direction, (Point{-1, 0, 0}));
  EXPECT_EQ(at.gap, -quadratic(mu, {0.7 * 0.3, 0.6, 0}));
  EXPECT_EQ(interface->bound(mu).coefficient + interface->bound(mu).threshold, 0);
}

TEST(ObstacleInterface, OutputsAreThoseOfTheMirrorImagesTogether) {
  Scene scene = membrane({"region", quadratic});
  scene.mirrors = {{0, -9}};
  const auto interface = scene.contacts.front().make(scene, square(2));
  ContactOperators op;
  interface->assemble_nodal({1}, {}, {}, op);
  Vector lambda = Vector::Zero(9);
  lambda[4] = 3;
  lambda[0] = 1e-3;
  Outputs out;
  interface->outputs({1}, op, lambda, 1e-2, out);
  make_whole(scene.mirrors, out);
  EXPECT_DOUBLE_EQ(*out.normal_force, 2 * op.weights.dot(lambda));
  EXPECT_DOUBLE_EQ(*out.contact_measure, 2 * op.weights[4]);
  EXPECT_EQ(*out.contact_nodes, 2);
  EXPECT_EQ(*out.free_nodes, 16);
  EXPECT_EQ(*out.ends_in_contact, 0);
  EXPECT_EQ(*out.peak_pressure, 3);
  lambda[0] = 1; // a corner
  interface->outputs({1}, op, lambda, 1e-2, out);
  EXPECT_EQ(*out.ends_in_contact, 2);
  Outputs of_whole; // beside the whole domain there is nothing
  scene.contacts = {obstacle({"", quadratic})};
  scene.contacts.front().make(scene, square(2))->outputs({1}, op, lambda, 1e-2, of_whole);
  EXPECT_FALSE(of_whole.ends_in_contact);
}

TEST(ObstacleInterface, FieldsAreThoseOfTheMappedRegion) {
  const Scene scene = membrane({"region", quadratic});
  const InterfaceMesh mesh = square(2);
  const Vector u = Vector::LinSpaced(9, 0, 1), lambda = Vector::LinSpaced(9, 2, 3);
  const FullMu mu{0.7};
  const Grid grid = scene.contacts.front().make(scene, mesh)->fields(mu, u, lambda, false);
  EXPECT_EQ(grid.cells, mesh.entities);
  ASSERT_EQ(grid.of_nodes.size(), 5U);
  EXPECT_EQ(grid.of_nodes[0].values, lambda);
  EXPECT_EQ(Vector(grid.of_nodes[2].values.tail<3>()), (Vector{{0, 0, -1}})) << "downwards";
  for (Index i = 0; i < 9; ++i) {
    const Point x = scene.map(mu, mesh.points[i]);
    EXPECT_EQ(grid.points(i, 0), x[0]);
    EXPECT_NEAR(grid.of_nodes[1].values[i], u[i] - quadratic(mu, x), 1e-15);
  }
}

/// Of degree 2 the pressure keeps the hats of the vertices. -B u = int u eta for a quadratic u: it
/// is -g of psi = u, and with the sum of all rows its integral. Lumped: values at the vertices.
TEST(ObstacleInterface, OfDegreeTwoHatsSeeTheQuadraticDisplacement) {
  const InterfaceMesh mesh = quadratic_square(3);
  const FullMu mu{1.4};
  for (const bool lumped : {false, true}) {
    const Scene scene = membrane({"region", quadratic, lumped});
    const auto interface = scene.contacts.front().make(scene, mesh);
    ContactOperators op;
    interface->assemble_all(mu, {}, op);
    ASSERT_EQ(interface->dual().nodes(), 16);
    EXPECT_EQ(interface->dual().gram.rows(), 16);
    EXPECT_NEAR(interface->dual().gram.sum(), 1, 1e-14) << "the area of the reference square";
    EXPECT_NEAR(op.weights.sum(), mu[0], 1e-14);
    const Matrix points = mapped_points(scene, mu, mesh.points);
    Vector u(mesh.nodes());
    for (Index i = 0; i < u.size(); ++i)
      u[i] = quadratic(mu, {points(i, 0), points(i, 1), 0});
    EXPECT_LE((op.b * u - op.g).norm(), 1e-14 * op.g.norm());
    EXPECT_LE((op.nodal_b * u - op.nodal_gap).norm(), 1e-15);
    for (Index row = 0; row < 16 && lumped; ++row) {
      EXPECT_DOUBLE_EQ(op.b.coeff(row, row), -op.weights[row]);
      EXPECT_DOUBLE_EQ(op.b.row(row).norm(), op.weights[row]) << "nothing but the vertex";
    }
  }
}

TEST(ObstacleInterface, FieldsOfDegreeTwoAreOnQuadraticCells) {
  const Scene scene = membrane({"region", quadratic});
  const InterfaceMesh mesh = quadratic_square(2);
  const FullMu mu{0.7};
  const Vector u = Vector::LinSpaced(mesh.nodes(), 0, 1), lambda = Vector::LinSpaced(9, 2, 3);
  const Grid grid = scene.contacts.front().make(scene, mesh)->fields(mu, u, lambda, false);
  EXPECT_EQ(grid.cells, mesh.entities);
  EXPECT_EQ(grid.per_cell, 6);
  const Vector &pressure = grid.of_nodes[0].values, &gap = grid.of_nodes[1].values;
  EXPECT_EQ(pressure.head(9), lambda);
  for (Index i = 0; i < mesh.nodes(); ++i)
    EXPECT_NEAR(gap[i], u[i] - quadratic(mu, {grid.points(i, 0), grid.points(i, 1), 0}), 1e-15);
  for (Index e = 0; e < mesh.count(); ++e)
    for (int k = 0; k < 3; ++k) {
      const int *nodes = mesh.nodes_of(e);
      EXPECT_NEAR(pressure[nodes[3 + k]], (pressure[nodes[k]] + pressure[nodes[(k + 1) % 3]]) / 2,
                  1e-15);
    }
}

TEST(ObstacleInterface, IsForScalarsOnWholeCells) {
  const Scene scene = membrane({"region", quadratic});
  const auto made_with = [&](auto change) {
    return [&scene, change] {
      InterfaceMesh mesh = square(2);
      change(mesh);
      (void)scene.contacts.front().make(scene, mesh);
    };
  };
  const std::string says = "scalar displacements";
  EXPECT_TRUE(refuses(says, made_with([](InterfaceMesh &mesh) { mesh.components = 2; })));
  EXPECT_TRUE(refuses(says, made_with([](InterfaceMesh &mesh) { mesh.degree = 2; })));
  EXPECT_TRUE(refuses(says, made_with([](InterfaceMesh &mesh) { mesh.per_entity = 2; })));
}

} // namespace
} // namespace rbvi::entity_sum_test
