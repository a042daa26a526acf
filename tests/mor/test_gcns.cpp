#include "../linear_algebra.hpp"
#include "../method/columns.hpp"
#include "../method/half_plane.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/mor/published/gcns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace rbvi::gcns_test {

namespace {

/// Round punches of different curvature on a half-plane of m nodes; `slide` breaks the mirror
/// symmetry.
struct Punches {
  Matrix h;
  std::vector<Vector> gaps;
  Matrix pressures, tractions; ///< truths: m x samples

  Punches(Index m, int samples, double coefficient, double slide) : h(half_plane(m)) {
    const double size = static_cast<double>(m);
    pressures.resize(m, samples);
    tractions.resize(m, samples);
    for (int k = 0; k < samples; ++k) {
      const double radius = size * (0.2 + 0.3 * k / samples);
      Vector gap = Vector::Constant(2 * m, slide);
      for (Index i = 0; i < m; ++i)
        gap[i] = std::pow((static_cast<double>(i) - 0.5 * (size - 1)) / radius, 2) - 1;
      const FrictionResult truth = solve_friction(columns_of(h), gap, 2, {coefficient, 0, false});
      EXPECT_TRUE(truth.converged) << truth.reason;
      pressures.col(k) = truth.x.head(m);
      tractions.col(k) = truth.x.tail(m);
      gaps.push_back(gap);
    }
  }
};

/// The cone of all pressures and the first modes of the tractions.
struct Reduced {
  Matrix normal, tangential;
  SparseMatrix product;
  std::vector<GcnsSample> samples;

  Reduced(const Punches &p, double coefficient, double truncation) : normal(p.pressures) {
    const Index m = normal.rows();
    const ThinSvd svd = thin_svd(p.tractions);
    const Index modes = (svd.values.array() > truncation * svd.values[0]).count();
    tangential = svd.left.leftCols(modes);
    product.resize(m, m);
    product.setIdentity();
    Matrix basis = Matrix::Zero(2 * m, normal.cols() + modes);
    basis.topLeftCorner(m, normal.cols()) = normal;
    basis.bottomRightCorner(m, modes) = tangential;
    for (std::size_t k = 0; k < p.gaps.size(); ++k)
      samples.push_back({basis.transpose() * p.h * basis,
                         basis.transpose() * p.gaps[k],
                         {{coefficient, 0, false}},
                         p.tractions.col(static_cast<Index>(k))});
  }
  Gcns select(const GcnsOptions &options = {}) const {
    return select_collocation_nodes(samples, normal, tangential, product, options);
  }
  CollocatedResult solve(std::size_t sample, const std::vector<int> &nodes) const {
    return solve_collocated({samples[sample].h, samples[sample].q, normal(nodes, Eigen::all),
                             tangential(nodes, Eigen::all), samples[sample].bounds});
  }
  /// e_GCNS of these nodes, and the largest violation at them.
  std::pair<double, double> measure(const std::vector<int> &nodes) const {
    double error = 0, violation = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const Vector x = solve(k, nodes).x;
      const Vector traction = tangential * x.tail(tangential.cols());
      const Vector pressure = normal * x.head(normal.cols());
      const Vector excess = traction.cwiseAbs() - samples[k].bounds.front().coefficient * pressure;
      error =
          std::max(error, (samples[k].tangential - traction).norm() / samples[k].tangential.norm());
      for (const int j : nodes)
        violation = std::max(violation, excess[j] / pressure.maxCoeff());
    }
    return {error, violation};
  }
};

void expect_consistent(const Gcns &g, std::size_t samples) {
  ASSERT_FALSE(g.count.empty());
  EXPECT_EQ(g.error.size(), g.count.size());
  EXPECT_EQ(g.violation.size(), g.count.size());
  EXPECT_EQ(g.selected.size(), g.count.size());
  EXPECT_EQ(g.count.front(), 0);
  EXPECT_TRUE(std::is_sorted(g.count.begin(), g.count.end(), std::less_equal<>()));
  for (const int k : g.selected)
    EXPECT_LT(static_cast<std::size_t>(k), samples);
  EXPECT_EQ(std::set<int>(g.nodes.begin(), g.nodes.end()).size(), g.nodes.size());
  EXPECT_FALSE(g.reason.empty());
  const auto best = std::min_element(g.error.begin(), g.error.end());
  EXPECT_EQ(static_cast<int>(g.nodes.size()), g.count[best - g.error.begin()]);
}

} // namespace

