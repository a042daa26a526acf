// The bound of errors: its identity and its promise on small problems with known answers, the norm
// over references, and liftings.
#include "friction_problems.hpp"
#include "rbvi/method/certificate.hpp"
#include "rbvi/method/friction.hpp"
#include "rbvi/method/node_laws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rbvi::certificate_test {
namespace {

struct Problem {
  Matrix a, b;
  Vector f, g;
  NodeLaws laws;

  double norm(const Vector &u) const { return std::sqrt(u.dot(a * u)); }
  double dual_norm(const Vector &r) const {
    return std::sqrt(std::max(0.0, r.dot(Vector(lu_solve(a, r)))));
  }
  Index nodes() const { return laws.nodes(); }
  /// Of admissible v, with the work of friction.
  double energy(const Vector &v) const {
    const Vector slip = (b * v - g).tail(b.rows() - nodes());
    double work = 0;
    for (Index i = 0; i < slip.size(); ++i)
      work += laws.bound[i].value(1) * std::abs(slip[i]);
    return 0.5 * v.dot(a * v) - f.dot(v) + work;
  }
};

/// `nodes` with Tresca's threshold (0: without friction), on `size` displacements.
Problem random_problem(Random &random, Index nodes, Index size, double threshold) {
  Problem p;
  p.a = random_positive(random, size, 1);
  p.laws = uniform_laws(nodes, threshold > 0 ? 2 : 1, {0, threshold, false});
  p.b = random.matrix(p.laws.rows, size);
  p.f = 3 * random.vector(size);
  p.g = random.vector(p.laws.rows);
  p.g.head(nodes) = 0.2 * p.g.head(nodes).cwiseAbs();
  return p;
}

struct Answer {
  Vector u, l;
};

Answer solve(const Problem &p) {
  const Matrix moved = lu_solve(p.a, p.b.transpose());
  const Vector free = lu_solve(p.a, p.f);
  const Matrix h = p.b * moved;
  const FrictionResult found = solve_friction(columns_of(h), p.g - p.b * free, p.laws);
  EXPECT_TRUE(found.converged);
  return {free - moved * found.x, found.x};
}

/// What the bound says of (u, l), and of which v.
struct Certified {
  ErrorBound bound;
  Vector v;
};

Certified certify(const Problem &p, const Vector &u, const Vector &l) {
  const Index rows = p.b.rows();
  const Matrix functions = lu_solve(p.a, p.b.transpose());
  const Vector s = p.b * u - p.g;
  std::vector<int> own(rows);
  std::iota(own.begin(), own.end(), 0);
  const Matrix of_functions = p.b * functions;
  const auto lifting = lift(columns_of(of_functions), rows, own, s, l, p.laws, 1e-14);
  if (!lifting) {
    ADD_FAILURE() << "not lifted";
    return {};
  }
  const Vector z = functions * lifting->weights, v = u - z, r = p.f - p.a * u - p.b.transpose() * l;
  EXPECT_GE((p.g - p.b * v).head(p.nodes()).minCoeff(), -1e-12);
  EXPECT_LE((lifting->left - (p.g - p.b * v)).cwiseAbs().maxCoeff(), 1e-12);
  double slack = l.head(p.nodes()).dot(lifting->left.head(p.nodes()));
  for (Index row = p.nodes(); row < rows; ++row) {
    const double slip = -lifting->left[row];
    slack += std::max(0.0, p.laws.bound[row - p.nodes()].value(1) * std::abs(slip) -
                               l[row] * slip); // of round-off where it slips
  }
  return {error_bound(p.dual_norm(r - p.a * z), p.dual_norm(r + p.a * z), slack), v};
}

void expect_bounds(const Problem &p, const Vector &u, const Vector &l, const Answer &exact) {
  const auto [bound, v] = certify(p, u, l);
  const double unit = 1 + 1e-9, error = p.norm(exact.u - u), of_v = p.norm(exact.u - v),
               of_l = p.dual_norm(p.b.transpose() * (exact.l - l)), floor = 1e-7 * p.norm(exact.u);
  EXPECT_LE(error, bound.u * unit + floor);
  EXPECT_LE(of_v, bound.multiplier * unit + floor);
  EXPECT_LE(of_l, bound.multiplier * unit + floor);
  const double least = p.energy(exact.u), of_energy = p.energy(v);
  EXPECT_GE(of_energy, least - 1e-9);
  EXPECT_LE(of_energy - least, bound.gap + 1e-9);
  // |u - v|^2 + |B^T (l - l_N)|^2 + 2 (l . (g - B v) + l_N . (g - B u)) = 2 gap, without friction.
  if (p.laws.has_tangents()) return;
  const double other = exact.l.dot(p.g - p.b * v) + l.dot(p.g - p.b * exact.u);
  EXPECT_NEAR(of_v * of_v + of_l * of_l + 2 * other, 2 * bound.gap, 1e-7 * (1 + 2 * bound.gap));
}

} // namespace

