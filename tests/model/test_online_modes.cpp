// Free modes (equations in place of inequalities) and enrichment that is made online.
#include "../linear_algebra.hpp"
#include "brute_force.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/online.hpp"

#include <gtest/gtest.h>

namespace rbvi::online_modes_test {
namespace {

using namespace brute;

/// The last `free` of the functions are modes. They carry no pressure unless a test gives them one,
/// so that the check of its sign stays out of the way.
ReducedModel model_with_modes(const synthetic::Sizes &sizes, unsigned seed, int free) {
  ReducedModel model = toy_model(sizes, seed);
  model.contact.free_modes = free;
  model.contact.dual_basis.rightCols(free).setZero();
  return model;
}

template <synthetic::Value value> void expect_exact(const synthetic::Sizes &sizes, int free) {
  int bounded = 0, negative = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const ReducedModel model = model_with_modes(sizes, seed, free);
    OnlineSolver solver(model, synthetic::toy_scene<value>());
    for (const Mu &mu : parse_set(model.scene.parameters, "random:12:" + std::to_string(seed))) {
      const ReducedAnswer solution = solver.solve(mu);
      const Operators o = assemble(model, value, mu);
      const PairAnswer exact = brute_force_pair(o, free);
      const Index signed_ones = sizes.generators - free;
      EXPECT_LE((solution.u - exact.u).norm(), 1e-10 * (exact.u.norm() + 1e-3));
      EXPECT_LE((solution.lambda - exact.x).norm(), 1e-9 * (exact.x.norm() + 1e-3));
      EXPECT_LE((o.b * solution.u - o.g).tail(free).norm(), 1e-11 * (o.g.norm() + 1));
      EXPECT_LE((o.a * solution.u + o.b.transpose() * solution.lambda - o.f).norm(),
                1e-10 * o.f.norm());
      EXPECT_LE(solution.residual, 1e-11);
      bounded += (solution.lambda.head(signed_ones).array() > 0).any();
      negative += (solution.lambda.tail(free).array() < 0).any();
    }
  }
  EXPECT_GT(negative, 20) << "the modes were hardly ever negative";
  EXPECT_TRUE(bounded > 20 || free == sizes.generators);
}

TEST(FreeModes, AgreeWithBruteForce) {
  expect_exact<smooth>({4, 3, 5, 3, 2, 2, 2}, 2);
}
TEST(FreeModes, OneTermOfA) {
  expect_exact<smooth>({4, 3, 5, 1, 2, 2, 2}, 1);
}
TEST(FreeModes, OneTermOfB) {
  expect_exact<smooth>({4, 3, 5, 3, 1, 2, 2}, 3);
}
TEST(FreeModes, OneTermOfBothSignsChange) {
  expect_exact<flipping>({4, 3, 5, 1, 1, 2, 2}, 2);
}
TEST(FreeModes, NothingButModes) {
  expect_exact<smooth>({4, 3, 4, 2, 2, 2, 2}, 4);
}

TEST(FreeModes, MoreOfThemThanUnknownsContradict) {
  const ReducedModel model = model_with_modes({2, 0, 4, 1, 1, 1, 1}, 1, 3);
  OnlineSolver solver(model, synthetic::toy_scene<smooth>());
  try {
    solver.solve({0.2, 0, 0});
    FAIL() << "accepted";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("contradict"), std::string::npos) << error.what();
  }
}

/// Node 0 takes the pressure of the first generator, node 1 that of the last function.
Matrix two_nodes(const ReducedModel &model) {
  Matrix basis = Matrix::Zero(model.contact.dual_basis.rows(), model.contact.generators);
  basis(0, 0) = basis(1, model.contact.generators - 1) = 1;
  return basis;
}

TEST(FreeModes, APulledNodeIsAFailureThatNamesTheRing) {
  int pulled = 0, pushed = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    ReducedModel model = model_with_modes({4, 3, 4, 2, 1, 1, 1}, seed, 1);
    model.contact.dual_basis = two_nodes(model);
    OnlineSolver solver(model, synthetic::toy_scene<smooth>());
    const Mu mu{0.19, 0.01, 0};
    const PairAnswer exact = brute_force_pair(assemble(model, smooth, mu), 1);
    const Vector pressure = model.contact.dual_basis * exact.x;
    try {
      solver.solve(mu);
      EXPECT_GE(pressure.minCoeff(), -1.01e-2 * pressure.maxCoeff());
      ++pushed;
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::failed);
      const std::string message = error.what();
      EXPECT_LE(pressure.minCoeff(), -0.99e-2 * pressure.maxCoeff()) << message;
      EXPECT_NE(message.find("-cone_ring"), std::string::npos) << message;
      EXPECT_NE(message.find("0.1 -0.1"), std::string::npos) << message; // where node 1 is
      EXPECT_NE(message.find("radius=0.19"), std::string::npos) << message;
      ++pulled;
    }
  }
  EXPECT_GT(pulled, 2);
  EXPECT_GT(pushed, 2);
}

