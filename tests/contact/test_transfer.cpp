// Values at the multipliers of one mesh, interpolated at those of another.
#include "rbvi/contact/transfer.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

using namespace rbvi;

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

} // namespace

TEST(Transfer, IsExactForLinearValuesBetweenHalvedEdges) {
  const Scene scene = make_scene("rigid_disk", {{"friction", "coulomb"}});
  const Contact coarse = curve(scene, 10), fine = curve(scene, 20);
  const auto values = [](const Contact &contact) {
    const DualSpace &dual = contact.interfaces.front()->dual();
    Vector result(dual.size());
    for (Index i = 0; i < dual.nodes(); ++i) {
      const double x = dual.points[static_cast<std::size_t>(i)][0];
      result[i] = 2 + 3 * x;
      result[dual.nodes() + i] = 1 - x;
    }
    return result;
  };
  EXPECT_LE((transferred(coarse, fine, values(coarse)) - values(fine)).cwiseAbs().maxCoeff(),
            1e-14);
  // Every coarse node is a fine one.
  EXPECT_LE((transferred(fine, coarse, values(fine)) - values(coarse)).cwiseAbs().maxCoeff(), 0);
}

TEST(Transfer, RefusesValuesOfAnotherSize) {
  const Scene scene = make_scene("rigid_disk", {{"friction", "coulomb"}});
  const Contact contact = curve(scene, 10);
  EXPECT_THROW(transferred(contact, contact, Vector::Zero(3)), Error);
}