TEST(Certificate, BoundsAnswersNearAndFar) {
  Random random(5);
  int problems = 0;
  for (const double threshold : {0.0, 0.3})
    for (int k = 0; k < 150; ++k) {
      const Index nodes = 1 + k % 5;
      const Problem p = random_problem(random, nodes, 14, threshold);
      const Answer exact = solve(p);
      for (const double off : {0.0, 1e-6, 1e-3, 0.1, 1.0}) {
        const Vector u = exact.u + off * random.vector(exact.u.size()),
                     l = admissible(p.laws, exact.l + off * random.vector(exact.l.size()));
        expect_bounds(p, u, l, exact);
        ++problems;
      }
    }
  EXPECT_EQ(problems, 1500);
}

/// Any sums of multipliers, where the last node that does not press has no function.
TEST(Certificate, BoundsLinearOutputs) {
  Random random(8);
  int told = 0, far = 0, refused = 0;
  for (int k = 0; k < 300; ++k) {
    const Problem p = random_problem(random, 2 + k % 4, 14, 0);
    const Index n = p.nodes();
    const Answer exact = solve(p);
    const Matrix functions = lu_solve(p.a, p.b.transpose()), lifted = p.b * functions,
                 outputs = random.matrix(n, 3);
    for (const double off : {1e-6, 1e-3, 0.1}) {
      const Vector u = exact.u + off * random.vector(exact.u.size()),
                   l = admissible(p.laws, exact.l + off * random.vector(n).cwiseProduct(exact.l));
      const auto [bound, v] = certify(p, u, l);
      const Vector left = p.g - p.b * v;
      std::vector<int> own(n);
      std::iota(own.begin(), own.end(), 0);
      for (Index row = n - 1; row >= 0; --row)
        if (l[row] == 0) {
          own[row] = -1;
          break;
        }
      const auto bounds = linear_outputs(columns_of(lifted), n, own, l, left, outputs);
      if (!bounds && ++refused > 0) continue;
      for (Index c = 0; c < outputs.cols(); ++c) {
        const LinearOutput &one = (*bounds)[c];
        const double most =
            p.norm(functions * one.weights) * bound.multiplier + one.far * bound.gap;
        EXPECT_LE(std::abs(outputs.col(c).dot(exact.l - l)), most * (1 + 1e-9) + 1e-9);
        ++told;
        far += one.far > 0;
      }
    }
  }
  EXPECT_GE(told, 2000);
  EXPECT_GE(far, 1000);
  EXPECT_LE(refused, 100);
}

TEST(Certificate, LinearOutputsNeedAFunctionWhereSomethingPresses) {
  const Matrix b{{1, 0.1}, {0.1, 1}}, outputs = Matrix::Ones(2, 1);
  const std::vector<int> first{0, -1};
  EXPECT_TRUE(linear_outputs(columns_of(b), 2, first, Vector{{1, 0}}, Vector{{0, 1}}, outputs));
  EXPECT_FALSE(linear_outputs(columns_of(b), 2, first, Vector{{1, 0.5}}, Vector{{0, 0}}, outputs));
  EXPECT_FALSE(linear_outputs(columns_of(b), 2, first, Vector{{1, 0}}, Vector{{0, 0}}, outputs))
      << "it might";
}

