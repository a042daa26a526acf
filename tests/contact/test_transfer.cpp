// Values at the multipliers of one mesh, interpolated at those of another.
#include "rbvi/contact/transfer.hpp"
#include "rbvi/core/error.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::transfer_test {

namespace {

/// A straight contact curve of `edges` edges on the half-plane scene.
Contact curve(const Scene &scene, int edges) {
  InterfaceMesh mesh;
  mesh.components = 2;
  for (int i = 0; i <= edges; ++i)
    mesh.points.push_back({-0.5 + static_cast<double>(i) / edges, -1, 0});
  for (int i = 0; i < edges; ++i)
    mesh.entities.insert(mesh.entities.end(), {i, i + 1});
  mesh.parts = {edges + 1};
  for (int i = 0; i < 2 * (edges + 1); ++i)
    mesh.dofs.push_back(i);
  mesh.columns = 2 * (edges + 1);
  std::vector<InterfaceMesh> meshes;
  meshes.push_back(mesh);
  return make_contact(scene, std::move(meshes));
}

/// The square (-0.1, 0.1)^2 of `side`^2 squares of two triangles each, below the obstacle.
Contact region(const Scene &scene, int side) {
  InterfaceMesh mesh;
  const int nodes = side + 1;
  for (int j = 0; j <= side; ++j)
    for (int i = 0; i <= side; ++i)
      mesh.points.push_back({-0.1 + 0.2 * i / side, -0.1 + 0.2 * j / side, 0});
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const int a = j * nodes + i;
      mesh.entities.insert(mesh.entities.end(),
                           {a, a + 1, a + nodes + 1, a, a + nodes + 1, a + nodes});
    }
  mesh.per_entity = 3;
  mesh.parts = {nodes * nodes};
  for (int i = 0; i < nodes * nodes; ++i)
    mesh.dofs.push_back(i);
  mesh.columns = nodes * nodes;
  std::vector<InterfaceMesh> meshes;
  meshes.push_back(mesh);
  return make_contact(scene, std::move(meshes));
}

} // namespace

TEST(Transfer, HatFunctionsOfTrianglesAreExactForLinearValues) {
  const Scene scene = make_scene("membrane_obstacle", {});
  const Contact coarse = region(scene, 3), fine = region(scene, 12);
  const auto values = [](const Contact &contact) {
    Vector result(contact.dual_size());
    for (Index i = 0; i < result.size(); ++i) {
      const Point &x = contact.interfaces.front()->dual().points[i];
      result[i] = 2 + 3 * x[0] - x[1];
    }
    return result;
  };
  const Matrix hats = interpolation(coarse, fine);
  EXPECT_LE((hats * values(coarse) - values(fine)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_GE(hats.minCoeff(), 0);
  EXPECT_LE((hats.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-14);
  EXPECT_LE((hats.array() > 0).rowwise().count().maxCoeff(), 3);
}

TEST(Transfer, IsExactForLinearValuesBetweenHalvedEdges) {
  const Scene scene = make_scene("patch", {{"bodies", "one"}, {"friction", "coulomb"}});
  const Contact coarse = curve(scene, 10), fine = curve(scene, 20);
  const auto values = [](const Contact &contact) {
    const DualSpace &dual = contact.interfaces.front()->dual();
    Vector result(dual.size());
    for (Index i = 0; i < dual.nodes(); ++i) {
      const double x = dual.points[i][0];
      result[i] = 2 + 3 * x;
      result[dual.nodes() + i] = 1 - x;
    }
    return result;
  };
  EXPECT_LE((interpolation(coarse, fine) * values(coarse) - values(fine)).cwiseAbs().maxCoeff(),
            1e-14);
  // Every coarse node is a fine one.
  EXPECT_LE((interpolation(fine, coarse) * values(fine) - values(coarse)).cwiseAbs().maxCoeff(), 0);
}

TEST(Transfer, RefusesInterfacesOfAnotherScene) {
  const Scene scene = make_scene("patch", {{"bodies", "one"}, {"friction", "coulomb"}});
  const Contact one = curve(scene, 10);
  EXPECT_THROW(interpolation(one, Contact{}), Error);
}

} // namespace rbvi::transfer_test
