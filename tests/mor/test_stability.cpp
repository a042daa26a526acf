#include "../linear_algebra.hpp"
#include "rbvi/mor/high_fidelity_pair.hpp"
#include "rbvi/mor/stability.hpp"

#include "grid.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/session.hpp"
#include "rbvi/solve/linear.hpp"
#include "stability_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::stability_test {
namespace {

using namespace testing_grid;

constexpr PetscInt n = 8, duals = 14;

/// A membrane whose lower two rows are in contact, numbered backwards.
struct Membrane {
  Handle<Mat> product = distributed_product(n);
  Matrix dense = dense_product(n);
  std::vector<PetscInt> nodes;
  Trace trace;
  SparseMatrix w_product, b_contact;
  Matrix b_full = Matrix::Zero(duals, n *n); // dual x free dofs

  Membrane() {
    for (PetscInt k = 2 * n - 1; k >= 0; --k)
      nodes.push_back(k);
    trace = make_trace(product.get(), nodes);
    Matrix w = Matrix::Zero(duals, duals), b = Matrix::Zero(duals, 2 * n);
    for (Index r = 0; r < duals; ++r) {
      w(r, r) = 4 + 0.1 * static_cast<double>(r);
      if (r > 0) w(r, r - 1) = w(r - 1, r) = 1;
      for (Index k = r; k < std::min<Index>(r + 3, 2 * n); ++k)
        b(r, k) = -1.0 / static_cast<double>(1 + k - r) - 0.05 * static_cast<double>(r % 4);
    }
    w_product = w.sparseView();
    b_contact = b.sparseView();
    for (Index k = 0; k < 2 * n; ++k)
      b_full.col(nodes[k]) = b.col(k);
  }