TEST(Gcns, BasesThatHoldTheTruthNeedNoMoreNodesThanItTakes) {
  for (const double coefficient : {0.2, 0.5}) {
    const Reduced r(Punches(31, 6, coefficient, 0.1), coefficient, 1e-11);
    const Gcns g = r.select();
    SCOPED_TRACE(g.reason);
    expect_consistent(g, 6);
    EXPECT_GT(g.error.front(), 1e-2);
    EXPECT_LT(*std::min_element(g.error.begin(), g.error.end()), 1e-8);
    EXPECT_LT(g.error.back(), 1e-8);
    EXPECT_GT(g.violation.front(), 1e-2);
    EXPECT_LT(g.violation.back(), 1e-9);
    EXPECT_LE(g.nodes.size(), 31u);
  }
}

TEST(Gcns, TheReturnedNodesHaveTheLeastErrorAndHoldTheBound) {
  const double coefficient = 0.3;
  const Reduced r(Punches(41, 9, coefficient, 0.1), coefficient, 1e-2);
  const Gcns g = r.select();
  SCOPED_TRACE(g.reason);
  expect_consistent(g, 9);
  const auto [error, violation] = r.measure(g.nodes);
  EXPECT_NEAR(error, *std::min_element(g.error.begin(), g.error.end()), 1e-8);
  EXPECT_LT(violation, 1e-10);
}

TEST(Gcns, MirroredNodesComeTogether) {
  const Index m = 33;
  const Reduced r(Punches(m, 7, 0.3, 0), 0.3, 1e-6);
  const Gcns g = r.select();
  SCOPED_TRACE(g.reason);
  expect_consistent(g, 7);
  ASSERT_GT(g.count.size(), 3u);
  for (const int count : g.count) {
    const auto size = std::min(static_cast<std::size_t>(count), g.nodes.size());
    const std::set<int> nodes(g.nodes.begin(), g.nodes.begin() + static_cast<std::ptrdiff_t>(size));
    for (const int j : nodes)
      EXPECT_TRUE(nodes.contains(static_cast<int>(m) - 1 - j)) << j << " of " << count;
  }
}

TEST(Gcns, EveryStepTakesTheLargestViolation) {
  const double coefficient = 0.3;
  const Reduced r(Punches(31, 5, coefficient, 0.1), coefficient, 1e-3);
  const Gcns g = r.select();
  SCOPED_TRACE(g.reason);
  std::vector<int> nodes;
  for (std::size_t q = 0; q + 1 < g.count.size(); ++q) {
    ASSERT_EQ(static_cast<int>(nodes.size()), g.count[q]);
    if (static_cast<std::size_t>(g.count[q + 1]) > g.nodes.size()) break;
    const std::vector<int> next(g.nodes.begin() + g.count[q], g.nodes.begin() + g.count[q + 1]);
    double worst = 0;
    for (std::size_t k = 0; k < r.samples.size(); ++k) {
      const Vector x = r.solve(k, nodes).x;
      const Vector excess = (r.tangential * x.tail(r.tangential.cols())).cwiseAbs() -
                            coefficient * (r.normal * x.head(r.normal.cols()));
      worst = std::max(worst, excess.maxCoeff());
      if (static_cast<int>(k) != g.selected[q]) continue;
      for (const int j : next)
        EXPECT_NEAR(excess[j], g.violation[q], 1e-8 * g.violation[0]);
    }
    EXPECT_NEAR(worst, g.violation[q], 1e-8 * g.violation[0]);
    nodes.insert(nodes.end(), next.begin(), next.end());
  }
  EXPECT_FALSE(nodes.empty());
}

