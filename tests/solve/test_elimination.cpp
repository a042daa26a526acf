// Constraints over the ranks that give up displacement dofs, against dense linear algebra.
#include "../../src/solve/elimination.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/vectors.hpp"

#include <gtest/gtest.h>

namespace rbvi::elimination_test {
namespace {

constexpr Index dofs = 23;

/// C whole: row i sees dofs i, i + 1 and i + 2, and gives up the middle one.
struct Constraints {
  SparseMatrix c{dofs - 2, dofs};
  std::vector<Index> pivots;
  double middles = 0; ///< what the pivots at the ends move the dofs beside them by
  SparseMatrix moves() const {
    SparseMatrix result(dofs, dofs);
    result.setIdentity();
    result.coeffRef(1, 0) = result.coeffRef(dofs - 2, dofs - 1) = middles;
    return result;
  }
};

/// `side`: the entries beside the pivot; `skew` takes its symmetry.
Constraints constraints(double side, double skew, double middles) {
  Constraints all;
  all.middles = middles;
  for (Index i = 0; i < all.c.rows(); ++i) {
    all.c.insert(i, i) = side + skew;
    all.c.insert(i, i + 1) = 4;
    all.c.insert(i, i + 2) = side;
    all.pivots.push_back(i + 1);
  }
  return all;
}

/// All dofs are contact dofs; rank r has the r-th part of them, and the constraints of its pivots.
struct Shared {
  DualLayout layout;
  std::vector<Index> rows; ///< of C, on this rank
  PetscInt first = 0;

  explicit Shared(const std::vector<Index> &pivots) {
    layout.comm = PETSC_COMM_WORLD;
    const Index rank = rank_of(layout.comm), ranks = ranks_of(layout.comm);
    const Index begin = rank * dofs / ranks, end = (rank + 1) * dofs / ranks;
    first = static_cast<PetscInt>(begin);
    layout.local_columns = static_cast<PetscInt>(end - begin);
    for (Index dof = 0; dof < dofs; ++dof)
      layout.columns.push_back(static_cast<PetscInt>(dof));
    for (Index row = 0; row < std::ssize(pivots); ++row)
      if (const Index pivot = pivots[row]; pivot >= begin && pivot < end) rows.push_back(row);
  }
  Elimination eliminate(const Constraints &all) const {
    SparseMatrix own(std::ssize(rows), dofs);
    std::vector<Index> pivots;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      for (SparseMatrix::InnerIterator entry(all.c, rows[k]); entry; ++entry)
        own.insert(static_cast<Index>(k), entry.col()) = entry.value();
      pivots.push_back(all.pivots[rows[k]]);
    }
    return {layout, own, pivots, all.moves()};
  }
  /// This rank's part of a displacement.
  Handle<Vec> distributed(const Vector &u) const {
    return distribute_values(layout.comm, u.segment(first, layout.local_columns));
  }
  double difference(Vec u, const Vector &expected) const {
    const Handle<Vec> other = distributed(expected);
    RBVI_CALL(VecAXPY(other.get(), -1, u));
    return norm(other.get());
  }
};

struct Entries {
  double side, skew, middles = 0;
};

class EliminationOf : public testing::TestWithParam<Entries> {};
INSTANTIATE_TEST_SUITE_P(OneEntrySymmetricAndNot, EliminationOf,
                         testing::Values(Entries{0, 0}, Entries{1, 0}, Entries{1, 0.3},
                                         Entries{1, 0, 0.5}));

TEST_P(EliminationOf, MeetsTheConstraintsAndItsTranspose) {
  const Constraints all = constraints(GetParam().side, GetParam().skew, GetParam().middles);
  const Shared shared(all.pivots);
  const Elimination z = shared.eliminate(all);
  EXPECT_EQ(z.count(), all.c.rows());

  Vector u = Vector::LinSpaced(dofs, -1, 2), r = Vector::LinSpaced(dofs, 3, 1);
  const Vector right = Vector::LinSpaced(all.c.rows(), 3, -4);
  const Matrix c = all.c, t = Matrix(all.moves())(all.pivots, Eigen::all), c_p = c * t.transpose();
  const Handle<Vec> extended = shared.distributed(u), reduced = shared.distributed(r);
  u(all.pivots).setZero();
  u += t.transpose() * c_p.lu().solve(right - c * u).eval();
  z.extend(right(shared.rows), extended.get());
  EXPECT_LE(shared.difference(extended.get(), u), 1e-13 * u.norm());

  const Vector y = c_p.transpose().lu().solve(Vector(t * r));
  EXPECT_LE((z.multipliers(reduced.get()) - y(shared.rows)).norm(), 1e-14 * y.norm());
  z.reduce(reduced.get());
  r -= c.transpose() * y;
  r(all.pivots).setZero();
  EXPECT_LE(shared.difference(reduced.get(), r), 1e-13 * y.norm());

  const Matrix ties = z.ties(), expected = -c_p.lu().solve(Matrix(c.rightCols(1)));
  EXPECT_LE((ties.rightCols(1) - expected(shared.rows, Eigen::all)).norm(), 1e-2);
}

TEST(Elimination, OfNoConstraint) {
  const Constraints none{SparseMatrix(0, dofs), {}};
  EXPECT_EQ(Shared(none.pivots).eliminate(none).count(), 0);
}

/// On one rank or on several: every rank throws.
TEST(Elimination, RefusesConstraintsThatDependOnEachOther) {
  Constraints all{SparseMatrix(2, dofs), {3, 4}};
  for (const Index row : {0, 1}) {
    all.c.insert(row, 3) = 1;
    all.c.insert(row, 4) = 2;
  }
  const Shared shared(all.pivots);
  EXPECT_THROW(shared.eliminate(all), Error);
}

} // namespace
} // namespace rbvi::elimination_test
