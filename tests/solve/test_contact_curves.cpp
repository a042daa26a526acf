// Contact along curves that are no graphs over x: turned, upright, in pieces, closed; and two
// bodies with partners along averaged normals, with friction.
#include "drawn_bodies.hpp"
#include "rbvi/contact/pair.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace rbvi::contact_of_curves_test {
namespace {

const std::vector<double> angles{0, 37 * std::numbers::pi / 180, std::numbers::pi / 2,
                                 std::numbers::pi};

std::string text_of(double value) {
  std::ostringstream text;
  text << std::setprecision(17) << value;
  return text.str();
}

/// A block on another one, together (0, 1)^2, turned about the origin. `slope`: of the interface,
/// from y = 0.4; `nx`: edges of the upper and of the lower block along it.
SerialMesh two_blocks_at(double angle, double slope, std::array<int, 2> nx, double offset = 0) {
  SerialMesh mesh;
  const auto top = [=](double x) { return 0.4 + slope * x; };
  add_grid(mesh, nx[0], 3,
           [&](const Point &x) {
             return turned_by(angle, {x[0], top(x[0]) + offset + x[1] * (1 - top(x[0])), 0});
           },
           {"slave", "sides", "top", "sides"});
  mesh.region["upper"].resize(mesh.cells.size());
  add_grid(mesh, nx[1], 2,
           [&](const Point &x) {
             return turned_by(angle, {x[0], x[1] * top(x[0]), 0});
           },
           {"bottom", "sides", "master", "sides"});
  return mesh;
}

/// What is said of the angle in a case.
std::string axes(double angle) {
  return "let:\n  ca: cos(" + text_of(angle) + ")\n  sa: sin(" + text_of(angle) + ")\n";
}

constexpr double lambda = 15 * 0.35 / (1.35 * 0.3), shear = 15 / 2.7;
const std::string rubber = "materials: {rubber: {at: all, E: 15, nu: 0.35}}\n";

/// Under equal strains in all directions the pressure is constant along any interface.
TEST(NormalPairing, CarriesAConstantPressureAlongAnyInterface) {
  for (const double angle : angles)
    for (const double slope : {0.0, 0.35})
      for (const std::array<int, 2> &nx : {std::array{6, 6}, {6, 5}, {5, 8}})
        for (const std::string space : {"p0", "p1"})
          for (const int degree : {1, 2}) {
            if (degree == 2 && nx[0] == nx[1]) continue;
            const Drawn blocks =
                drawn("parameters: {strain: {range: [0.001, 0.1], default: 0.01}}\n" + rubber +
                          "imposed:\n  top: {at: top, ux: -strain*x, uy: -strain*y}\n"
                          "  bottom: {at: bottom, ux: -strain*x, uy: -strain*y}\n"
                          "loads: {sides: {at: sides, pressure: " +
                          text_of(2 * (lambda + shear)) +
                          "*strain}}\n"
                          "contact: {between: {at: slave, against: master, multiplier: " +
                          space + "}}\n",
                      two_blocks_at(angle, slope, nx), degree);
            const HfSolution s = solve(blocks, {0.02});
            const double pressure = 2 * (lambda + shear) * 0.02;
            EXPECT_LE((s.lambda.array() - pressure).abs().maxCoeff(), 1e-11 * pressure)
                << angle << " " << slope << " " << space << " " << degree;
            EXPECT_LE(*s.outputs.max_penetration, 1e-13);
            EXPECT_NEAR(*s.outputs.normal_force, pressure * std::hypot(1, slope), 1e-11);
          }
}

/// The exact stress of both blocks as one, or where they slip: constant.
std::string sheared(double angle, const std::string &more) {
  return "parameters:\n  shear: {range: [-0.3, 0.3], default: 0.05}\n"
         "  friction: {range: [0, 1], default: 0.3}\n" +
         axes(angle) + "  depth: 0.02\n  most: friction*" + text_of(lambda + 2 * shear) +
         "*depth\n  stress: max(-most, min(most, " + text_of(shear) + "*shear))\n" + rubber +
         "imposed:\n  top: {at: top, ux: shear*ca + depth*sa, uy: shear*sa - depth*ca}\n"
         "  bottom: {at: bottom, ux: 0, uy: 0}\n"
         "loads: {sides: {at: sides, traction: [(nx*ca + ny*sa)*(-" +
         text_of(lambda) + "*depth*ca - stress*sa), (nx*ca + ny*sa)*(-" + text_of(lambda) +
         "*depth*sa + stress*ca)]}}\n"
         "contact: {between: {at: slave, against: master, " +
         more + "}}\n";
}

/// Below the bound the blocks are as one, above it the stress is the bound.
TEST(FrictionOfTwoBodies, SticksAsOneBodyAndSlidesAtItsBound) {
  const double pressure = (lambda + 2 * shear) * 0.02;
  for (const double angle : angles)
    for (const std::array<int, 2> &nx : {std::array{6, 6}, {6, 5}})
      for (const std::string space : {"p0", "p1"})
        for (const std::string law : {"{coulomb: friction}", "{tresca: 'most'}"})
          for (const double moved : {0.02, -0.2}) {
            const Drawn blocks =
                drawn(sheared(angle, "multiplier: " + space + ", friction: " + law),
                      two_blocks_at(angle, 0, nx));
            Problem problem(PETSC_COMM_WORLD, blocks.scene, blocks.mesh);
            const HfSolution s = HighFidelity(problem, {}).solve({moved, 0.3});
            const double stress = std::clamp(shear * moved, -0.3 * pressure, 0.3 * pressure);
            const Index count = s.lambda.size() / 2;
            EXPECT_LE((s.lambda.head(count).array() - pressure).abs().maxCoeff(), 1e-11 * pressure);
            EXPECT_LE((s.lambda.tail(count).array() - stress).abs().maxCoeff(), 1e-11 * pressure)
                << angle << space << law;
            EXPECT_NEAR(*s.outputs.tangential_force, std::abs(stress), 1e-11);
            EXPECT_NEAR(*s.outputs.stick_half_width, moved > 0 ? 0.5 : 0, 1e-12);
            EXPECT_NEAR(*s.outputs.reaction, pressure * std::cos(angle) - stress * std::sin(angle),
                        1e-11);
            EXPECT_NEAR(*s.outputs.horizontal_reaction,
                        -pressure * std::sin(angle) - stress * std::cos(angle), 1e-11);
            if (moved < 0) continue;
            const Mesh &mesh = problem.mesh();
            for (std::size_t v = 0; v < mesh.points.size(); ++v) { // glued
              const Point x = turned_by(-angle, mesh.points[v]);
              const Point u = turned_by(angle, {moved * x[1], -0.02 * x[1], 0});
              for (int c = 0; c < 2; ++c)
                EXPECT_NEAR(s.u[mesh.natural_node[v] * 2 + c], u[c], 1e-13);
            }
          }
}

/// Where the first boundary reaches beyond the second one, or faces nothing at all, it is free:
/// condensed and eliminated, from a coarser start too.
TEST(FrictionOfTwoBodies, EndsWhereNoPartnerIs) {
  for (const std::string law : {"{coulomb: 0.3}", "{tresca: 0.1}"})
    for (const std::string space : {"p0", "p1"})
      for (const auto &[width, shift] : {std::pair{0.55, 0.0}, {1.0, -1.5}}) { // of the lower body
        std::vector<Outputs> outputs;
        for (const HfContact how : {HfContact::condensed, HfContact::eliminated}) {
          Scene scene = make_scene("patch");
          scene.motion = [](const FullMu &mu, const Point &x) {
            return x[1] > 0 ? Point{0.03, -mu[0], 0} : Point{};
          };
          scene.map = [width, shift](const FullMu &, const Point &x) {
            return x[1] > 0 ? Point{x[0], x[1] - 0.25, 0}
                            : Point{width * x[0] + shift, x[1] + 0.25, 0};
          };
          const bool coulomb = law.starts_with("{coulomb");
          scene.contacts = {
              two_bodies({"slave",
                          "master",
                          {space == "p0" ? MultiplierSpace::macro_edges : MultiplierSpace::nodes},
                          false,
                          {coulomb ? FrictionLaw::coulomb : FrictionLaw::tresca,
                           [coulomb](const FullMu &) { return coulomb ? 0.3 : 0.1; }}})};
          scene.a = {mapped_term(elasticity("", lame(15, 0.35), 1))};
          HfOptions options;
          options.contact = how;
          outputs.push_back(solve({scene, {"", 1}}, {0.06}, options).outputs);
        }
        EXPECT_NEAR(*outputs[0].normal_force, *outputs[1].normal_force, 1e-11);
        EXPECT_NEAR(*outputs[0].tangential_force, *outputs[1].tangential_force, 1e-11);
        EXPECT_EQ(*outputs[0].contact_nodes > 0, shift == 0);
        EXPECT_LE(*outputs[0].contact_measure, 0.62);
      }
}

/// A drawn scene at some angle, and its answer.
using AtAngle = std::function<HfSolution(double angle)>;

/// The multipliers, and the displacements turned back, do not depend on the angle. `along_x`:
/// upside down the curve runs the other way.
void expect_the_same_at_all_angles(const AtAngle &answer, const std::string &what, bool along_x) {
  const HfSolution first = answer(0);
  for (const double angle : angles) {
    if (angle == 0) continue;
    HfSolution s = answer(angle);
    const Index half = s.lambda.size() / 2;
    if (along_x && angle == angles.back())
      s.lambda << s.lambda.head(half).reverse().eval(), s.lambda.tail(half).reverse().eval();
    EXPECT_LE((s.lambda - first.lambda).norm(), 1e-10 * first.lambda.norm()) << what << angle;
    double worst = 0;
    for (Index i = 0; i < s.u.size(); i += 2) {
      const Point u = turned_by(-angle, {s.u[i], s.u[i + 1], 0});
      worst = larger(worst, std::abs(u[0] - first.u[i]));
      worst = larger(worst, std::abs(u[1] - first.u[i + 1]));
    }
    EXPECT_LE(worst, 1e-10 * first.u.cwiseAbs().maxCoeff()) << what << angle;
    for (const auto output : {&Outputs::energy, &Outputs::normal_force, &Outputs::tangential_force,
                              &Outputs::contact_measure, &Outputs::stick_half_width})
      EXPECT_NEAR((s.outputs.*output).value_or(0), (first.outputs.*output).value_or(0), 1e-10)
          << what;
  }
}

const std::string pushed =
    "imposed:\n  top: {at: top, ux: shear*ca + depth*sa, uy: shear*sa - depth*ca}"
    "\n  bottom: {at: bottom, ux: 0, uy: 0}\n";
const std::string shears = "parameters:\n  shear: {range: [0, 0.3], default: 0.05}\n";

/// Free sides, so that a part of the interface slips or opens; matching or not; an open gap.
TEST(FrictionOfTwoBodies, IsTheSameWhereverAllIsTurned) {
  for (const std::string more : {"multiplier: p0", "multiplier: p1"})
    for (const int degree : {1, 2})
      expect_the_same_at_all_angles(
          [&](double angle) {
            return solve(drawn(shears + axes(angle) + "  depth: 0.05\n" + rubber + pushed +
                                   "contact: {between: {at: slave, against: master, friction: "
                                   "{coulomb: 0.2}, " +
                                   more + "}}\n",
                               two_blocks_at(angle, 0.2, {8, 7}, 0.01), degree),
                         {0.03});
          },
          more, false);
}

/// Where the bodies now are.
TEST(NormalPairing, OfDeformedBodiesIsTheSameWhereverAllIsTurned) {
  for (const std::string space : {"p0", "p1"})
    expect_the_same_at_all_angles(
        [&](double angle) {
          return solve(drawn(shears + axes(angle) + "  depth: 0.05\n" + rubber + pushed +
                                 "contact: {between: {at: slave, against: master, kinematics: "
                                 "large, multiplier: " +
                                 space + "}}\n",
                             two_blocks_at(angle, 0.2, {8, 7}, 0.01), 2),
                       {0.03});
        },
        space, false);
}

/// One block on a plane, by multipliers and by Nitsche's method.
TEST(RigidContact, IsTheSameWhereverAllIsTurned) {
  for (const std::string more : {"", ", formulation: nitsche", ", lumped: yes"})
    expect_the_same_at_all_angles(
        [&](double angle) {
          SerialMesh mesh;
          add_grid(mesh, 8, 4,
                   [&](const Point &x) {
                     return turned_by(angle, {x[0], x[1] / 2, 0});
                   },
                   {"foot", "", "top", ""});
          const Point n = turned_by(angle, {0, -1, 0});
          return solve(drawn(shears + axes(angle) + "  depth: 0.05\n" + rubber +
                                 "imposed: {top: {at: top, ux: shear*ca + depth*sa, uy: shear*sa - "
                                 "depth*ca}}\n"
                                 "contact: {floor: {at: foot, friction: {coulomb: 0.2}, against: "
                                 "{plane: {normal: [" +
                                 text_of(n[0]) + ", " + text_of(n[1]) + "], position: 0}}" + more +
                                 "}}\n",
                             mesh),
                       {0.03});
        },
        more, true);
}

/// A ring with its outer rim moved outwards, or turned, on a disk in its hole, which it is too
/// narrow for: the mesh is the same after a turn by one edge, and so are the pressures.
TEST(RigidContact, OnAClosedCurveIsTheSameAllAround) {
  for (const std::string more :
       {"", "friction: {coulomb: 0.2}, ", "formulation: nitsche, friction: {tresca: 0.05}, "}) {
    SerialMesh mesh;
    add_grid(
        mesh, 16, 3,
        [](const Point &x) {
          return turned_by(-2 * std::numbers::pi * x[0], {1 + x[1], 0, 0});
        },
        {"hub", "", "rim", ""}, true);
    const HfSolution s =
        solve(drawn("parameters: {turn: {range: [0, 1], default: 0.01}}\n" + rubber +
                        "imposed: {rim: {at: rim, ux: -turn*y, uy: turn*x}}\n"
                        "contact: {shaft: {at: hub, normal: rigid, " +
                        more + "against: {disk: {center: [0, 0], radius: 1.05}}}}\n",
                    mesh),
              {0.01});
    const Index count = 16;
    ASSERT_EQ(s.lambda.size(), more.empty() ? count : 2 * count) << "one node a vertex";
    for (Index first = 0; first < s.lambda.size(); first += count) {
      const auto around = s.lambda.segment(first, count);
      EXPECT_LE(around.maxCoeff() - around.minCoeff(), 1e-11 * s.lambda.maxCoeff()) << more;
    }
    EXPECT_GT(s.lambda.head(count).minCoeff(), 0);
    if (!more.empty()) {
      EXPECT_GT(s.lambda.tail(count).cwiseAbs().minCoeff(), 0) << more;
    }
    EXPECT_FALSE(s.outputs.ends_in_contact || s.outputs.centre_pressure) << more;
    EXPECT_NEAR(*s.outputs.reaction, 0, 1e-11) << more;
  }
}

/// A ring shrunk onto another one: closed curves of 24 and of 16 edges.
TEST(NormalPairing, OfTwoRingsIsTheSameAllAround) {
  for (const std::string space : {"p0", "p1"})
    for (const std::string how : {"friction: {coulomb: 0.1}", "kinematics: large"}) {
      SerialMesh mesh;
      const auto ring = [](double from) {
        return [from](const Point &x) {
          return turned_by(-2 * std::numbers::pi * x[0], {from + x[1], 0, 0});
        };
      };
      add_grid(mesh, 24, 3, ring(2), {"hub", "", "rim", ""}, true);
      add_grid(mesh, 16, 3, ring(1), {"bore", "", "shaft", ""}, true);
      const HfSolution s =
          solve(drawn("parameters: {shrink: {range: [0, 0.1], default: 0.01}}\n" + rubber +
                          "imposed:\n  rim: {at: rim, ux: -shrink*x, uy: -shrink*y}\n"
                          "  bore: {at: bore, ux: 0, uy: 0}\n"
                          "contact: {fit: {at: hub, against: shaft, " +
                          how + ", multiplier: " + space + "}}\n",
                      mesh),
                {0.05});
      const Index count = s.lambda.size() / (how.starts_with("f") ? 2 : 1);
      ASSERT_EQ(count, space == "p0" ? 12 : 24);
      EXPECT_GT(s.lambda.head(count).minCoeff(), 0);
      // The meshes are the same after turns of 45 degrees, their macro-edges after one of 90.
      for (Index i = 0; i < count; ++i)
        EXPECT_NEAR(s.lambda[i], s.lambda[(i + 3) % count], 1e-11 * s.lambda.maxCoeff());
      EXPECT_EQ(*s.outputs.ends_in_contact, 0);
      EXPECT_NEAR(*s.outputs.reaction, 0, 1e-10);
    }
}

/// Two feet as one boundary, or as two.
SerialMesh two_feet(bool apart) {
  SerialMesh mesh;
  add_grid(mesh, 9, 4,
           [](const Point &x) {
             return Point{x[0], x[1] / 2, 0};
           },
           {"foot", "", "top", ""});
  const auto feet = mesh.boundary.at("foot");
  mesh.boundary.erase("foot");
  for (const auto &facet : feet) {
    const double x = mesh.points[facet[0]][0];
    if (x < 0.3)
      mesh.boundary[apart ? "left" : "foot"].push_back(facet);
    else if (x > 0.6)
      mesh.boundary[apart ? "right" : "foot"].push_back(facet);
  }
  std::ranges::reverse(mesh.boundary.begin()->second); // the order of facets does not matter
  return mesh;
}

TEST(RigidContact, OfABoundaryInTwoPiecesIsThatOfTwoBoundaries) {
  for (const std::string more : {"", ", friction: {coulomb: 0.2}", ", lumped: yes",
                                 ", formulation: nitsche, friction: {coulomb: 0.2}"}) {
    const std::string against = "against: {plane: {normal: [0, -1], position: 0}}" + more + "}";
    const std::string head = shears + "let: {depth: 0.05}\n" + rubber +
                             "imposed: {top: {at: top, ux: shear, uy: -depth*(1 + x)}}\ncontact:\n";
    const HfSolution one = solve(drawn(head + "  foot: {at: foot, " + against, two_feet(false)),
                                 {0.03}),
                     two = solve(drawn(head + "  left: {at: left, " + against +
                                           "\n  right: {at: "
                                           "right, " +
                                           against,
                                       two_feet(true)),
                                 {0.03});
    EXPECT_LE((one.u - two.u).norm(), 1e-12 * two.u.norm()) << more;
    const bool friction = more.find("friction") != std::string::npos;
    const Index n = one.lambda.size() / (friction ? 4 : 2); // of one foot
    Vector together = two.lambda;
    if (friction)
      together << two.lambda.head(n), two.lambda.segment(2 * n, n), two.lambda.segment(n, n),
          two.lambda.tail(n);
    EXPECT_LE((one.lambda - together).norm(), 1e-12 * together.norm()) << more;
    for (const auto output : {&Outputs::energy, &Outputs::normal_force, &Outputs::contact_measure,
                              &Outputs::reaction, &Outputs::peak_pressure})
      EXPECT_NEAR((one.outputs.*output).value(), (two.outputs.*output).value(), 1e-12) << more;
    EXPECT_FALSE(one.outputs.centre_pressure) << "it has no middle";
  }
}

/// Other numbers of facets, and other directions, change nothing.
TEST(NormalPairing, TheOrderOfFacetsDoesNotMatter) {
  SerialMesh mesh = two_blocks_at(0.5, 0.2, {8, 7}, 0.01), mixed = mesh;
  for (auto &[name, facets] : mixed.boundary) {
    for (std::size_t i = 0; i < facets.size(); i += 2)
      std::swap(facets[i][0], facets[i][1]);
    std::ranges::rotate(facets, facets.begin() + std::ssize(facets) / 2);
  }
  const auto answer = [&](const SerialMesh &of) {
    return solve(drawn(shears + axes(0.5) + "  depth: 0.05\n" + rubber + pushed +
                           "contact: {between: {at: slave, against: master, friction: "
                           "{coulomb: 0.2}}}\n",
                       of),
                 {0.03});
  };
  const HfSolution one = answer(mesh), other = answer(mixed);
  EXPECT_EQ(one.lambda, other.lambda);
  EXPECT_EQ(one.u, other.u);
}

} // namespace
} // namespace rbvi::contact_of_curves_test