TEST(Gcns, StopsWhereItIsTold) {
  const Reduced r(Punches(31, 6, 0.3, 0.1), 0.3, 1e-11);
  const Gcns all = r.select();
  const Gcns accurate = r.select({.tolerance = 0.1, .max_nodes = 0});
  EXPECT_LE(accurate.error.back(), 0.1);
  EXPECT_LT(accurate.error.size(), all.error.size());
  EXPECT_EQ(static_cast<int>(accurate.nodes.size()), accurate.count.back());
  const Gcns few = r.select({.tolerance = 0, .max_nodes = 4});
  EXPECT_LE(few.count.back(), 4);
  EXPECT_TRUE(std::equal(few.error.begin(), few.error.end(), all.error.begin()));
  EXPECT_NE(few.reason, all.reason);
  const Gcns loose = r.select({.tolerance = 1e6, .max_nodes = 0});
  EXPECT_TRUE(loose.nodes.empty());
}

/// At the first rise of the error, with the nodes of the step before.
TEST(Gcns, TheStopOfAlgorithm3IsTheFirstRise) {
  int rises = 0;
  for (const double truncation : {1e-1, 3e-2, 1e-2, 1e-3, 1e-11}) {
    const Reduced r(Punches(41, 9, 0.3, 0.1), 0.3, truncation);
    const Gcns all = r.select(), stopped = r.select({.nodes = CollocationNodes::before_rise});
    SCOPED_TRACE(stopped.reason);
    std::size_t last = 0; // step before the first rise
    while (last + 1 < all.error.size() && all.error[last + 1] <= all.error[last])
      ++last;
    ASSERT_LE(stopped.error.size(), all.error.size());
    EXPECT_TRUE(std::equal(stopped.error.begin(), stopped.error.end(), all.error.begin()));
    if (last + 1 == all.error.size()) {
      EXPECT_EQ(stopped.nodes, all.nodes);
      continue;
    }
    ++rises;
    EXPECT_EQ(stopped.error.size(), last + 2) << "the step that rises is the last one";
    EXPECT_NE(stopped.reason.find("the error rises"), std::string::npos);
    expect_consistent(stopped, 9);
    EXPECT_NEAR(r.measure(stopped.nodes).first, all.error[last], 1e-8);
  }
  EXPECT_GT(rises, 0);
}

TEST(Gcns, AllNodesHoldTheBoundEverywhere) {
  const Reduced r(Punches(31, 6, 0.3, 0.1), 0.3, 1e-3);
  const Gcns all = r.select({.nodes = CollocationNodes::all});
  EXPECT_EQ(all.nodes.size(), 31u);
  EXPECT_EQ(all.count, std::vector<int>{31});
  EXPECT_LE(all.violation.front(), 1e-9);
  EXPECT_NEAR(r.measure(all.nodes).first, all.error.front(), 1e-8);
  EXPECT_THROW(r.select({.nodes = CollocationNodes::all, .max_nodes = 4}), Error);
}

TEST(Gcns, IsDeterministic) {
  const Reduced r(Punches(31, 6, 0.4, 0.1), 0.4, 1e-3);
  const Gcns one = r.select(), two = r.select();
  EXPECT_EQ(one.nodes, two.nodes);
  EXPECT_EQ(one.error, two.error);
  EXPECT_EQ(one.violation, two.violation);
  EXPECT_EQ(one.selected, two.selected);
}

TEST(Gcns, SaysWhatIsWrongWithTheInput) {
  Reduced r(Punches(21, 4, 0.3, 0.1), 0.3, 1e-3);
  const SparseMatrix other(20, 20);
  EXPECT_THROW(select_collocation_nodes(r.samples, r.normal, r.tangential, other, {}), Error);
  EXPECT_THROW(select_collocation_nodes({}, r.normal, r.tangential, r.product, {}), Error);
  EXPECT_THROW(r.select({.tolerance = -1, .max_nodes = 0}), Error);
  for (GcnsSample &sample : r.samples)
    sample.tangential.setZero();
  EXPECT_THROW(r.select(), Error);
  r.samples[1].q.resize(2);
  EXPECT_THROW(r.select(), Error);
}

} // namespace rbvi::gcns_test
