// Dof numbering and COO assembly: against closed forms, at any number of ranks.
#include "rbvi/core/error.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/fem/assembly.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::assembly_test {
namespace {

struct Membrane {
  Scene scene = make_scene("membrane_obstacle");
  Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {});
  Dofs dofs = number_dofs(mesh, 1, {{"boundary", {}}});
};

/// x^T M y for free-dof fields given by functions of the reference point, zero on the boundary.
template <class Fx, class Fy> double quadratic(const Membrane &m, Mat matrix, Fx x, Fy y) {
  const auto field = [&](auto function) {
    Vector natural = Vector::Zero(m.dofs.total);
    for (std::size_t v = 0; v < m.mesh.points.size(); ++v)
      if (m.mesh.owned_node[v]) natural[m.mesh.natural_node[v]] = function(m.mesh.points[v]);
    MPI_Allreduce(MPI_IN_PLACE, natural.data(), static_cast<int>(natural.size()), MPI_DOUBLE,
                  MPI_SUM, m.mesh.comm);
    return from_natural(m.dofs, natural);
  };
  const Handle<Vec> left = field(x), right = field(y), image = make_vector(m.dofs);
  RBVI_CALL(MatMult(matrix, right.get(), image.get()));
  PetscScalar value = 0;
  RBVI_CALL(VecDot(left.get(), image.get(), &value));
  return value;
}

double bubble(const Point &x) {
  return (0.25 - x[0] * x[0]) * (0.25 - x[1] * x[1]);
}

TEST(Dofs, NumberEveryInteriorVertexOnce) {
  const Membrane m;
  EXPECT_EQ(m.dofs.total, 3399);
  EXPECT_EQ(m.dofs.total_free, 3399 - 176);
  std::vector<int> count(m.dofs.total, 0);
  for (const PetscInt natural : m.dofs.natural_owned)
    ++count[natural];
  MPI_Allreduce(MPI_IN_PLACE, count.data(), static_cast<int>(count.size()), MPI_INT, MPI_SUM,
                m.mesh.comm);
  int free = 0;
  for (const int c : count) {
    EXPECT_LE(c, 1);
    free += c;
  }
  EXPECT_EQ(free, m.dofs.total_free);
}

TEST(Dofs, NaturalFieldsSurviveTheRoundTrip) {
  const Membrane m;
  Vector natural = Vector::LinSpaced(m.dofs.total, 1, 2);
  const Vector back = to_natural(m.dofs, from_natural(m.dofs, natural).get());
  int kept = 0;
  for (Index i = 0; i < natural.size(); ++i) {
    EXPECT_TRUE(back[i] == natural[i] || back[i] == 0);
    kept += back[i] != 0;
  }
  EXPECT_EQ(kept, m.dofs.total_free);
}

TEST(Assembly, H1ProductConvergesToTheIntegral) {
  // int w^2 = (1/30)^2 and int |grad w|^2 = 2 (1/3) (1/30) for w = (1/4 - x^2)(1/4 - y^2).
  const Membrane m;
  const Handle<Mat> v = make_matrix(m.mesh, m.dofs);
  assemble(forms_of(m.scene.v_product), {}, m.mesh, m.dofs, {}, v.get());
  const double exact = 1.0 / 900 + 2.0 / 90;
  EXPECT_NEAR(quadratic(m, v.get(), bubble, bubble), exact, 2e-3 * exact);
}

/// The contact arc of a half-disk is a part of its arc, the core one of the body.
TEST(Assembly, WhatPartsOfAListShareCountsOnce) {
  const Scene scene = make_scene("rigid_disk");
  const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {});
  const auto sum_over = [&](const std::vector<Form> &parts) {
    double sum = 0;
    for (const Form &part : parts)
      for (const auto &[cell, facet] : places_of(mesh, part)) {
        const Cell whole = cell_of(mesh, cell);
        sum += facet < 0 ? volume_of(2, whole.reference)
                         : norm(facet_cell(whole, facet).reference[1] -
                                facet_cell(whole, facet).reference[0]);
      }
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, mesh.comm);
    return sum;
  };
  const Form arc{"", {}, "arc"}, contact{"", {}, "contact"}, all{"", {}}, core{"core", {}};
  const auto less = [](Form form, const std::vector<std::string> &others) {
    form.without = others;
    return form;
  };
  const double whole = sum_over({arc}), area = sum_over({all});
  double polygon = 0; // of triangles from the origin to the arc
  for (const auto &[cell, facet] : places_of(mesh, arc)) {
    const auto ends = facet_cell(cell_of(mesh, cell), facet).reference;
    polygon += std::abs(ends[0][0] * ends[1][1] - ends[0][1] * ends[1][0]) / 2;
  }
  MPI_Allreduce(MPI_IN_PLACE, &polygon, 1, MPI_DOUBLE, MPI_SUM, mesh.comm);
  EXPECT_NEAR(whole, M_PI, 1e-3);
  EXPECT_NEAR(area, polygon, 1e-13);
  EXPECT_GT(sum_over({contact}), 0.7);
  EXPECT_GT(sum_over({core}), 0.5);
  EXPECT_NEAR(sum_over({contact, less(arc, {"contact"})}), whole, 1e-13);
  EXPECT_NEAR(sum_over({arc, less(contact, {"arc"})}), whole, 1e-13);
  EXPECT_NEAR(sum_over({core, less(all, {"core"})}), area, 1e-13);
  EXPECT_NEAR(sum_over({all, less(core, {""})}), area, 1e-13);
}

TEST(Assembly, ASecondFillOverwritesTheFirst) {
  const Membrane m;
  const Handle<Mat> a = make_matrix(m.mesh, m.dofs);
  const FullMu one{0.2, 0, 0}, other{0.23, 0.03, -0.04};
  assemble(forms_of(m.scene.a), one, m.mesh, m.dofs, map_vertices(m.scene, one, m.mesh), a.get());
  const double first = quadratic(m, a.get(), bubble, bubble);
  assemble(forms_of(m.scene.a), other, m.mesh, m.dofs, map_vertices(m.scene, other, m.mesh),
           a.get());
  EXPECT_GT(std::abs(quadratic(m, a.get(), bubble, bubble) - first), 1e-3 * first);
  assemble(forms_of(m.scene.a), one, m.mesh, m.dofs, map_vertices(m.scene, one, m.mesh), a.get());
  EXPECT_NEAR(quadratic(m, a.get(), bubble, bubble), first, 1e-14 * first);
}

TEST(Assembly, TheMapKeepsEnergiesOfMappedFunctions) {
  // a(mu; u, u) of a field given on the mapped nodes does not depend on the map but for O(h^2).
  const Membrane m;
  const FullMu mu{0.24, 0.05, 0.05};
  const Handle<Mat> a = make_matrix(m.mesh, m.dofs);
  assemble(forms_of(m.scene.a), mu, m.mesh, m.dofs, map_vertices(m.scene, mu, m.mesh), a.get());
  const auto mapped_bubble = [&](const Point &x) { return bubble(m.scene.map(mu, x)); };
  EXPECT_NEAR(quadratic(m, a.get(), mapped_bubble, mapped_bubble), 2.0 / 90, 3e-3 * 2.0 / 90);
}

TEST(Assembly, AnInvertedCellOnOneRankFailsOnAll) {
  Membrane m;
  m.scene.map = [](const FullMu &, const Point &x) {
    return x[0] > 0.48 ? Point{0.9 - x[0], x[1], 0} : x;
  };
  EXPECT_THROW(map_vertices(m.scene, {0.2, 0, 0}, m.mesh), Error);
}

} // namespace
} // namespace rbvi::assembly_test
