// Circles of boundaries that are named beside boundaries that are not, or are on other circles:
// against Hertz and Lame, and point by point.
#include "drawn_bodies.hpp"
#include "rbvi/mesh/serial.hpp"

#include <gtest/gtest.h>

namespace rbvi::round_and_flat_test {
namespace {

constexpr double pi = std::numbers::pi, young = 10, nu = 0.3;
constexpr double stiffness = young / (1 - nu * nu) / 2; // E* of two equal bodies

/// A scene of degree 2 on a drawing refined so many times.
Drawn refined_drawing(const std::string &physics, const std::string &text, SerialMesh mesh,
                      int times) {
  Drawn result{make_scene(read_case("rbvi: 1\nphysics: " + physics +
                                        "\nmesh: {file: drawing.msh, degree: 2}\n"
                                        "materials: {all: {at: all, E: " +
                                        (text.find("e: {range") != std::string::npos ? "e" : "10") +
                                        ", nu: 0.3}}\n" + text,
                                    "drawing.yaml")),
               {}};
  check_curves(mesh, result.scene, "the drawing");
  for (int k = 0; k < times; ++k) {
    mesh = refined(mesh);
    snap_curves(mesh, result.scene);
  }
  result.mesh = {"", 0, std::make_shared<const std::vector<SerialMesh>>(1, mesh)};
  return result;
}

/// The right half of a round body of radius 1 (boundaries top, axis, round) on one that is flat
/// (axis, flat, base); they touch at the origin.
SerialMesh round_on_flat() {
  const SerialMesh both = two_graded_quarter_discs(40);
  SerialMesh mesh;
  std::vector<int> number(both.points.size(), -1);
  for (const int cell : both.region.at("upper")) {
    std::array<int, 4> vertices{-1, -1, -1, -1};
    for (std::size_t i = 0; i < 3; ++i) {
      int &own = number[both.cells[cell][i]];
      if (own < 0) {
        own = static_cast<int>(mesh.points.size());
        mesh.points.push_back(both.points[both.cells[cell][i]] - Point{0, 0.5, 0});
      }
      vertices[i] = own;
    }
    mesh.cells.push_back(vertices);
  }
  for (const auto &[name, own] :
       std::map<std::string, std::string>{{"top", "top"}, {"axis", "axis"}, {"slave", "round"}})
    for (const auto &facet : both.boundary.at(name))
      if (number[facet[0]] >= 0)
        mesh.boundary[own].push_back({number[facet[0]], number[facet[1]], -1});
  add_grid(mesh, 36, 12,
           [](const Point &x) {
             return Point{1.5 * std::pow(x[0], 1.7), -1.2 * std::pow(1 - x[1], 1.7), 0};
           },
           {"base", "", "flat", "axis"});
  return mesh;
}

HfSolution pressed(const std::string &physics, const std::string &contact, double push, int times) {
  const std::string axis = physics == "axisymmetric" ? "" : "  axis: {at: axis, ux: 0}\n";
  return solve(refined_drawing(physics,
                               "parameters: {push: {range: [0.001, 0.1], default: 0.01}}\n"
                               "imposed:\n" +
                                   axis +
                                   "  top: {at: top, uy: -push}\n"
                                   "  base: {at: base, ux: 0, uy: 0}\n"
                                   "contact: {between: {" +
                                   contact +
                                   "}}\n"
                                   "curves: {round: {circle: [0, 1, 1]}}\n",
                               round_on_flat(), times),
               {push});
}

TEST(RoundAndFlat, APeakBetweenARollerAndAPlateIsThatOfHertz) {
  for (const auto &[contact, times] : {std::pair{"at: round, against: flat", 0},
                                       {"at: flat, against: round", 0},
                                       {"at: round, against: flat", 1}}) {
    const Outputs outputs = pressed("plane_strain", contact, 0.02, times).outputs;
    const double force = 2 * *outputs.normal_force;
    EXPECT_GT(*outputs.contact_nodes, 5);
    EXPECT_NEAR(*outputs.peak_pressure / std::sqrt(force * stiffness / pi), 1, 0.02)
        << contact << " " << times;
  }
}

TEST(RoundAndFlat, APeakBetweenASphereAndAPlateIsThatOfHertz) {
  const Outputs outputs = pressed("axisymmetric", "at: round, against: flat", 0.015, 0).outputs;
  const double peak = std::cbrt(6 * *outputs.normal_force * stiffness * stiffness / (pi * pi * pi));
  EXPECT_NEAR(*outputs.peak_pressure / peak, 1, 0.02);
}

/// Two disks that touch at the origin, each along so many edges; of the lower one they may stay
/// straight.
TEST(RoundAndFlat, OfTwoDisksOneMayBeNamedByHertz) {
  for (const std::string lower : {"", ", master: {circle: [0, -1, 1]}"}) {
    SerialMesh disks = two_graded_quarter_discs(60);
    for (Point &x : disks.points)
      x[1] += x[1] > 0 ? -0.5 : 0.5;
    const HfSolution s =
        solve(refined_drawing("plane_strain",
                              "parameters: {push: {range: [0.001, 0.05], default: 0.01}}\n"
                              "imposed:\n  axis: {at: axis, ux: 0}\n  top: {at: top, uy: -push}\n"
                              "  bottom: {at: bottom, uy: push}\n"
                              "contact: {between: {at: slave, against: master}}\n"
                              "curves: {slave: {circle: [0, 1, 1]}" +
                                  lower + "}\n",
                              disks, 0),
              {0.02});
    EXPECT_NEAR(*s.outputs.peak_pressure /
                    std::sqrt(2 * *s.outputs.normal_force * stiffness / (pi * 0.5)),
                1, 0.02)
        << lower;
  }
}

/// Two quarter rings whose circles are closer than their edges are to them.
SerialMesh press_fit(double shaft, double hole, int inside, int outside) {
  SerialMesh mesh;
  const auto ring = [](double low, double high) {
    return [=](const Point &x) {
      const double r = low + (high - low) * x[0], angle = pi / 2 * x[1];
      return Point{x[1] == 1 ? 0 : r * std::cos(angle), r * std::sin(angle), 0};
    };
  };
  add_grid(mesh, 5, inside, ring(0.5, shaft), {"x_axis", "shaft", "y_axis", ""});
  add_grid(mesh, 5, outside, ring(hole, 1.5), {"x_axis", "", "y_axis", "hole"});
  return mesh;
}

TEST(RoundAndFlat, APressFitHasThePressureOfLame) {
  const double plane = young / (1 - nu * nu), ratio = nu / (1 - nu), overlap = 1e-3;
  const auto wall = [](double a, double b) { return (b * b + a * a) / (b * b - a * a); };
  const double expected =
      overlap / (1 / plane * (wall(1, 1.5) + ratio) + 1 / plane * (wall(0.5, 1) - ratio));
  for (const int times : {0, 1}) {
    const HfSolution s = solve(refined_drawing("plane_strain",
                                               "parameters: {e: {range: [5, 20], default: 10}}\n"
                                               "imposed:\n  x: {at: x_axis, uy: 0}\n"
                                               "  y: {at: y_axis, ux: 0}\n"
                                               "contact: {fit: {at: shaft, against: hole}}\n"
                                               "curves: {shaft: {circle: [0, 0, 1.001]}, "
                                               "hole: {circle: [0, 0, 1], hole: yes}}\n",
                                               press_fit(1.001, 1, 17, 12), times),
                               {10});
    EXPECT_NEAR(*s.outputs.normal_force / (expected * pi / 2), 1, 0.01) << times;
    EXPECT_LE(std::abs(s.lambda.maxCoeff() / expected - 1), 0.03) << times;
  }
}

/// The lower side of a block: flat up to x = 0.5, on the circle of radius 2 about (0.5, 2) from
/// there on, a group of its own.
SerialMesh rounded_block() {
  SerialMesh mesh;
  add_grid(mesh, 8, 2,
           [](const Point &x) {
             const double beyond = std::max(x[0] - 0.5, 0.0);
             const double low = 2 - std::sqrt(4 - beyond * beyond);
             return Point{x[0], low + x[1] * (1 - low), 0};
           },
           {"foot", "", "top", ""});
  for (const auto &facet : mesh.boundary.at("foot"))
    if (mesh.points[facet[0]][0] >= 0.5) mesh.boundary["fillet"].push_back(facet);
  return mesh;
}

const std::string fillet = "parameters: {push: {range: [0.01, 0.1], default: 0.05}}\n"
                           "imposed:\n  top: {at: top, ux: 0, uy: -push}\n"
                           "curves: {fillet: {circle: [0.5, 2, 2]}}\n"
                           "contact: {floor: {at: foot, against: ";

double height_of_fillet(const Point &x) {
  const Point out = x - Point{0.5, 2, 0};
  return 2 + 2 / norm(out) * out[1];
}

TEST(RoundAndFlat, AFilletOfALongerBoundaryIsNamedByItself) {
  for (const std::string against : {"{plane: {normal: [0, -1], position: 0}}", "{level_set: y}"})
    for (const std::string more : {"", ", formulation: nitsche", ", gap_from: edges"}) {
      if (against.starts_with("{plane") && more.find("gap_from") != std::string::npos) continue;
      const Drawn block =
          refined_drawing("plane_strain", fillet + against + more + "}}\n", rounded_block(), 0);
      Problem problem(PETSC_COMM_WORLD, block.scene, block.mesh);
      const ContactInterface &interface = *problem.contact().interfaces.front();
      const FullMu mu = expand(block.scene.parameters, {0.05});
      for (int edge = 0; edge < 8; ++edge) {
        const auto low = [](double x) {
          return Point{x, 2 - std::sqrt(4 - std::pow(std::max(x - 0.5, 0.0), 2)), 0};
        };
        const Point middle = (low(edge / 8.0) + low((edge + 1) / 8.0)) / 2;
        const bool on_arc = edge >= 4 && more != ", gap_from: edges";
        EXPECT_NEAR(interface.constraint_at(mu, middle).gap + 0.05, // moved as a whole
                    on_arc ? height_of_fillet(middle) : middle[1], 1e-12)
            << against << more << " " << edge;
      }
    }
}

TEST(RoundAndFlat, MiddlesOfTwoBodiesAreThoseOfTheirOwnGroups) {
  SerialMesh mesh = rounded_block();
  add_grid(mesh, 5, 2,
           [](const Point &x) {
             return Point{x[0], x[1] - 1, 0};
           },
           {"base", "", "ground", ""});
  const Drawn bodies = refined_drawing(
      "plane_strain",
      "parameters: {push: {range: [0.01, 0.1], default: 0.05}}\n"
      "imposed:\n  top: {at: top, ux: 0, uy: -push}\n  base: {at: base, ux: 0, uy: 0}\n"
      "curves: {fillet: {circle: [0.5, 2, 2]}}\n"
      "contact: {floor: {at: foot, against: ground}}\n",
      mesh, 0);
  Problem problem(PETSC_COMM_WORLD, bodies.scene, bodies.mesh);
  const InterfaceMesh &curves = problem.contact().interfaces.front()->mesh();
  for (Index e = 0; e < curves.count(); ++e) {
    const int *nodes = curves.nodes_of(e);
    const Point straight = (curves.points[nodes[0]] + curves.points[nodes[1]]) / 2;
    const bool on_arc = nodes[0] < curves.parts[0] && straight[0] > 0.5;
    EXPECT_NEAR(curves.points[nodes[2]][1], on_arc ? height_of_fillet(straight) : straight[1],
                1e-15);
  }
}

} // namespace
} // namespace rbvi::round_and_flat_test
