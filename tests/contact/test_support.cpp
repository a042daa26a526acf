// Contact operators of a rigid support: exact on straight edges, against fine sums on curved ones,
// and by their symmetries.
#include "rbvi/core/error.hpp"
#include "support_scenes.hpp"

#include <gtest/gtest.h>

namespace rbvi::support_test {
namespace {

// Along a straight edge, by Simpson's rule: exact for cubic integrands.
TEST(Support, IntegratesPolynomialsExactlyOnAStraightBoundary) {
  Random random(1);
  Curve vertices = random_curve(random, 7, -0.4, 1.1, 0);
  for (Point &p : vertices)
    p[1] = 1 + 0.75 * p[0];
  const Point normal{0.6, -0.8, 0}, tangent{0.8, 0.6, 0};
  ASSERT_EQ(turned(normal), tangent);
  for (int degree : {1, 2})
    for (int power = 0; power <= degree; ++power) {
      const auto p = [power](const Point &x) { return std::pow(x[0] - 0.3, power); };
      Vector exact = Vector::Zero(size(vertices));
      for (std::size_t e = 0; e + 1 < vertices.size(); ++e) {
        const Point &a = vertices[e], &b = vertices[e + 1];
        const double h = length(vertices, static_cast<Index>(e)), m = 2 * p(between(a, b, 0.5));
        exact.segment<2>(static_cast<Index>(e)) += h / 6 * Vector{{p(a) + m, m + p(b)}};
      }
      const InterfaceMesh curve = support_curve(vertices, degree);
      const ContactOperators of = couple_with_support(support_scene(degree, normal), {1}, curve);
      const Vector push = of.b * nodal(curve, [&](const Point &x) {
                            return Point{p(x) * normal[0], p(x) * normal[1], 0};
                          });
      const Vector slide = of.b * nodal(curve, [&](const Point &x) {
                             return Point{p(x) * tangent[0], p(x) * tangent[1], 0};
                           });
      EXPECT_LT((push - (Vector(16) << exact, Vector::Zero(8)).finished()).norm(), 1e-15);
      EXPECT_LT((slide - (Vector(16) << Vector::Zero(8), exact).finished()).norm(), 1e-15);
      EXPECT_TRUE(power > 0 || (of.weights - exact).norm() < 1e-15);
    }
}

struct Dense {
  Matrix b;
  Vector g, weights;
};

/// By the middles of equal parts of each edge: the error is a multiple of 1 / parts^2.
Dense midpoint_sum(const SupportScene &scene, const FullMu &mu, const InterfaceMesh &curve,
                   int parts) {
  const Index count = vertices_of(curve);
  Dense sum{Matrix::Zero(2 * count, 2 * curve.nodes()), Vector::Zero(2 * count),
            Vector::Zero(count)};
  for (Index e = 0; e + 1 < count; ++e) {
    const Point &a = curve.points[e], &b = curve.points[static_cast<std::size_t>(e) + 1];
    const double h = length({scene.map(mu, a), scene.map(mu, b)}) / parts;
    for (int k = 0; k < parts; ++k) {
      const double s = (k + 0.5) / parts;
      const Point x = between(a, b, s), n = scene.support.normal(mu, x), tau = turned(n);
      const Point motion = scene.motion(mu, x);
      Vector eta = Vector::Zero(count), phi = Vector::Zero(curve.nodes());
      eta.segment<2>(e) << 1 - s, s;
      phi.head(count) = eta;
      if (scene.degree == 2) {
        phi.segment<2>(e) << (1 - s) * (1 - 2 * s), s * (2 * s - 1);
        phi[count + e] = 4 * s * (1 - s);
      }
      for (Index node : {e, e + 1, count + e})
        if (node < phi.size())
          for (Index c = 0; c < 2; ++c) {
            const auto d = static_cast<std::size_t>(c);
            sum.b.col(2 * node + c).segment<2>(e) += h * phi[node] * n[d] * eta.segment<2>(e);
            sum.b.col(2 * node + c).segment<2>(count + e) +=
                h * phi[node] * tau[d] * eta.segment<2>(e);
          }
      sum.g.head(count) += h * (scene.support.gap(mu, x) - dot(motion, n)) * eta;
      sum.g.tail(count) -= h * dot(motion, tau) * eta;
      sum.weights += h * eta;
    }
  }
  return sum;
}

// The four Gauss points leave errors of order h^6 to h^7.
TEST(Support, AgreesWithAFineSumOnACurvedBoundary) {
  Random random(2);
  for (int degree : {1, 2}) {
    const InterfaceMesh curve = support_curve(random_curve(random, 20, -0.5, 0.8, -0.3), degree);
    const SupportScene scene = crooked(degree);
    const FullMu mu{0.8};
    const ContactOperators got = couple_with_support(scene, mu, curve);
    const Dense coarse = midpoint_sum(scene, mu, curve, 100),
                fine = midpoint_sum(scene, mu, curve, 200);
    EXPECT_LT((Matrix(got.b) - (4 * fine.b - coarse.b) / 3).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((got.g - (4 * fine.g - coarse.g) / 3).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((got.weights - (4 * fine.weights - coarse.weights) / 3).cwiseAbs().maxCoeff(), 1e-14);
    expect_sorted(got.b);
    expect_sorted(got.nodal_b);
  }
}

TEST(Support, WeightsSumToTheMappedLengthAndRowsToTheForce) {
  const FullMu mu{1.7};
  for (int degree : {1, 2}) {
    const Curve vertices = arc(9, 0.6);
    const InterfaceMesh curve = support_curve(vertices, degree);
    const ContactOperators of = couple_with_support(hertz(degree), mu, curve);
    EXPECT_NEAR(of.weights.sum(), mu[0] * length(vertices), 1e-14);
    // int n . e_y over the polygon: at most O(h^2) from the arc's, - 2 R sin(angle)
    const Vector lift = nodal(curve, [](const Point &) { return Point{0, 1, 0}; });
    EXPECT_NEAR((of.b * lift).head(10).sum(), -2 * mu[0] * std::sin(0.6), 3e-3);
    EXPECT_NEAR((of.b * lift).tail(10).sum(), 0, 1e-14) << "tau_y is odd";
  }
}

TEST(Support, GrowsWithTheRadiusOfTheArc) {
  for (int degree : {1, 2}) {
    const InterfaceMesh curve = support_curve(arc(12, 0.5), degree);
    const ContactOperators one = couple_with_support(hertz(degree), {1}, curve);
    for (double radius : {0.3, 1.1, 2.0}) {
      const ContactOperators of = couple_with_support(hertz(degree), {radius}, curve);
      EXPECT_LT((of.b - radius * one.b).norm(), 1e-15 * radius * one.b.norm());
      EXPECT_LT((of.g - radius * radius * one.g).norm(), 1e-14 * of.g.norm());
      EXPECT_LT((of.weights - radius * one.weights).norm(), 1e-15 * of.weights.norm());
      EXPECT_EQ(Matrix(of.nodal_b), Matrix(one.nodal_b));
    }
  }
}

TEST(Support, TangentialRowsAreNormalRowsOfTheTurnedField) {
  Random random(3);
  for (int degree : {1, 2}) {
    const InterfaceMesh curve = support_curve(random_curve(random, 6, -0.5, 0.8, -0.3), degree);
    const ContactOperators of = couple_with_support(crooked(degree), {0.8}, curve);
    const Vector v = random.vector(of.b.cols());
    Vector back(v.size()); // v . tau = back . n
    for (Index i = 0; i < v.size(); i += 2)
      back.segment<2>(i) << v[i + 1], -v[i];
    EXPECT_LT(((of.b * v).tail(7) - (of.b * back).head(7)).norm(), 1e-15);
  }
}

TEST(Support, ATranslationIsSplitIntoItsNormalAndItsTangentialPart) {
  Random random(4);
  const Point normal{std::sin(0.3), -std::cos(0.3), 0}, shift{0.7, -1.9, 0};
  for (int degree : {1, 2}) {
    const InterfaceMesh curve = support_curve(random_curve(random, 5, 0, 1, 0), degree);
    const ContactOperators of = couple_with_support(support_scene(degree, normal), {1}, curve);
    const Vector moved = of.b * nodal(curve, [&](const Point &) { return shift; });
    EXPECT_LT((moved.head(6) - dot(shift, normal) * of.weights).norm(), 1e-15);
    EXPECT_LT((moved.tail(6) - dot(shift, turned(normal)) * of.weights).norm(), 1e-15);
  }
}

TEST(Support, MotionIsADisplacementOnTheOtherSide) {
  Random random(5);
  const FullMu mu{0.8};
  for (int degree : {1, 2}) {
    const InterfaceMesh curve = support_curve(random_curve(random, 6, -0.5, 0.8, -0.3), degree);
    SupportScene scene = crooked(degree);
    scene.motion = nullptr;
    const ContactOperators still = couple_with_support(scene, mu, curve);
    EXPECT_EQ(still.g.tail(7).norm(), 0) << "no slip";
    for (const PointField &motion : {PointField([](const Point &) {
                                       return Point{0.3, -0.2, 0};
                                     }),
                                     PointField([](const Point &x) {
                                       return Point{x[1], 1 - x[0], 0};
                                     })}) {
      scene.motion = [&motion](const FullMu &, const Point &x) { return motion(x); };
      const ContactOperators of = couple_with_support(scene, mu, curve);
      const Vector at_nodes = nodal(curve, motion);
      EXPECT_LT((of.g - (still.g - still.b * at_nodes)).norm(), 1e-14);
      EXPECT_LT((of.nodal_gap - (still.nodal_gap - still.nodal_b * at_nodes)).norm(), 1e-15);
      EXPECT_EQ(Matrix(of.b), Matrix(still.b));
    }
  }
}

// The mirror image of node i is node mirror(i); fields that are their own image are
// (-x component, y component) there.
TEST(Support, MirrorImagesHaveEqualNormalAndOppositeTangentialRows) {
  for (int degree : {1, 2})
    for (Index edges : {1, 6, 7}) {
      const InterfaceMesh curve = support_curve(arc(edges, 0.7), degree);
      SupportScene scene = hertz(degree);
      scene.motion = [](const FullMu &, const Point &x) {
        return Point{0.2 * x[0], -0.1 - x[0] * x[0], 0};
      };
      const ContactOperators of = couple_with_support(scene, {1.3}, curve);
      const Vector v = of.b * nodal(curve, [](const Point &x) {
                         return Point{std::sin(x[0]), x[1] + std::cos(x[0]), 0};
                       });
      const Index count = edges + 1;
      for (const Vector &rows : {v, of.g}) {
        const Vector pressure = rows.head(count), slip = rows.tail(count);
        EXPECT_LT((pressure - pressure.reverse()).cwiseAbs().maxCoeff(), 1e-14);
        EXPECT_LT((slip + slip.reverse()).cwiseAbs().maxCoeff(), 1e-14);
      }
      EXPECT_LT((of.weights - of.weights.reverse()).cwiseAbs().maxCoeff(), 1e-14);
      EXPECT_LT((of.nodal_gap - of.nodal_gap.reverse()).cwiseAbs().maxCoeff(), 1e-14);
    }
}

TEST(Support, NodalOperatorsAreThoseOfTheVertices) {
  Random random(6);
  const FullMu mu{0.8};
  for (int degree : {1, 2}) {
    const InterfaceMesh curve = support_curve(random_curve(random, 6, -0.5, 0.8, -0.3), degree);
    const SupportScene scene = crooked(degree);
    const ContactOperators of = couple_with_support(scene, mu, curve);
    ASSERT_EQ(of.nodal_b.rows(), 7);
    ASSERT_EQ(of.nodal_b.cols(), 2 * curve.nodes());
    const Vector v = random.vector(of.nodal_b.cols()), pushed = of.nodal_b * v;
    for (Index i = 0; i < 7; ++i) {
      const Point &x = curve.points[i];
      const Point n = scene.support.normal(mu, x);
      EXPECT_NEAR(pushed[i], dot(n, {v[2 * i], v[2 * i + 1], 0}), 1e-15);
      EXPECT_NEAR(of.nodal_gap[i], scene.support.gap(mu, x) - dot(n, scene.motion(mu, x)), 1e-15);
    }
  }
}

TEST(Support, WithoutFrictionThereAreOnlyNormalRows) {
  Random random(7);
  for (int degree : {1, 2}) {
    const InterfaceMesh curve = support_curve(random_curve(random, 6, -0.5, 0.8, -0.3), degree);
    SupportScene scene = crooked(degree);
    EXPECT_EQ(dual_of(scene, curve).size(), 14);
    const ContactOperators with = couple_with_support(scene, {0.8}, curve);
    const Matrix product = dual_of(scene, curve).gram;
    scene.support.friction.law = FrictionLaw::tresca;
    EXPECT_EQ(dual_of(scene, curve).size(), 14);
    scene.support.friction = {};
    EXPECT_EQ(dual_of(scene, curve).size(), 7);
    const ContactOperators without = couple_with_support(scene, {0.8}, curve);
    EXPECT_EQ(Matrix(without.b), Matrix(with.b).topRows(7));
    EXPECT_EQ(without.g, with.g.head(7));
    EXPECT_EQ(without.weights, with.weights);
    EXPECT_EQ(Matrix(dual_of(scene, curve).gram), product.topLeftCorner(7, 7));
    expect_sorted(without.b);
  }
}

TEST(SupportMultipliers, ProductIsTheMassMatrixOfEachBlock) {
  Random random(8);
  for (Index edges : {1, 2, 5}) {
    const Curve vertices = random_curve(random, edges, -0.5, 0.8, -0.3);
    const InterfaceMesh curve = support_curve(vertices, 2);
    const SparseMatrix product = dual_of(support_scene(2), curve).gram;
    const Index count = edges + 1;
    Matrix mass = Matrix::Zero(count, count);
    for (Index e = 0; e < edges; ++e)
      mass.block<2, 2>(e, e) += length(vertices, e) / 6 * Matrix{{2, 1}, {1, 2}};
    const Matrix dense = product;
    EXPECT_LT((dense.topLeftCorner(count, count) - mass).norm(), 1e-15);
    EXPECT_LT((dense.bottomRightCorner(count, count) - mass).norm(), 1e-15);
    EXPECT_EQ(dense.topRightCorner(count, count).norm(), 0);
    EXPECT_EQ(dense.bottomLeftCorner(count, count).norm(), 0);
    EXPECT_EQ(product.nonZeros(), 2 * (3 * count - 2)) << "neighbours";
    expect_sorted(product);
  }
}

std::string message(Status status, const SupportScene &scene, const InterfaceMesh &curve) {
  try {
    couple_with_support(scene, {0.8}, curve);
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), status) << error.what();
    return error.what();
  }
  return "";
}

TEST(Support, RefusesWhatIsNoCurveOrNotOfItsDegree) {
  const SupportScene linear = support_scene(1), quadratic = support_scene(2);
  const Curve good = line(4, 0, 1, 0);
  const auto refusal = [](const SupportScene &scene, const InterfaceMesh &curve) {
    return message(Status::bad_input, scene, curve);
  };
  const auto contains = [](const std::string &text, const std::string &part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(refusal(quadratic, support_curve(good, 2)), "");
  EXPECT_TRUE(contains(refusal(linear, support_curve({}, 1)), "at least one edge"));
  EXPECT_TRUE(contains(refusal(linear, support_curve({good[0]}, 1)), "at least one edge"));
  InterfaceMesh even = support_curve(good, 2), other_degree = support_curve(good, 1),
                scalar = support_curve(good, 1);
  even.parts = {8};
  EXPECT_TRUE(contains(refusal(quadratic, even), "8 nodes of degree 2"));
  other_degree.degree = 2;
  EXPECT_TRUE(contains(refusal(quadratic, other_degree), "at least one edge"));
  scalar.components = 1;
  EXPECT_TRUE(contains(refusal(linear, scalar), "two components"));
  Curve twice = good, undefined = good;
  twice[2] = twice[1];
  undefined[4][0] = std::nan("");
  for (const auto &[curve, edge] : {std::pair{twice, "edge 1"}, {undefined, "edge 3"}})
    EXPECT_TRUE(contains(message(Status::failed, linear, support_curve(curve, 1)), edge));
}

TEST(Support, NamesTheParameterWhoseMapLeavesNoEdge) {
  SupportScene scene = support_scene(2);
  const InterfaceMesh curve = support_curve(line(4, 0, 1, 0), 2);
  for (const PointField &map : {PointField([](const Point &) {
                                  return Point{0.5, 0.5, 0};
                                }),
                                PointField([](const Point &x) {
                                  return Point{std::max(x[0], 0.5), 0, 0};
                                }),
                                PointField([](const Point &) {
                                  return Point{std::nan(""), 0, 0};
                                })}) {
    scene.map = [&map](const FullMu &, const Point &x) { return map(x); };
    const std::string text = message(Status::failed, scene, curve);
    EXPECT_NE(text.find("edge 0"), std::string::npos) << text;
    EXPECT_NE(text.find("size=0.8"), std::string::npos) << text;
  }
}

/// Vertex quadrature: the rows of a vertex have its own displacement alone, times its weight.
TEST(Support, VertexQuadratureIsNodal) {
  for (int degree : {1, 2}) {
    const InterfaceMesh curve = support_curve(arc(9, 0.4), degree);
    SupportScene scene = crooked(degree);
    const FullMu mu{0.8};
    const ContactOperators whole = couple_with_support(scene, mu, curve);
    scene.support.lumped = true;
    const ContactOperators of = couple_with_support(scene, mu, curve);
    EXPECT_LT((of.weights - whole.weights).norm(), 1e-14 * whole.weights.norm());
    const Index vertices = vertices_of(curve);
    Matrix b = Matrix::Zero(2 * vertices, 2 * curve.nodes());
    Vector g(2 * vertices);
    for (Index i = 0; i < vertices; ++i) {
      const Point &x = curve.points[i];
      const Point n = scene.support.normal(mu, x), tau = turned(n), motion = scene.motion(mu, x);
      b.row(i).segment<2>(2 * i) << of.weights[i] * n[0], of.weights[i] * n[1];
      b.row(vertices + i).segment<2>(2 * i) << of.weights[i] * tau[0], of.weights[i] * tau[1];
      g[i] = of.weights[i] * (scene.support.gap(mu, x) - dot(motion, n));
      g[vertices + i] = -of.weights[i] * dot(motion, tau);
    }
    EXPECT_LT((Matrix(of.b) - b).norm(), 1e-14 * b.norm());
    EXPECT_LT((of.g - g).norm(), 1e-14 * g.norm());
  }
}

TEST(Support, FieldsHaveTheNormalAndTheGapThatIsLeft) {
  SupportScene scene = support_scene(1);
  scene.support.normal = [](const FullMu &, const Point &x) {
    return Point{x[0] / norm(x), x[1] / norm(x), 0};
  };
  scene.support.gap = [](const FullMu &mu, const Point &x) { return mu[0] - norm(x); };
  const InterfaceMesh curve = support_curve(arc(6, 0.4), 1);
  const auto interface = rigid_support(scene.support).make(scene, curve);
  const Vector u = Vector::Constant(2 * curve.nodes(), 0.1), lambda = Vector::Zero(14);
  const Grid grid = interface->fields({1.5}, u, lambda, false);
  ASSERT_EQ(grid.of_nodes[1].name, "gap");
  ASSERT_EQ(grid.of_nodes[2].name, "normal");
  for (Index i = 0; i < curve.nodes(); ++i) {
    const Point &x = curve.points[i];
    const double along = 0.1 * (x[0] + x[1]) / norm(x);
    EXPECT_NEAR(grid.of_nodes[1].values[i], 1.5 - norm(x) - along, 1e-15);
    EXPECT_NEAR(grid.of_nodes[2].values[3 * i + 1], x[1] / norm(x), 1e-15);
  }
}

} // namespace
} // namespace rbvi::support_test
