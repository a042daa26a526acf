#include "../linear_algebra.hpp"
#include "rbvi/mor/pod.hpp"

#include "grid.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rbvi::pod_test {
namespace {

using namespace testing_grid;

constexpr PetscInt n = 9;

struct Snapshots {
  std::vector<Handle<Vec>> owners;
  std::vector<Vec> raw;
  Snapshots(Mat product, const Matrix &values) {
    for (Index p = 0; p < values.cols(); ++p) {
      owners.push_back(distributed(product, values.col(p)));
      raw.push_back(owners.back().get());
    }
  }
};

/// Smooth snapshots with quickly decaying singular values.
Matrix smooth(Index count) {
  Matrix values(n * n, count);
  for (Index p = 0; p < count; ++p)
    for (PetscInt k = 0; k < n * n; ++k) {
      const double x = static_cast<double>(k % n + 1) / (n + 1);
      const double y = static_cast<double>(k / n + 1) / (n + 1);
      const double mu = 0.5 + static_cast<double>(p) / static_cast<double>(count);
      values(k, p) = x * (1 - x) * y * (1 - y) / (mu + x + 0.3 * y * mu * mu);
    }
  return values;
}

double v_norm(const Matrix &product, const Matrix &columns) {
  return std::sqrt(columns.cwiseProduct(product * columns).sum());
}

double gram_error(const Matrix &product, const Matrix &basis) {
  return (basis.transpose() * product * basis - Matrix::Identity(basis.cols(), basis.cols()))
      .cwiseAbs()
      .maxCoeff();
}

TEST(Pod, reports_the_true_projection_error_of_orthonormal_modes) {
  const Handle<Mat> product = distributed_product(n);
  const Matrix dense = dense_product(n), values = smooth(30);
  const Snapshots snapshots(product.get(), values);
  for (const double tolerance : {1e-1, 1e-3, 1e-6, 1e-10}) {
    const Pod result = pod(snapshots.raw, product.get(), {.tolerance = tolerance});
    const Matrix basis = gathered(result.basis.columns.get());
    const auto size = static_cast<std::size_t>(result.basis.size());
    ASSERT_EQ(basis.cols(), result.basis.size());
    EXPECT_LE(gram_error(dense, basis), 1e-13);
    const Matrix rest = values - basis * (basis.transpose() * dense * values);
    const double error = v_norm(dense, rest) / v_norm(dense, values);
    EXPECT_NEAR(error, result.error[size], 1e-3 * error + 1e-14);
    EXPECT_LE(result.error[size], tolerance);
    EXPECT_GT(result.error[size - 1], tolerance);
  }
}

TEST(Pod, singular_values_are_those_of_the_weighted_snapshots) {
  const Handle<Mat> product = distributed_product(n);
  const Matrix values = random_matrix(n * n, 12, 3);
  const Snapshots snapshots(product.get(), values);
  const Pod result = pod(snapshots.raw, product.get(), {.tolerance = 0});
  const Matrix weighted = dense_product(n).llt().matrixU() * values;
  const Vector exact = thin_svd(weighted).values;
  ASSERT_EQ(result.singular_values.size(), 12U);
  for (std::size_t k = 0; k < 12; ++k)
    EXPECT_NEAR(result.singular_values[k], exact(static_cast<Index>(k)), 1e-12 * exact(0));
  EXPECT_DOUBLE_EQ(result.error.front(), 1);
  EXPECT_EQ(result.error.back(), 0);
  for (std::size_t k = 1; k < result.error.size(); ++k)
    EXPECT_LE(result.error[k], result.error[k - 1]);
}

TEST(Pod, all_modes_reproduce_every_snapshot) {
  const Handle<Mat> product = distributed_product(n);
  const Matrix dense = dense_product(n);
  Matrix values = random_matrix(n * n, 10, 4);
  values.col(3) *= 1e-9;
  const Snapshots snapshots(product.get(), values);
  const Pod result = pod(snapshots.raw, product.get(), {.tolerance = 0});
  EXPECT_EQ(result.basis.size(), 10);
  const Matrix basis = gathered(result.basis.columns.get());
  EXPECT_LE(gram_error(dense, basis), 1e-13);
  const Matrix rest = values - basis * (basis.transpose() * dense * values);
  EXPECT_LE(v_norm(dense, rest), 1e-13 * v_norm(dense, values));
}

TEST(Pod, drops_dependent_snapshots_and_counts_them_in_the_error) {
  const Handle<Mat> product = distributed_product(n);
  const Matrix dense = dense_product(n);
  Matrix values = random_matrix(n * n, 8, 5);
  values.col(2) = values.col(0);
  values.col(5).setZero();
  values.col(7) = 1e6 * (values.col(1) - values.col(3));
  const Snapshots snapshots(product.get(), values);
  const Pod result = pod(snapshots.raw, product.get(), {.tolerance = 0.5});
  EXPECT_EQ(result.singular_values.size(), 5U);
  // Column 7 dwarfs the others: one mode is enough only if its (dropped) column counts.
  EXPECT_EQ(result.basis.size(), 1);
  const Matrix basis = gathered(result.basis.columns.get());
  const Matrix rest = values - basis * (basis.transpose() * dense * values);
  EXPECT_NEAR(v_norm(dense, rest) / v_norm(dense, values), result.error[1], 1e-3 * result.error[1]);
}

TEST(Pod, keeps_or_cuts_equal_singular_values_together) {
  const Handle<Mat> product = distributed_product(n);
  const Matrix dense = dense_product(n);
  // V-orthonormal columns scaled by 4, 1, 1, 1e-3: known singular values.
  Matrix values = dense.llt().matrixU().solve(
      Matrix(Eigen::HouseholderQR<Matrix>(random_matrix(n * n, 4, 6)).householderQ() *
             Matrix::Identity(n * n, 4)));
  values *= Eigen::Vector4d(4, 1, 1, 1e-3).asDiagonal();
  const Snapshots snapshots(product.get(), values);
  // Alone, the second mode would bring the error below 0.25.
  EXPECT_EQ(pod(snapshots.raw, product.get(), {.tolerance = 0.25}).basis.size(), 3);
  EXPECT_EQ(pod(snapshots.raw, product.get(), {.tolerance = 1e-9, .max_size = 2}).basis.size(), 1);
  EXPECT_EQ(pod(snapshots.raw, product.get(), {.tolerance = 1e-9, .max_size = 3}).basis.size(), 3);
  EXPECT_EQ(pod(snapshots.raw, product.get(), {.tolerance = 1e-9}).basis.size(), 4);
  const std::vector<Vec> equal{snapshots.raw[1], snapshots.raw[2]};
  EXPECT_THROW(pod(equal, product.get(), {.tolerance = 0, .max_size = 1}), Error);
}

TEST(Pod, sign_and_order_do_not_depend_on_signs_of_noise) {
  const Handle<Mat> product = distributed_product(n);
  const Matrix values = smooth(12);
  const Snapshots plain(product.get(), values), scaled(product.get(), 3 * values);
  const Pod first = pod(plain.raw, product.get(), {.tolerance = 1e-4});
  const Pod second = pod(scaled.raw, product.get(), {.tolerance = 1e-4});
  const Matrix a = gathered(first.basis.columns.get()), b = gathered(second.basis.columns.get());
  EXPECT_LE((a - b).norm(), 1e-8 * a.norm());
  const Matrix coefficients = a.transpose() * dense_product(n) * values;
  for (Index k = 0; k < coefficients.rows(); ++k)
    EXPECT_GT(coefficients.row(k).maxCoeff(), 0.999999 * coefficients.row(k).cwiseAbs().maxCoeff());
}

TEST(Pod, leaves_snapshots_alone_and_refuses_bad_ones) {
  const Handle<Mat> product = distributed_product(n);
  Matrix values = random_matrix(n * n, 3, 7);
  const Snapshots snapshots(product.get(), values);
  (void)pod(snapshots.raw, product.get(), {});
  double difference = 0;
  const Handle<Vec> copy = distributed(product.get(), values.col(1));
  RBVI_CALL(VecAXPY(copy.get(), -1, snapshots.raw[1]));
  RBVI_CALL(VecNorm(copy.get(), NORM_INFINITY, &difference));
  EXPECT_EQ(difference, 0);

  EXPECT_THROW(pod({}, product.get(), {}), Error);
  const Snapshots zero(product.get(), Matrix::Zero(n * n, 2));
  try {
    (void)pod(zero.raw, product.get(), {});
    FAIL() << "accepted";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("nothing moves the body"), std::string::npos);
  }
  EXPECT_THROW(pod(snapshots.raw, product.get(), {.tolerance = 1}), Error);
  values(5, 2) = std::numeric_limits<double>::quiet_NaN();
  const Snapshots bad(product.get(), values);
  EXPECT_THROW(pod(bad.raw, product.get(), {}), Error);
}

