// The two dense solvers against each other on random problems of all conditions, with ties and
// warm starts; and reduced models of random size against their optimality system.
#include "../model/synthetic.hpp"

#include "rbvi/core/largest.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/method/lcp.hpp"
#include "rbvi/method/nonnegative_qp.hpp"

#include <gtest/gtest.h>

using namespace rbvi;

namespace {

/// Y (m x r, full column rank, condition up to 10^spread), c and g with exact zeros among them.
struct RandomQp {
  Matrix y;
  Vector c, g;
};

RandomQp random_qp(std::mt19937 &random) {
  std::uniform_int_distribution<int> size(1, 40), spread(0, 4), choice(0, 3);
  const Index r = size(random), m = r + size(random);
  RandomQp qp;
  qp.y = synthetic::random_matrix(random, m, r);
  const Vector scales =
      Vector::LinSpaced(r, 0, -spread(random)).unaryExpr([](double s) { return std::pow(10, s); });
  if (choice(random) == 0) {
    qp.y = qp.y * scales.asDiagonal();
  } else {
    const Eigen::HouseholderQR<Matrix> left(qp.y);
    const Matrix basis = left.householderQ() * Matrix::Identity(m, r);
    const Eigen::HouseholderQR<Matrix> right(synthetic::random_matrix(random, r, r));
    qp.y = basis * scales.asDiagonal() * Matrix(right.householderQ());
  }
  qp.c = synthetic::random_matrix(random, m, 1);
  qp.g = choice(random) == 0 ? Vector::Zero(r) : Vector(synthetic::random_matrix(random, r, 1));
  for (Index i = 0; i < r; ++i)
    if (choice(random) == 0) qp.g[i] = 0;
  return qp;
}

std::vector<Index> random_set(std::mt19937 &random, Index size) {
  std::vector<Index> result;
  for (Index i = 0; i < size; ++i)
    if (random() % 2 == 0) result.push_back(i);
  return result;
}

/// The condition of the columns scaled to unit norm.
double condition(const Matrix &y) {
  const Vector values = y.colwise().normalized().eval().bdcSvd().singularValues();
  return values[0] / values[values.size() - 1];
}

/// Largest violation of x >= 0, w = Y^T (Y x - c) + g >= 0, x . w = 0, relative to the terms.
double violation(const RandomQp &qp, const Vector &x) {
  const Vector z = qp.y * x - qp.c, w = qp.y.transpose() * z + qp.g;
  const double size = (qp.y * x).norm() + qp.c.norm();
  double worst = x.minCoeff() < 0 ? 1 : 0;
  for (Index j = 0; j < x.size(); ++j) {
    const double scale = qp.y.col(j).norm() * size + std::abs(qp.g[j]);
    worst = larger(worst, (x[j] > 0 ? std::abs(w[j]) : -w[j]) / scale);
  }
  return worst;
}

} // namespace

TEST(DenseStress, LcpAndNonnegativeQpAgreeOnRandomProblems) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 20000; ++trial) {
    SCOPED_TRACE(trial);
    const RandomQp qp = random_qp(random);
    const Index r = qp.y.cols();
    NonnegativeQp solver(qp.y.rows());
    if (trial % 2 == 0) solver.start_from(random_set(random, r));
    const NonnegativeQpReport report = solver.solve(qp.y, qp.c, qp.g);
    ASSERT_TRUE(report.converged);
    ASSERT_LE(violation(qp, solver.x()), 1e-12);

    const Matrix h = qp.y.transpose() * qp.y;
    const Vector q = qp.g - qp.y.transpose() * qp.c;
    const auto columns = [&](const std::vector<Index> &which) {
      return Matrix(h(Eigen::all, which));
    };
    const LcpResult lcp = solve_lcp(columns, q, random_set(random, r));
    ASSERT_TRUE(lcp.converged) << lcp.reason;
    // H = Y^T Y carries rounding errors of its entries: Y x is known to eps kappa(H) only.
    const double kappa = condition(qp.y);
    ASSERT_LE((qp.y * (lcp.x - solver.x())).norm(),
              (1e-13 + 1e-15 * kappa * kappa) * (qp.c.norm() + (qp.y * solver.x()).norm()));
  }
}

TEST(DenseStress, AKeptActiveSetAnswersLikeAFreshOne) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    RandomQp qp = random_qp(random);
    NonnegativeQp kept(qp.y.rows());
    for (int step = 0; step < 50; ++step) {
      qp.c += 0.3 * synthetic::random_matrix(random, qp.c.size(), 1);
      ASSERT_TRUE(kept.solve(qp.y, qp.c, qp.g).converged);
      NonnegativeQp fresh(qp.y.rows());
      ASSERT_TRUE(fresh.solve(qp.y, qp.c, qp.g).converged);
      ASSERT_LE(violation(qp, kept.x()), 1e-12);
      ASSERT_LE((qp.y * (kept.x() - fresh.x())).norm(),
                1e-9 * (qp.c.norm() + (qp.y * fresh.x()).norm()));
    }
  }
}

TEST(DenseStress, RandomReducedModelsSatisfyTheirOptimalitySystem) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> few(1, 4), size(1, 15);
  int answered = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    SCOPED_TRACE(seed);
    synthetic::Sizes sizes{size(random), size(random) - 1, 0,          few(random),
                           few(random),  few(random),      few(random)};
    // At most as many generators as modes: then the constraints never contradict each other.
    sizes.generators = 1 + (size(random) - 1) % (sizes.modes + sizes.supremizers);
    const ReducedModel model = synthetic::random_model(sizes, seed);
    OnlineSolver warm(model);
    for (const Mu &mu : parse_set(model.scene.parameters, "random:20:" + std::to_string(seed))) {
      const ReducedAnswer solution = warm.solve(mu);
      ASSERT_LE(solution.residual, 1e-10);
      OnlineSolver cold(model);
      const ReducedAnswer again = cold.solve(mu);
      ASSERT_LE((solution.u - again.u).norm(), 1e-9 * again.u.norm());
      ++answered;
    }
  }
  EXPECT_EQ(answered, 20000);
}