/// A generator that is negative somewhere is watched as well: a hybrid cone can do without modes.
TEST(FreeModes, ANegativeGeneratorIsWatchedWithoutModes) {
  ReducedModel model = toy_model({4, 3, 4, 2, 1, 1, 1}, 2);
  model.contact.dual_basis = Matrix::Zero(3, 4);
  model.contact.dual_basis.row(0).setOnes();
  OnlineSolver good(model, synthetic::toy_scene<smooth>());
  const Mu mu{0.19, 0.01, 0};
  ASSERT_GT(good.solve(mu).lambda.sum(), 0) << "nothing is in contact";
  model.contact.dual_basis.row(1).setConstant(-0.5);
  OnlineSolver bad(model, synthetic::toy_scene<smooth>());
  EXPECT_THROW(bad.solve(mu), Error);
}

Matrix compressed(const Matrix &b, Index modes) {
  const Index n = b.cols();
  const Matrix rows = b.rightCols(n - modes).transpose();
  const ThinSvd svd = thin_svd(rows);
  Index rank = 0;
  while (rank < svd.values.size() && svd.values[rank] > 1e-12 * svd.values[0])
    ++rank;
  Matrix c = Matrix::Zero(n, modes + rank);
  c.topLeftCorner(modes, modes).setIdentity();
  c.bottomRightCorner(n - modes, rank) = svd.left.leftCols(rank);
  return c;
}

/// An online-enriched model against one compressed by hand to V_N + the rows of b(mu).
template <synthetic::Value value> void expect_enriched(const synthetic::Sizes &sizes, int free) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    ReducedModel model = model_with_modes(sizes, seed, free);
    OnlineSolver plain(model, synthetic::toy_scene<value>());
    ReducedModel online = model;
    online.body.online_enriched = true;
    OnlineSolver solver(online, synthetic::toy_scene<value>());
    double changed = 0;
    for (const Mu &mu : parse_set(model.scene.parameters, "random:12:" + std::to_string(seed))) {
      const ReducedAnswer solution = solver.solve(mu);
      const Operators o = assemble(model, value, mu);
      const Matrix c = compressed(o.b, sizes.modes);
      const PairAnswer inside =
          brute_force_pair({c.transpose() * o.a * c, o.b * c, c.transpose() * o.f, o.g}, free);
      const Vector u = c * inside.u;
      ASSERT_EQ(solution.u.size(), model.primal_size());
      EXPECT_LE((solution.u - u).norm(), 1e-10 * u.norm());
      EXPECT_LE((solution.lambda - inside.x).norm(), 1e-9 * (inside.x.norm() + 1e-3));
      EXPECT_NEAR(solution.energy, 0.5 * u.dot(o.a * u) - o.f.dot(u), 1e-10 * std::abs(o.f.dot(u)));
      EXPECT_LE(solution.residual, 1e-11);
      changed = std::max(changed, (plain.solve(mu).u - u).norm() / u.norm());
    }
    if (sizes.supremizers > sizes.generators) {
      EXPECT_GT(changed, 1e-3) << "the compression changed nothing";
    } else {
      EXPECT_LE(changed, 1e-9) << "the span is the whole space";
    }
  }
}

TEST(OnlineEnriched, IsTheModelCompressedByHand) {
  expect_enriched<smooth>({3, 7, 4, 2, 2, 2, 2}, 0);
}
TEST(OnlineEnriched, OneTermOfAAndB) {
  expect_enriched<smooth>({3, 7, 4, 1, 1, 2, 2}, 0);
}
TEST(OnlineEnriched, WithFreeModesAndSignsThatChange) {
  expect_enriched<flipping>({3, 7, 4, 2, 2, 1, 1}, 2);
}
TEST(OnlineEnriched, NoMoreSupremizersThanMultipliersIsThePlainModel) {
  expect_enriched<smooth>({4, 3, 4, 2, 2, 2, 2}, 0);
}

} // namespace
} // namespace rbvi::online_modes_test