TEST(AppendOrthonormalised, takes_independent_columns_and_keeps_the_first) {
  const Handle<Mat> product = distributed_product(n);
  const Matrix dense = dense_product(n), values = smooth(20);
  const Snapshots snapshots(product.get(), values);
  Pod result = pod(snapshots.raw, product.get(), {.tolerance = 1e-3});
  const Matrix before = gathered(result.basis.columns.get());

  Matrix extra = random_matrix(n * n, 5, 8);
  extra.col(1) = before.col(0) - 2 * before.col(1);
  extra.col(3) = extra.col(0) + 1e-7 * extra.col(2) + before.col(0);
  const Handle<Mat> columns = extension(
      [&] {
        std::vector<PetscInt> nodes(n * n);
        for (PetscInt k = 0; k < n * n; ++k)
          nodes[k] = k;
        return make_trace(product.get(), nodes);
      }(),
      extra, product.get());
  const std::vector<int> taken = append_orthonormalised(result.basis, columns.get(), 1e-10);
  EXPECT_EQ(taken, (std::vector<int>{0, 2, 4}));
  const Matrix after = gathered(result.basis.columns.get());
  ASSERT_EQ(after.cols(), before.cols() + 3);
  EXPECT_EQ(result.basis.size(), after.cols());
  EXPECT_EQ(after.leftCols(before.cols()), before);
  EXPECT_LE(gram_error(dense, after), 1e-13);
  const Matrix rest = extra - after * (after.transpose() * dense * extra);
  EXPECT_LE(v_norm(dense, rest), 1e-12 * v_norm(dense, extra));
}