/// Where nodes stick, too, although their slips have errors.
TEST(Certificate, IsSharpNearTheAnswer) {
  for (const double threshold : {0.0, 0.3}) {
    Random random(6);
    std::vector<double> effectivities;
    for (int k = 0; k < 100; ++k) {
      const Problem p = random_problem(random, 4, 14, threshold);
      const Answer exact = solve(p);
      // A multiplier where the gap is open costs what it works there: to first order; and so does
      // what it lacks of the bound where a node slips.
      Vector u = exact.u + 1e-3 * random.vector(exact.u.size()),
             l = exact.l + 1e-3 * exact.l.cwiseProduct(random.vector(exact.l.size()));
      for (Index row = p.nodes(); row < l.size(); ++row)
        if (std::abs(exact.l[row]) > threshold * (1 - 1e-9)) l[row] = exact.l[row];
      l = admissible(p.laws, l);
      const double both =
          std::hypot(p.norm(exact.u - u), p.dual_norm(p.b.transpose() * (exact.l - l)));
      effectivities.push_back(certify(p, u, l).bound.u / both);
    }
    std::ranges::sort(effectivities);
    EXPECT_LE(effectivities[effectivities.size() / 2], 1.5)
        << "over the errors of u and l together, threshold " << threshold;
  }
}

/// Of a sum of matrices with c >= 0 the norm over references is above the true one, and it where a
/// reference is the matrix itself.
TEST(Certificate, NormOverReferences) {
  Random random(7);
  for (int k = 0; k < 50; ++k) {
    const Matrix a1 = random_positive(random, 6, 1), a2 = random_positive(random, 6, 1);
    Matrix references(2, 3);
    references << 1, 1, 1, 0.2, 1, 5;
    const Vector r = random.vector(6);
    const auto norm = [&](double kappa) {
      return std::sqrt(r.dot(Vector(lu_solve(a1 + kappa * a2, r))));
    };
    const Vector norms = Vector{{norm(0.2), norm(1), norm(5)}};
    for (const double kappa : {0.2, 0.5, 1.0, 3.0, 5.0}) {
      const double bound = norm_over_references(references, Vector{{1.0, kappa}}, norms);
      EXPECT_GE(bound, norm(kappa) * (1 - 1e-12));
      EXPECT_LE(bound, 1.5 * norm(kappa));
      if (kappa == 1) EXPECT_NEAR(bound, norm(1), 1e-12 * bound);
      EXPECT_NEAR(norm_over_references(references, Vector{{2.0, 2 * kappa}}, norms),
                  bound / std::sqrt(2), 1e-12 * bound)
          << "scaled";
    }
    EXPECT_EQ(norm_over_references(references, Vector{{1.0, 5.1}}, norms),
              std::numeric_limits<double>::infinity());
    EXPECT_EQ(norm_over_references(references, Vector{{1.0, 0.5}}, Vector::Zero(3)), 0);
  }
}

std::optional<Lifting> lifted_by(const Matrix &b, const std::vector<int> &own, const Vector &s,
                                 const Vector &l) {
  return lift(columns_of(b), b.cols(), own, s, l, uniform_laws(b.rows(), 1, {}), 1e-15);
}

/// What is not lifted by a function of its own is raised, or it is said; mirror images share one.
TEST(Certificate, LiftsWhatItCan) {
  const Matrix b = Matrix{{2.0, 1.0}, {1.0, 2.0}, {0.5, -0.1}};
  const Vector l = Vector{{1.0, 0.0, 0.0}};
  const auto lifting = lifted_by(b, {0, 1, -1}, Vector{{-0.1, 0.2, -3.0}}, l);
  ASSERT_TRUE(lifting);
  EXPECT_NEAR((b * lifting->weights)[0], -0.1, 1e-14);
  EXPECT_EQ(lifting->left.head(2), Vector::Zero(2));
  const auto raised = lifted_by(b, {0, 1, -1}, Vector{{0.1, 0.2, 0.3}}, l);
  ASSERT_TRUE(raised);
  EXPECT_GT(raised->left.head(2).minCoeff(), 0) << "both rise with the third";
  EXPECT_GE(raised->left.minCoeff(), 0);
  EXPECT_FALSE(lifted_by(-b, {0, 1, -1}, Vector{{0.1, 0.2, 0.3}}, l)) << "the third stays below";
  const auto pair = lifted_by(Matrix{{2.0}, {2.0}}, {0, 0}, Vector{{0.1, 0.1}}, Vector{{1.0, 1.0}});
  ASSERT_TRUE(pair);
  EXPECT_NEAR(pair->weights[0], 0.05, 1e-15);
  EXPECT_EQ(pair->left, Vector::Zero(2));
}

} // namespace rbvi::certificate_test
