// What small kinematics leave out: gaps of displaced points in closed form, strains, and who tells.
#include "drawn_bodies.hpp"

#include "rbvi/core/warnings.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::small_kinematics_test {
namespace {

SerialMesh block() {
  SerialMesh mesh;
  add_grid(mesh, 40, 8,
           [](const Point &x) {
             return Point{x[0], x[1] / 2, 0};
           },
           {"foot", "", "top", ""});
  return mesh;
}

Drawn block_on(const std::string &against, const std::string &more = "") {
  return drawn("parameters:\n  push: {range: [-0.2, 0.2], default: 0.001}\n"
               "  shift: {range: [0, 0.5], default: 0}\n"
               "materials: {rubber: {at: all, E: 15, nu: 0.35}}\n"
               "imposed:\n  top: {at: top, ux: shift, uy: -push}\n"
               "contact: {bump: {at: foot, against: {" +
                   against + "}}}\n" + more,
               block(), 2);
}

const std::string bump = "disk: {center: [0.5, -0.5], radius: 0.5}";

/// The error of linear gaps to a disk, of points that all touch and are moved alike.
double expected(const std::vector<Point> &points, const Point &centre, double radius,
                const Point &moved) {
  double error = 0, way = 0;
  for (const Point &x : points) {
    const Point out = x - centre;
    const double along = dot(out, moved) / norm(out);
    error = std::max(error, std::abs(norm(out + moved) - norm(out) - along));
    way = std::max(way, std::abs(along));
  }
  EXPECT_GT(radius, 0);
  return error / way;
}

Vector moved_alike(const ContactInterface &interface, const Point &first, const Point &second) {
  const InterfaceMesh &mesh = interface.mesh();
  Vector u(2 * mesh.nodes());
  for (Index node = 0; node < mesh.nodes(); ++node) {
    const Point &by = node < mesh.parts[0] ? first : second;
    u.segment<2>(2 * node) << by[0], by[1];
  }
  return u;
}

TEST(SmallKinematics, GapsToADiskAreOffByWhatTheDisplacedPointsSay) {
  const Drawn body = block_on(bump);
  Problem problem(PETSC_COMM_WORLD, body.scene, body.mesh);
  const ContactInterface &interface = *problem.contact().interfaces.front();
  const FullMu mu = expand(body.scene.parameters, {0, 0});
  const Vector pressed = Vector::Ones(interface.dual().size());
  for (const Point &moved : {Point{0.1, -0.02, 0}, {0.01, 0, 0}, {0, -0.1, 0}})
    EXPECT_NEAR(interface.gap_error(mu, moved_alike(interface, moved, {}), pressed),
                expected(interface.dual().points, {0.5, -0.5, 0}, 0.5, moved), 1e-12);
}

TEST(SmallKinematics, GapsToAPlaneAreExact) {
  for (const std::string floor : {"plane: {normal: [0, -1], position: 0}", "level_set: y"}) {
    const Drawn body = block_on(floor);
    Problem problem(PETSC_COMM_WORLD, body.scene, body.mesh);
    const ContactInterface &interface = *problem.contact().interfaces.front();
    EXPECT_LE(interface.gap_error(expand(body.scene.parameters, {0, 0}),
                                  moved_alike(interface, {0.3, -0.2, 0}, {}),
                                  Vector::Ones(interface.dual().size())),
              1e-12);
  }
}

TEST(SmallKinematics, GapsOfTwoDisksAreOffByWhatTheDisplacedDisksSay) {
  const Drawn disks = {
      make_scene(read_case("rbvi: 1\nphysics: plane_strain\n"
                           "mesh: {built_in: two_quarter_discs, edges: 60, degree: 2}\n"
                           "parameters: {push: {range: [0.5, 0.6], default: 0.5}}\n"
                           "materials: {all: {at: all, E: 10, nu: 0.3}}\n"
                           "imposed:\n  top: {at: top, ux: 0, uy: -push}\n"
                           "  bottom: {at: bottom, ux: 0, uy: push}\n"
                           "contact: {between: {at: slave, against: master}}\n",
                           "disks.yaml")),
      {}};
  Scene still = disks.scene;
  still.motion = {};
  Problem problem(PETSC_COMM_WORLD, still, {});
  const ContactInterface &interface = *problem.contact().interfaces.front();
  std::vector<Point> vertices(interface.mesh().points.begin(),
                              interface.mesh().points.begin() + 61);
  const Point moved{0.1, -0.2, 0};
  EXPECT_NEAR(interface.gap_error(expand(still.parameters, {0.5}),
                                  moved_alike(interface, moved, {}),
                                  Vector::Ones(interface.dual().size())),
              expected(vertices, {0, -1.5, 0}, 1, moved), 2e-4); // normals of parabolas: h^2
}

/// A small push on the top of a bump passes; a shift along it does not, unless it is meant.
TEST(SmallKinematics, AnswersTellWhereTheyDoNotHold) {
  const HfSolution little = solve(block_on(bump), {0.002, 0}),
                   far = solve(block_on(bump), {0.05, 0.4}),
                   meant = solve(block_on(bump, "small: yes\n"), {0.05, 0.4});
  EXPECT_LT(*little.outputs.gap_error, 0.05);
  EXPECT_EQ(validity_warning(little.outputs), "");
  EXPECT_GT(*far.outputs.gap_error, 0.3);
  EXPECT_NE(validity_warning(far.outputs).find("kinematics: large"), std::string::npos);
  EXPECT_FALSE(meant.outputs.gap_error || meant.outputs.strained);
  EXPECT_EQ(validity_warning(meant.outputs), "");
}

/// The upper block is stretched by 0.35, or turned: u = shift (-y, x) is not, as it is imposed on
/// all of the surface.
TEST(SmallKinematics, StrainsAndTurnsAreCountedByVolume) {
  for (const auto &[imposed, least] : {std::pair{"ux: 0.29*x, uy: 0", 0.0},
                                       {"ux: 0.31*x, uy: 0", 1.0},
                                       {"ux: 0.31*y, uy: -0.31*x", 1.0},
                                       {"ux: 0.29*y, uy: -0.29*x", 0.0}}) {
    SerialMesh mesh;
    add_grid(mesh, 6, 3,
             [](const Point &x) {
               return Point{x[0], x[1] / 2, 0};
             },
             {"foot", "sides", "top", "sides"});
    const Drawn body = drawn(
        std::string("parameters: {e: {range: [5, 20], default: 15}}\n"
                    "materials: {rubber: {at: all, E: e, nu: 0.35}}\nimposed:\n  top: {at: top, ") +
            imposed + "}\n  sides: {at: sides, " + imposed +
            "}\ncontact: {floor: {at: foot, against: {plane: {normal: [0, -1], position: 10}}}}\n"
            "loads: {foot: {at: foot, traction: [0, 0]}}\n",
        mesh);
    Problem problem(PETSC_COMM_WORLD, body.scene, body.mesh);
    const Index nodes = problem.mesh().total_nodes;
    Vector u(2 * nodes);
    const double factor = std::string(imposed).find("0.29") != std::string::npos ? 0.29 : 0.31;
    const bool turned = std::string(imposed).find("*y") != std::string::npos;
    for (Index k = 0; k < nodes; ++k) {
      const Point &x = mesh.points[k];
      u[2 * k] = factor * (turned ? x[1] : x[0]);
      u[2 * k + 1] = turned ? -factor * x[0] : 0;
    }
    EXPECT_EQ(strained_share(problem, expand(body.scene.parameters, {15}), u), least) << imposed;
  }
}

} // namespace
} // namespace rbvi::small_kinematics_test