  LinearBasis basis(const Matrix &columns) const {
    std::vector<Handle<Vec>> owners;
    std::vector<Vec> raw;
    for (Index p = 0; p < columns.cols(); ++p) {
      owners.push_back(distributed(product.get(), columns.col(p)));
      raw.push_back(owners.back().get());
    }
    return pod(raw, product.get(), {.tolerance = 0}).basis;
  }
};

/// Rows over the ranks; `local_columns` of this rank.
Handle<Mat> distributed_rows(const Matrix &all, PetscInt local_columns) {
  const auto rows = static_cast<PetscInt>(all.rows()), columns = static_cast<PetscInt>(all.cols());
  Handle<Mat> matrix;
  PetscInt first = 0, last = 0;
  RBVI_CALL(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, local_columns, rows, columns, columns,
                         nullptr, columns, nullptr, matrix.put()));
  RBVI_CALL(MatGetOwnershipRange(matrix.get(), &first, &last));
  for (PetscInt row = first; row < last; ++row)
    for (PetscInt column = 0; column < columns; ++column)
      if (all(row, column) != 0)
        RBVI_CALL(MatSetValue(matrix.get(), row, column, all(row, column), INSERT_VALUES));
  RBVI_CALL(MatAssemblyBegin(matrix.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(matrix.get(), MAT_FINAL_ASSEMBLY));
  return matrix;
}

/// `b`: dual x free dofs.
PairConstants iterated(const Membrane &membrane, const Matrix &b) {
  PetscInt columns = 0;
  RBVI_CALL(MatGetLocalSize(membrane.product.get(), nullptr, &columns));
  const Handle<Mat> rows = distributed_rows(b, columns),
                    w = distributed_rows(Matrix(membrane.w_product), PETSC_DECIDE);
  const Handle<KSP> v = make_direct_solver(PETSC_COMM_WORLD, "v_");
  RBVI_CALL(MatSetOption(membrane.product.get(), MAT_SPD, PETSC_TRUE));
  set_operator(v.get(), membrane.product.get());
  return iterated_constants(v.get(), rows.get(), w.get());
}

Matrix beside(const Matrix &a, const Matrix &b) {
  Matrix both(a.rows(), a.cols() + b.cols());
  both << a, b;
  return both;
}

TEST(RieszSpace, lift_solves_and_factor_squares_to_the_traces) {
  const Membrane membrane;
  const RieszSpace space = make_riesz_space(membrane.product.get(), membrane.trace);
  Matrix columns = Matrix::Zero(n * n, 2 * n);
  for (Index k = 0; k < 2 * n; ++k)
    columns(membrane.nodes[k], k) = 1;
  const Matrix exact = membrane.dense.llt().solve(columns);
  EXPECT_LE((gathered(space.solver->fields(Matrix::Identity(2 * n, 2 * n)).get()) - exact).norm(),
            1e-12 * exact.norm());
  const Matrix traces = columns.transpose() * exact;
  EXPECT_LE((space.factor * space.factor.transpose() - traces).norm(), 1e-12 * traces.norm());
  EXPECT_TRUE(space.factor.isLowerTriangular());
}

/// Where b only scales, the loads of the multipliers at hand take the place of all contact dofs.
TEST(RieszSpace, of_few_loads_has_the_same_products) {
  const Membrane membrane;
  const Matrix x = random_matrix(duals, 4, 21);
  const Matrix loads = membrane.b_contact.transpose() * x;
  const RieszSpace all = make_riesz_space(membrane.product.get(), membrane.trace),
                   few = make_riesz_space(membrane.product.get(), membrane.trace, {}, loads);
  ASSERT_EQ(few.factor.rows(), 4);
  const Matrix t = few.factor.transpose(),
               exact = supremizer_coordinates(all, membrane.b_contact, x);
  EXPECT_LE((t.transpose() * t - exact.transpose() * exact).norm(), 1e-12 * exact.squaredNorm());
  EXPECT_LE((supremizer_coordinates(few, 3 * membrane.b_contact, x) - 3 * t).norm(),
            1e-12 * t.norm());
  EXPECT_THROW(supremizer_coordinates(few, membrane.b_contact, random_matrix(duals, 4, 24)), Error)
      << "no multiple of these loads";
  const LinearBasis modes = membrane.basis(random_matrix(n * n, 9, 22));
  const Matrix of_few = mode_coordinates(few, modes), of_all = mode_coordinates(all, modes);
  ASSERT_EQ(of_few.rows(), 4 + 9);
  EXPECT_LE((of_few.transpose() * of_few - Matrix::Identity(9, 9)).norm(), 1e-12);
  const Matrix products = of_all.topRows(2 * n).transpose() * exact;
  EXPECT_LE((of_few.topRows(4).transpose() * t - products).norm(), 1e-12 * products.norm());
  // The greedy takes the same supremizers, up to a rotation.
  LinearBasis one = membrane.basis(random_matrix(n * n, 9, 22)),
              other = membrane.basis(random_matrix(n * n, 9, 22));
  const PgaOptions options{.stability = 1 - 1e-9};
  const Pga of_loads = projected_greedy(membrane.trace.comm, few, of_few, {t}, options),
            of_dofs = projected_greedy(membrane.trace.comm, all, of_all, {exact}, options);
  append_representers(few, of_loads.representers, one, 1e-10);
  append_representers(all, of_dofs.representers, other, 1e-10);
  ASSERT_EQ(one.size(), other.size());
  const Matrix a = gathered(one.columns.get()), b = gathered(other.columns.get());
  EXPECT_LE((b - a * (a.transpose() * membrane.dense * b)).norm(), 1e-8 * b.norm());
}

TEST(RieszSpace, leaves_loads_out_that_depend_on_each_other) {
  const Membrane membrane;
  Matrix loads = random_matrix(2 * n, 4, 23);
  loads.col(2) = loads.col(0) - loads.col(1);
  EXPECT_EQ(make_riesz_space(membrane.product.get(), membrane.trace, {}, loads).factor.rows(),
            2 * n);
}

TEST(RieszSpace, refuses_a_product_that_is_not_definite) {
  const Membrane membrane;
  RBVI_CALL(MatShift(membrane.product.get(), -1));
  const ErrorRecorder quiet;
  EXPECT_THROW(make_riesz_space(membrane.product.get(), membrane.trace), Error);
}

TEST(ModeCoordinates, are_orthonormal_and_keep_the_products_with_riesz_representers) {
  const Membrane membrane;
  const RieszSpace space = make_riesz_space(membrane.product.get(), membrane.trace);
  for (const Index size : {1, 5, 20, 40}) {
    const LinearBasis modes = membrane.basis(random_matrix(n * n, size, 1));
    const Matrix columns = gathered(modes.columns.get());
    const Matrix coordinates = mode_coordinates(space, modes);
    ASSERT_EQ(coordinates.rows(), 2 * n + size);
    ASSERT_EQ(coordinates.cols(), size);
    EXPECT_LE((coordinates.transpose() * coordinates - Matrix::Identity(size, size))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-12);
    const Matrix x = random_matrix(duals, 6, 2);
    const Matrix supremizers = supremizer_coordinates(space, membrane.b_contact, x);
    const Matrix representers = membrane.dense.llt().solve(membrane.b_full.transpose() * x);
    const Matrix exact = columns.transpose() * membrane.dense * representers;
    EXPECT_LE((coordinates.topRows(2 * n).transpose() * supremizers - exact).norm(),
              1e-12 * exact.norm());
    const Matrix gram = representers.transpose() * membrane.dense * representers;
    EXPECT_LE((supremizers.transpose() * supremizers - gram).norm(), 1e-12 * gram.norm());
  }
}

TEST(ModeCoordinates, modes_inside_the_range_of_the_lift) {
  // I - P^T P is zero up to round-off of either sign: it must be cut, not rooted.
  const Membrane membrane;
  const RieszSpace space = make_riesz_space(membrane.product.get(), membrane.trace);
  const LinearBasis modes =
      membrane.basis(gathered(space.solver->fields(Matrix::Identity(2 * n, 2 * n)).get()) *
                     random_matrix(2 * n, 7, 3));
  const Matrix coordinates = mode_coordinates(space, modes);
  EXPECT_TRUE(coordinates.allFinite());
  EXPECT_LE(coordinates.bottomRows(7).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LE((coordinates.transpose() * coordinates - Matrix::Identity(7, 7)).norm(), 1e-12);
}

TEST(DualBasis, is_orthonormal_spans_and_drops_dependent_generators) {
  const Membrane membrane;
  Matrix generators = random_matrix(duals, 8, 4);
  generators.col(3) = generators.col(0) + generators.col(1);
  generators.col(5) *= 1e-12;
  generators.col(6).setZero();
  generators.col(7) = generators.col(2) + 1e-11 * generators.col(7);
  const Matrix x = orthonormal_dual_basis(generators, membrane.w_product);
  ASSERT_EQ(x.cols(), 5);
  const Matrix wx = membrane.w_product * x;
  EXPECT_LE((x.transpose() * wx - Matrix::Identity(5, 5)).cwiseAbs().maxCoeff(), 1e-13);
  for (Index r = 0; r < 8; ++r) {
    const Vector column = generators.col(r);
    EXPECT_LE((column - x * (wx.transpose() * column)).norm(), 2e-9 * column.norm());
  }
  EXPECT_EQ(orthonormal_dual_basis(Matrix(duals, 0), membrane.w_product).cols(), 0);
}

TEST(OrthonormalRange, reveals_the_rank) {
  const Matrix factor = random_matrix(30, 4, 5);
  const Matrix vectors = factor * random_matrix(4, 9, 6);
  const Matrix range = orthonormal_range(vectors);
  ASSERT_EQ(range.cols(), 4);
  EXPECT_LE((range.transpose() * range - Matrix::Identity(4, 4)).norm(), 1e-13);
  EXPECT_LE((vectors - range * (range.transpose() * vectors)).norm(), 1e-12 * vectors.norm());
  EXPECT_EQ(orthonormal_range(random_matrix(5, 9, 7)).cols(), 5);
  EXPECT_EQ(orthonormal_range(Matrix::Zero(6, 3)).cols(), 0);
}

/// Several blocks of columns, of which one depends on columns of another block.
TEST(OrthonormalRange, RevealsTheRankOfManyVectors) {
  const Matrix vectors = random_matrix(320, 300, 8);
  const Matrix range = orthonormal_range(vectors);
  ASSERT_EQ(range.cols(), 300);
  EXPECT_LE((range.transpose() * range - Matrix::Identity(300, 300)).norm(), 1e-12);
  EXPECT_LE((vectors - range * (range.transpose() * vectors)).norm(), 1e-12 * vectors.norm());
  Matrix dependent = vectors;
  dependent.col(170) = vectors.leftCols(3).rowwise().sum();
  EXPECT_EQ(orthonormal_range(dependent).cols(), 299);
}

class InfSupConstants : public testing::TestWithParam<std::tuple<int, int, int>> {};

TEST_P(InfSupConstants, agree_with_brute_force_in_the_full_space) {
  const auto [size, supremizers, cone] = GetParam();
  const Membrane membrane;
  const RieszSpace space = make_riesz_space(membrane.product.get(), membrane.trace);
  const Matrix &v = membrane.dense;
  const Matrix w = Matrix(membrane.w_product);
  const Matrix x = orthonormal_dual_basis(random_matrix(duals, cone, 8), membrane.w_product);
  const Matrix riesz = v.llt().solve(membrane.b_full.transpose() * x);

  // Rough modes, so that both spaces matter.
  const LinearBasis modes = membrane.basis(v.llt().solve(random_matrix(n * n, size, 9)));
  const Matrix primal = gathered(modes.columns.get());
  const Matrix added = riesz * random_matrix(cone, supremizers, 10);
  LinearBasis enriched = membrane.basis(beside(primal, added));
  const Matrix all = gathered(enriched.columns.get());

  const Matrix coordinates = mode_coordinates(space, modes);
  // Coordinates of V_N + S: the added representers T(mu) X C, orthonormalised.
  Matrix both = Matrix::Zero(coordinates.rows(), size + supremizers);
  both.leftCols(size) = coordinates;
  both.block(0, size, 2 * n, supremizers) =
      supremizer_coordinates(space, membrane.b_contact, x) * random_matrix(cone, supremizers, 10);
  both = orthonormal_range(both);

  const InfSup beta = infsup_constants(space, membrane.b_contact, coordinates, both, x);
  const double scale = beta.on;
  const double hf = brute_infsup(v, w, membrane.b_full, Matrix::Identity(n * n, n * n),
                                 Matrix::Identity(duals, duals));
  EXPECT_NEAR(beta.dec, brute_infsup(v, w, membrane.b_full, primal, x), 1e-7 * scale);
  EXPECT_NEAR(beta.off, brute_infsup(v, w, membrane.b_full, all, x), 1e-7 * scale);
  const Matrix online = gathered(membrane.basis(beside(primal, riesz)).columns.get());
  EXPECT_NEAR(beta.on, brute_infsup(v, w, membrane.b_full, online, x), 1e-9 * scale);

  const double slack = 1e-12 * scale;
  EXPECT_GE(beta.on, beta.off - slack);
  EXPECT_GE(beta.off, beta.dec - slack);
  EXPECT_GE(beta.on, hf - slack);
  if (size < cone) {
    EXPECT_EQ(beta.dec, 0);
  }

  const StabilityBound bound =
      stability_bound(both, supremizer_coordinates(space, membrane.b_contact, x));
  EXPECT_NEAR(bound.on, beta.on, slack);
  EXPECT_LE(bound.sharp, beta.off + slack);
  EXPECT_LE(bound.classic, beta.off + slack);
  EXPECT_GE(bound.sharp, bound.classic - slack) << "the sharper of the two";
  if (supremizers >= cone) {
    EXPECT_LE(bound.sigma, 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, InfSupConstants,
                         testing::Values(std::tuple(3, 0, 5), std::tuple(3, 2, 5),
                                         std::tuple(3, 5, 5), std::tuple(10, 0, 6),
                                         std::tuple(10, 3, 6), std::tuple(12, 1, 12),
                                         std::tuple(1, 4, 14)));

/// Over all multipliers, by a factorisation that the ranks share.
TEST(IteratedConstants, agree_with_brute_force_on_any_number_of_ranks) {
  const Membrane membrane;
  const Matrix &b = membrane.b_full;
  const PairConstants found = iterated(membrane, b);
  const Vector squares = generalised_eigenvalues(b * membrane.dense.llt().solve(b.transpose()),
                                                 Matrix(membrane.w_product));
  EXPECT_NEAR(found.beta, std::sqrt(squares(0)), 1e-9 * found.beta);
  EXPECT_NEAR(found.c, std::sqrt(squares(duals - 1)), 1e-12 * found.c);
}

TEST(IteratedConstants, dependent_rows_are_a_failure) {
  const Membrane membrane;
  Matrix b = membrane.b_full;
  b.row(3).setZero();
  const ErrorRecorder quiet;
  EXPECT_THROW(iterated(membrane, b), Error);
}

TEST(InfSupConstants, smallest_is_not_lost_at_the_root_of_round_off) {
  // Orthonormal pair with known cosines down to 1e-11.
  const Vector cosines = (Vector(4) << 1, 0.3, 1e-5, 1e-11).finished();
  const Matrix q = Matrix(Eigen::HouseholderQR<Matrix>(random_matrix(20, 8, 11)).householderQ() *
                          Matrix::Identity(20, 8));
  const Matrix primal =
      q.leftCols(4) * cosines.asDiagonal() +
      q.rightCols(4) * (1 - cosines.array().square()).sqrt().matrix().asDiagonal();
  EXPECT_NEAR(infsup_constant(primal, q.leftCols(4)), 1e-11, 1e-14);
  EXPECT_EQ(infsup_constant(primal.leftCols(3), q.leftCols(4)), 0);
}

TEST(StabilityPath, agrees_with_a_direct_computation_at_every_count) {
  const Membrane membrane;
  const RieszSpace space = make_riesz_space(membrane.product.get(), membrane.trace);
  for (const Index modes : {0, 1, 4, 9}) { // fewer and more than the 6 dual functions
    const Matrix x = orthonormal_dual_basis(random_matrix(duals, 6, 13), membrane.w_product);
    const Matrix supremizers = supremizer_coordinates(space, membrane.b_contact, x);
    const Matrix basis = orthonormal_range(random_matrix(2 * n + 9, modes + 11, 14));
    for (const std::vector<int> &counts :
         {std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, {0, 4, 11}, {11}, {7}}) {
      const auto steps = stability_path(basis, modes, counts, supremizers);
      ASSERT_EQ(steps.size(), counts.size());
      for (std::size_t k = 0; k < counts.size(); ++k) {
        SCOPED_TRACE(std::to_string(modes) + " modes, " + std::to_string(counts[k]));
        const Matrix part = basis.leftCols(modes + counts[k]);
        const StabilityBound bound = stability_bound(part, supremizers);
        const double scale = bound.c;
        EXPECT_NEAR(steps[k].off, infsup_constant(part, supremizers), 1e-13 * scale);
        EXPECT_NEAR(steps[k].bound.sharp, bound.sharp, 1e-13 * scale);
        EXPECT_NEAR(steps[k].bound.on, bound.on, 1e-13 * scale);
        EXPECT_NEAR(steps[k].bound.c, bound.c, 1e-13 * scale);
        // sigma from its cosine is right to the root of round-off, as the header says.
        EXPECT_NEAR(steps[k].bound.sigma, bound.sigma, 1e-7);
        EXPECT_NEAR(steps[k].bound.classic, bound.classic, 1e-6 * scale);
      }
    }
  }
}

TEST(StabilityPath, ends_at_the_exact_bound_when_the_supremizers_are_inside) {
  const Membrane membrane;
  const RieszSpace space = make_riesz_space(membrane.product.get(), membrane.trace);
  const Matrix x = orthonormal_dual_basis(random_matrix(duals, 5, 15), membrane.w_product);
  const Matrix supremizers = supremizer_coordinates(space, membrane.b_contact, x);
  Matrix padded = Matrix::Zero(2 * n + 3, 5);
  padded.topRows(2 * n) = supremizers;
  const Matrix modes = Matrix::Identity(2 * n + 3, 2 * n + 3).rightCols(3); // no trace: useless
  const auto steps =
      stability_path(beside(modes, orthonormal_range(padded)), 3, {0, 4, 5}, supremizers);
  EXPECT_EQ(steps[0].off, 0); // three functions against five multipliers
  EXPECT_EQ(steps[0].bound.sigma, 1);
  EXPECT_NEAR(steps[1].off, 0, 1e-15 * steps[1].bound.c); // four that are not useless
  EXPECT_NEAR(steps[2].off, steps[2].bound.on, 1e-13 * steps[2].bound.c);
  EXPECT_NEAR(steps[2].bound.sigma, 0, 1e-7);
  const double on = thin_svd(supremizers).values(4);
  EXPECT_NEAR(steps[2].off, on, 1e-13 * steps[2].bound.c);
}

TEST(RieszSpace, the_contact_dofs_that_b_couples_with_the_multipliers_are_enough) {
  const Membrane membrane;
  Matrix generators = Matrix::Zero(duals, 3);
  generators.topRows(6) = random_matrix(6, 3, 12); // rows 0 to 5 of b touch the dofs 0 to 7
  const Matrix x = orthonormal_dual_basis(generators, membrane.w_product);
  const LinearBasis modes = membrane.basis(random_matrix(n * n, 5, 13));
  const RieszSpace all = make_riesz_space(membrane.product.get(), membrane.trace);
  const RieszSpace part =
      make_riesz_space(membrane.product.get(), membrane.trace, {7, 0, 1, 2, 3, 4, 5, 6});
  EXPECT_EQ(part.factor.rows(), 8);
  const auto constants = [&](const RieszSpace &space) {
    const Matrix coordinates = mode_coordinates(space, modes);
    return infsup_constants(space, membrane.b_contact, coordinates, coordinates, x);
  };
  const InfSup whole = constants(all), few = constants(part);
  EXPECT_GT(whole.dec, 1e-3 * whole.on);
  EXPECT_NEAR(few.on, whole.on, 1e-12 * whole.on);
  EXPECT_NEAR(few.dec, whole.dec, 1e-12 * whole.on);

  const Matrix fields = gathered(part.solver->fields(random_matrix(8, 4, 14)).get());
  Matrix loads = Matrix::Zero(n * n, 4);
  for (Index k = 0; k < 8; ++k)
    loads.row(membrane.nodes[part.dofs[k]]) = random_matrix(8, 4, 14).row(k);
  EXPECT_LE((membrane.dense * fields - loads).norm(), 1e-12 * loads.norm());
}

} // namespace
} // namespace rbvi::stability_test
