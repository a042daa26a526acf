// The contact side over the ranks: whose a multiplier is, and that B, g and the weights do what
// those of a single rank do, evaluated whole or each rank its part.
#include "rbvi/fem/problem.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbvi::distributed_contact_test {
namespace {

struct Case {
  std::string scene;
  SceneOptions options;
  std::string free;
  Mu mu;
};

const std::vector<Case> &cases() {
  static const std::vector<Case> all{
      {"membrane_obstacle", {{"lumped", "no"}}, "radius,center_x", {0.17, -0.03}},
      {"membrane_obstacle", {{"degree", "2"}}, "frame_height,frame_tilt", {0.01, 0.1}},
      {"rigid_disk", {}, "radius,friction_coefficient", {1.1, 0.3}},
      {"roller", {}, "top,tilt", {0.03, 0.1}}, // two interfaces, one with friction
      {"two_disks", {}, "radius", {1.1}}};     // macro-edges
  return all;
}

Scene scene_of(const Case &one) {
  Scene scene = make_scene(one.scene, one.options);
  scene.parameters = free_only(scene.parameters, one.free);
  return scene;
}

Vector waves(Index size) {
  return Vector::NullaryExpr(size, [](Index i) { return std::sin(1.3 * static_cast<double>(i)); });
}

TEST(DistributedContact, EveryMultiplierHasOneRankNextToThoseOfItsNode) {
  for (const Case &one : cases()) {
    SCOPED_TRACE(one.scene);
    Problem problem(PETSC_COMM_WORLD, scene_of(one), {});
    const DualLayout &layout = problem.dual_layout();
    std::vector<PetscInt> sorted = layout.numbers;
    std::ranges::sort(sorted);
    std::vector<PetscInt> all(problem.dual_size());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(sorted, all);
    const NodeLaws laws = laws_at(problem.contact(), expand(problem.scene().parameters, one.mu));
    for (Index i = 0; i < laws.nodes(); ++i) {
      if (!laws.has_tangent(i)) continue;
      const auto number = [&](const std::vector<Index> &row) { return layout.numbers[row[i]]; };
      EXPECT_EQ(number(laws.tangent), number(laws.normal) + 1);
    }
  }
}

/// B u, B^T l, g and the weights of `problem` against those of all rows on this rank.
void expect_same(Problem &problem, const Operators &op, const Operators &all) {
  const DualLayout &layout = problem.dual_layout();
  const DistributedContact contact = distribute(layout, op, op.laws);
  const Vector field = waves(problem.dofs().total), multipliers = waves(problem.dual_size());
  const Handle<Vec> u = from_natural(problem.dofs(), field), bt = make_vector(problem.dofs()),
                    l = distribute(layout, multipliers);
  Handle<Vec> bu;
  RBVI_CALL(VecDuplicate(l.get(), bu.put()));
  RBVI_CALL(MatMult(contact.b.get(), u.get(), bu.get()));
  const Vector expected = all.b * restrict_to(problem.trace(), u.get());
  EXPECT_LE((on_every_rank(layout, bu.get()) - expected).norm(), 1e-14 * expected.norm());
  RBVI_CALL(MatMultTranspose(contact.b.get(), l.get(), bt.get()));
  const Vector transposed = all.b.transpose() * multipliers;
  EXPECT_LE((restrict_to(problem.trace(), bt.get()) - transposed).norm(),
            1e-14 * transposed.norm());
  EXPECT_EQ(on_every_rank(layout, contact.g.get()), all.g);
  const Vector weights = on_every_rank(layout, contact.weights.get());
  EXPECT_EQ(Vector(weights(all.laws.normal)), all.weights);
  EXPECT_EQ(on_every_rank(layout, l.get()), multipliers);
  const Handle<Mat> w = distribute(layout, problem.w_product());
  RBVI_CALL(MatMult(w.get(), l.get(), bu.get()));
  EXPECT_LE((on_every_rank(layout, bu.get()) - problem.w_product() * multipliers).norm(), 1e-15);
}

TEST(DistributedContact, DoesWhatTheOperatorsOfOneRankDo) {
  for (const Case &one : cases())
    for (const Index gather : {Index{0}, Index{1} << 20}) {
      SCOPED_TRACE(one.scene + ", gathered up to " + std::to_string(gather));
      Problem problem(PETSC_COMM_WORLD, scene_of(one), {}, gather);
      Operators all;
      problem.assemble_contact(one.mu, all);
      for (const ContactRows rows : {ContactRows::own, ContactRows::all, ContactRows::own})
        expect_same(problem, problem.assemble(one.mu, rows), all);
    }
}

TEST(DistributedContact, WhatRanksExchangeIsWhatEachWouldHaveEvaluated) {
  for (const Case &one : cases()) {
    SCOPED_TRACE(one.scene);
    Problem problem(PETSC_COMM_WORLD, scene_of(one), {}, 0);
    Operators all;
    problem.assemble_contact(one.mu, all);
    const Operators &op = problem.assemble(one.mu);
    EXPECT_EQ(op.b.nonZeros(), all.b.nonZeros());
    EXPECT_EQ((op.b - all.b).norm(), 0);
    EXPECT_EQ((op.nodal_b - all.nodal_b).norm(), 0);
    EXPECT_EQ(op.g, all.g);
    EXPECT_EQ(op.weights, all.weights);
    EXPECT_EQ(op.nodal_gap, all.nodal_gap);
  }
}

TEST(DistributedContact, ARankEvaluatesNoRowsOfOthersAboveTheSize) {
  const Scene scene = make_scene("membrane_obstacle");
  Problem split(PETSC_COMM_WORLD, scene, {}, 0), whole(PETSC_COMM_WORLD, scene, {});
  const Mu mu{0.17, -0.03, 0.05};
  const auto own = static_cast<Index>(split.dual_layout().rows.size());
  const auto rows_with_values = [](const SparseMatrix &b) {
    Index count = 0;
    for (Index row = 0; row < b.rows(); ++row)
      count += SparseMatrix::InnerIterator(b, row) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(rows_with_values(split.assemble(mu, ContactRows::own).b), own);
  EXPECT_EQ(rows_with_values(whole.assemble(mu, ContactRows::own).b), whole.dual_size());
}

} // namespace
} // namespace rbvi::distributed_contact_test
