// Laws of contact that differ from node to node, in systems whose rows are in any order.
#include "columns.hpp"
#include "random_matrix.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <numeric>
#include <random>

namespace rbvi::node_laws_test {
namespace {

/// Symmetric positive definite, its rows of unlike sizes.
Matrix random_h(Random &random, Index size) {
  const Matrix root = random.matrix(size, size);
  const Vector scale = random.vector(size).array().exp();
  return scale.asDiagonal() * (root * root.transpose() + 0.5 * Matrix::Identity(size, size)) *
         scale.asDiagonal();
}

/// Every third node has a sign alone; the others have friction of their own.
NodeLaws mixed_laws(Index nodes, int dim, std::mt19937 &engine) {
  NodeLaws laws;
  laws.tangents = dim - 1;
  for (Index i = 0; i < nodes; ++i) {
    const bool friction = i % 3 != 0;
    laws.normal.push_back(laws.rows++);
    laws.tangent.push_back(friction ? laws.rows : -1);
    if (friction) laws.rows += laws.tangents;
    const double c = 0.1 * static_cast<double>(i % 4), t = i % 2 == 0 ? 0.2 : 0;
    laws.bound.push_back({c, t, i % 5 == 0});
  }
  std::vector<Index> order(laws.rows);
  std::iota(order.begin(), order.end(), 0);
  if (dim == 2) std::shuffle(order.begin(), order.end(), engine);
  for (std::size_t i = 0; i < laws.normal.size(); ++i) {
    laws.normal[i] = order[laws.normal[i]];
    if (laws.tangent[i] >= 0) laws.tangent[i] = order[laws.tangent[i]];
  }
  return laws;
}

/// Largest of |x - P(x - rho w)| over max |x|, rho = 1 / H_jj, of a node its largest tangential
/// one.
double natural_residual(const Matrix &h, const Vector &q, const NodeLaws &laws, const Vector &x) {
  const Vector w = h * x + q;
  Vector rho = h.diagonal().cwiseInverse();
  for (Index i = 0; i < laws.nodes(); ++i)
    if (laws.has_tangent(i)) {
      auto of_node = rho.segment(laws.tangent[i], laws.tangents);
      of_node.setConstant(of_node.minCoeff());
    }
  // The bound is that of x: the projection of the tangential part on the ball that x_n says.
  Vector next = x - rho.cwiseProduct(w);
  for (Index i = 0; i < laws.nodes(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    next[laws.normal[node]] = std::max(0.0, next[laws.normal[node]]);
    if (!laws.has_tangent(i)) continue;
    auto tangential = next.segment(laws.tangent[node], laws.tangents);
    const double bound = laws.bound[node].value(x[laws.normal[node]]);
    if (tangential.norm() > bound) tangential *= bound / tangential.norm();
  }
  return (x - next).cwiseAbs().maxCoeff() / std::max(1e-300, x.cwiseAbs().maxCoeff());
}

TEST(NodeLaws, NodesOfUnlikeLawsAreSolvedTogether) {
  std::mt19937 engine(1);
  Random random(2);
  int solved = 0;
  for (const int dim : {2, 3})
    for (int trial = 0; trial < 200; ++trial) {
      const NodeLaws laws = mixed_laws(3 + trial % 9, dim, engine);
      check(laws);
      const Matrix h = random_h(random, laws.rows);
      const Vector q = random.vector(laws.rows);
      std::set<Index> given;
      const FrictionResult found = solve_friction(once(h, given), q, laws);
      if (!found.converged) continue; // Coulomb's law need not be solvable by these steps
      ++solved;
      ASSERT_EQ(found.x.size(), laws.rows);
      EXPECT_LT(natural_residual(h, q, laws, found.x), 1e-9);
      EXPECT_LT((found.w - (h * found.x + q)).norm(), 1e-9 * (1 + q.norm()) * h.norm());
      const FrictionResult again = solve_friction(columns_of(h), q, laws, found.start);
      ASSERT_TRUE(again.converged);
      EXPECT_LT((again.x - found.x).norm(), 1e-9 * (1 + found.x.norm()));
    }
  EXPECT_GT(solved, 380);
}

TEST(NodeLaws, TheOrderOfRowsDoesNotMatter) {
  std::mt19937 engine(3);
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Index nodes = 2 + trial % 7;
    const NodeLaws blocks = uniform_laws(nodes, 2, {0.3, 0.1, false});
    const Matrix h = random_h(random, blocks.rows);
    const Vector q = random.vector(blocks.rows);
    std::vector<Index> place(blocks.rows); // of each row
    std::iota(place.begin(), place.end(), 0);
    std::shuffle(place.begin(), place.end(), engine);
    NodeLaws moved = blocks;
    Matrix moved_h(blocks.rows, blocks.rows);
    Vector moved_q(blocks.rows);
    for (Index &row : moved.normal)
      row = place[row];
    for (Index &row : moved.tangent)
      row = place[row];
    moved_h(place, place) = h;
    moved_q(place) = q;
    const FrictionResult one = solve_friction(columns_of(h), q, blocks),
                         other = solve_friction(columns_of(moved_h), moved_q, moved);
    ASSERT_EQ(one.converged, other.converged);
    EXPECT_EQ(one.iterations, other.iterations);
    EXPECT_EQ(one.active, other.active);
    EXPECT_LT((other.x(place) - one.x).norm(), 1e-12 * (1 + one.x.norm()));
  }
}

TEST(NodeLaws, InterfacesAreStacked) {
  NodeLaws laws = uniform_laws(2, 1, {});
  append(uniform_laws(3, 2, {0.5, 0, false}), laws);
  append(uniform_laws(1, 1, {}), laws);
  check(laws);
  EXPECT_EQ(laws.rows, 9);
  EXPECT_EQ(laws.normal, (std::vector<Index>{0, 1, 2, 3, 4, 8}));
  EXPECT_EQ(laws.tangent, (std::vector<Index>{-1, -1, 5, 6, 7, -1}));
  Vector x(9);
  x << -1, 2, 4, -3, 1, 5, 0.4, -0.1, 6;
  EXPECT_EQ(bounds_of(laws, x), (Vector(6) << 0, 0, 2, 0, 0.5, 0).finished());
  EXPECT_EQ(admissible(laws, x), (Vector(9) << 0, 2, 4, 0, 1, 2, 0, -0.1, 6).finished());
  EXPECT_EQ(normal_part(laws, x), (Vector(9) << -1, 2, 4, -3, 1, 0, 0, 0, 6).finished());
}

TEST(NodeLaws, RefusesRowsOfNoNodeOrOfTwo) {
  NodeLaws missing = uniform_laws(3, 2, {0.1, 0, false}), twice = missing, beyond = missing;
  missing.rows = 7;
  twice.tangent[1] = 0;
  beyond.normal[2] = 6;
  for (const NodeLaws &laws : {missing, twice, beyond})
    EXPECT_THROW(check(laws), Error);
  EXPECT_THROW(check(uniform_laws(2, 2, {-1, 0, false})), Error);
}

} // namespace
} // namespace rbvi::node_laws_test