TEST(AppendOrthonormalised, nearly_dependent_column_stays_orthogonal) {
  const Handle<Mat> product = distributed_product(n);
  const Matrix dense = dense_product(n);
  const Snapshots snapshots(product.get(), random_matrix(n * n, 4, 9));
  Pod result = pod(snapshots.raw, product.get(), {.tolerance = 0});
  const Matrix before = gathered(result.basis.columns.get());
  std::vector<PetscInt> nodes(n * n);
  for (PetscInt k = 0; k < n * n; ++k)
    nodes[k] = k;
  const Matrix extra = before.col(0) + 1e-11 * random_matrix(n * n, 1, 10);
  const Handle<Mat> columns = extension(make_trace(product.get(), nodes), extra, product.get());
  EXPECT_EQ(append_orthonormalised(result.basis, columns.get(), 1e-13).size(), 1U);
  EXPECT_LE(gram_error(dense, gathered(result.basis.columns.get())), 1e-13);
}

/// More columns than are taken at a time, some of which depend on others of their block, or of one
/// before.
TEST(AppendOrthonormalised, takes_many_columns_block_by_block) {
  constexpr PetscInt m = 14;
  const Handle<Mat> product = distributed_product(m);
  const Matrix dense = dense_product(m);
  const Snapshots snapshots(product.get(), random_matrix(m * m, 6, 31));
  Pod result = pod(snapshots.raw, product.get(), {.tolerance = 0});
  Matrix extra = random_matrix(m * m, 110, 32);
  extra.col(20) = extra.col(3) + extra.col(19);
  extra.col(70) = extra.col(5) - 3 * extra.col(60);
  extra.col(100) = extra.col(99) + 1e-9 * extra.col(100);
  std::vector<PetscInt> nodes(m * m);
  for (PetscInt k = 0; k < m * m; ++k)
    nodes[k] = k;
  const Handle<Mat> columns = extension(make_trace(product.get(), nodes), extra, product.get());
  std::vector<int> expected;
  for (int k = 0; k < 110; ++k)
    if (k != 20 && k != 70) expected.push_back(k);
  EXPECT_EQ(append_orthonormalised(result.basis, columns.get(), 1e-11), expected);
  EXPECT_EQ(result.basis.size(), 6 + 108);
  const Matrix after = gathered(result.basis.columns.get());
  EXPECT_LE(gram_error(dense, after), 1e-12);
  EXPECT_LE(v_norm(dense, extra - after * (after.transpose() * dense * extra)),
            1e-11 * v_norm(dense, extra));
}

} // namespace
} // namespace rbvi::pod_test
