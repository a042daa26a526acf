// Displacements of degree 2: one node per vertex and edge, the same for any number of ranks, exact
// for quadratic fields; and the contact curve of a support.
#include "rbvi/contact/contact.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/fem/distributed_contact.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace rbvi::degree_two_test {
namespace {

struct Body {
  Scene scene;
  Mesh mesh;
  Dofs dofs;
  explicit Body(const std::string &name, const SceneOptions &options,
                MPI_Comm comm = PETSC_COMM_WORLD)
      : scene(make_scene(name, options)), mesh(make_mesh(comm, scene, {})),
        dofs(number_dofs(mesh, 2, scene.fixed)) {}
};

const SceneOptions block{{"bodies", "one"}, {"degree", "2"}};

/// Coordinates of all nodes by their natural number.
Matrix all_points(const Mesh &mesh) {
  Matrix points = Matrix::Zero(mesh.total_nodes, 2);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (mesh.owned_node[v])
      points.row(mesh.natural_node[v]) << mesh.points[v][0], mesh.points[v][1];
  MPI_Allreduce(MPI_IN_PLACE, points.data(), static_cast<int>(points.size()), MPI_DOUBLE, MPI_SUM,
                mesh.comm);
  return points;
}

TEST(DegreeTwo, NodesAreTheSameForAnyNumberOfRanks) {
  for (const auto &[name, options] :
       {std::pair{"patch", block}, std::pair{"rigid_disk", SceneOptions{{"arc_edges", "20"}}}}) {
    const Body shared(name, options), own(name, options, PETSC_COMM_SELF);
    EXPECT_EQ(shared.mesh.total_nodes, own.mesh.total_nodes);
    // Euler: vertices - edges + cells = 1.
    EXPECT_EQ(own.mesh.total_nodes, 2 * own.mesh.total_vertices + own.mesh.total_cells - 1);
    EXPECT_EQ(all_points(shared.mesh), all_points(own.mesh)) << name;
  }
}

TEST(DegreeTwo, TheDefaultHalfDiskHasTheSizeOfTheReference) {
  const Body disk("rigid_disk", {});
  // The reference has 704 and 5350. An eighth more grades the ends of the core's rim and the
  // corners, without which a soft core is 9e-4 off in energy.
  EXPECT_NEAR(disk.mesh.total_vertices, 704, 704 / 8);
  EXPECT_NEAR(disk.dofs.total, 5350, 5350 / 8);
}

TEST(DegreeTwo, NodesOfACellAreItsVerticesAndTheMiddlesOfItsEdges) {
  const Body body("patch", block);
  for (std::size_t k = 0; k < body.mesh.cells.size(); ++k) {
    const auto nodes = nodes_of(body.mesh, k);
    for (std::size_t e = 0; e < 3; ++e) {
      const auto point = [&](std::size_t i) { return body.mesh.points[nodes[i]]; };
      const Point a = point(simplex_edges[e][0]);
      const Point b = point(simplex_edges[e][1]);
      const Point middle = point(3 + e);
      EXPECT_NEAR(middle[0], (a[0] + b[0]) / 2, 1e-15);
      EXPECT_NEAR(middle[1], (a[1] + b[1]) / 2, 1e-15);
    }
    EXPECT_EQ(nodes[6], -1);
  }
}

/// u = (x y, y^2 - x): |u|^2 + |grad u|^2 over [0, 1] x [0, 1/2].
TEST(DegreeTwo, QuadraticFieldsAreIntegratedExactly) {
  const Body body("patch", block);
  const Dofs free = number_dofs(body.mesh, 2, {});
  const Handle<Mat> v = make_matrix(body.mesh, free);
  assemble(forms_of(body.scene.v_product), {}, body.mesh, free, {}, v.get());
  const Matrix points = all_points(body.mesh);
  Vector natural(2 * points.rows());
  for (Index i = 0; i < points.rows(); ++i) {
    const double x = points(i, 0), y = points(i, 1);
    natural.segment<2>(2 * i) << x * y, y * y - x;
  }
  const Handle<Vec> u = from_natural(free, natural), image = make_vector(free);
  RBVI_CALL(MatMult(v.get(), u.get(), image.get()));
  PetscScalar square = 0;
  RBVI_CALL(VecDot(u.get(), image.get(), &square));
  // int x^2 y^2 + (y^2 - x)^2 + y^2 + x^2 + 1 + 4 y^2
  const double h = 0.5, y2 = h * h * h / 3, y4 = std::pow(h, 5) / 5;
  const double exact = y2 / 3 + (y4 - y2 + h / 3) + y2 + h / 3 + h + 4 * y2;
  EXPECT_NEAR(square, exact, 1e-13);
}

TEST(InterfaceCurve, ListsVerticesThenMiddlesAlongTheCurve) {
  const Body disk("rigid_disk", {{"arc_edges", "20"}});
  const InterfacePlaces places = place_interfaces(disk.mesh, disk.dofs, disk.scene);
  const InterfaceMesh &curve = places.meshes.front();
  const auto &points = curve.points;
  ASSERT_EQ(curve.count(), 20);
  ASSERT_EQ(points.size(), 41u);
  EXPECT_EQ(curve.columns, 82);
  EXPECT_EQ(places.trace.size, 82);
  for (std::size_t e = 0; e < 20; ++e) {
    const int *nodes = curve.nodes_of(static_cast<Index>(e)), edge = static_cast<int>(e);
    EXPECT_EQ(std::vector<int>(nodes, nodes + 3), (std::vector{edge, edge + 1, 21 + edge}));
    EXPECT_LT(points[e][0], points[e + 1][0]);
    EXPECT_NEAR(points[21 + e][0], (points[e][0] + points[e + 1][0]) / 2, 1e-15);
    EXPECT_NEAR(points[21 + e][1], (points[e][1] + points[e + 1][1]) / 2, 1e-15);
  }
}

TEST(InterfaceCurve, RefusesACurveThatIsHeld) {
  const Body disk("rigid_disk", {{"arc_edges", "20"}});
  const Dofs held = number_dofs(disk.mesh, 2, {{"contact", {0, 1}}});
  EXPECT_THROW(make_contact(disk.scene, place_interfaces(disk.mesh, held, disk.scene).meshes),
               Error);
}

TEST(InterfaceCurve, NitschesMethodIsForTwoDimensions) {
  Body disk("rigid_disk", {{"arc_edges", "20"}});
  disk.mesh.dim = 3;
  disk.scene.contacts.front().entities.kind = InterfaceEntities::Kind::cells_beside;
  try {
    (void)place_interfaces(disk.mesh, disk.dofs, disk.scene);
    ADD_FAILURE() << "accepted";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_NE(std::string(error.what()).find("two dimensions"), std::string::npos);
  }
}

} // namespace
} // namespace rbvi::degree_two_test
