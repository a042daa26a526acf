
#include "../mor/grid.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/session.hpp"
#include "rbvi/par/small_svd.hpp"

#include <gtest/gtest.h>

#include <slepc/private/svdimpl.h>

#include <limits>

extern "C" PetscErrorCode SVDCreate_LAPACK(SVD svd);

namespace rbvi::small_eigen_test {
namespace {

using testing_grid::random_matrix;

/// A symmetric matrix with these eigenvalues.
Matrix with_eigenvalues(const Vector &values, unsigned seed) {
  const Index n = values.size();
  const Matrix q = Eigen::HouseholderQR<Matrix>(random_matrix(n, n, seed)).householderQ();
  return q * values.asDiagonal() * q.transpose();
}

void expect_pairs(SmallEigen &eigen, const Matrix &matrix, const Vector &decreasing) {
  Matrix lower = matrix.triangularView<Eigen::Lower>();
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(7); // not read
  const Vector values = eigen.values(lower);
  const Matrix vectors = eigen.vectors(values.size());
  ASSERT_EQ(values.size(), decreasing.size());
  EXPECT_LE((values - decreasing).norm(), 1e-13 * decreasing.norm());
  EXPECT_LE((matrix * vectors - vectors * values.asDiagonal()).norm(), 1e-13 * matrix.norm());
  EXPECT_LE((vectors.transpose() * vectors - Matrix::Identity(values.size(), values.size()))
                .cwiseAbs()
                .maxCoeff(),
            1e-13);
}

TEST(SmallEigen, one_object_serves_matrices_of_any_size_and_clustered_spectra) {
  SmallEigen eigen("none_");
  for (const Index n : {1, 7, 40, 40, 3, 117, 200}) {
    const Vector apart = Vector::LinSpaced(n, 2, 0.1);
    expect_pairs(eigen, with_eigenvalues(apart, 1), apart);
    Vector clustered = Vector::Ones(n);
    clustered.tail(n / 2).setConstant(1e-3);
    expect_pairs(eigen, with_eigenvalues(clustered, 2), clustered);
    expect_pairs(eigen, Matrix::Identity(n, n), Vector::Ones(n));
  }
  EXPECT_EQ(eigen.values(Matrix(0, 0)).size(), 0);
  Matrix bad = Matrix::Identity(4, 4);
  bad(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(eigen.values(bad), Error);
  expect_pairs(eigen, Matrix::Identity(4, 4), Vector::Ones(4));
}

/// What SLEPc says of `work` with one option.
template <class Work>
std::string failure_with(const std::string &option, const char *value, const Work &work) {
  RBVI_CALL(PetscOptionsSetValue(nullptr, option.c_str(), value));
  std::string message;
  try {
    work();
  } catch (const Error &error) {
    message = error.what();
  }
  RBVI_CALL(PetscOptionsClearValue(nullptr, option.c_str()));
  return message;
}

TEST(SmallEigen, follows_its_options) {
  const Vector exact = Vector::LinSpaced(30, 2, 1.9);
  const Matrix matrix = with_eigenvalues(exact, 3);
  const ErrorRecorder quiet;
  Vector values;
  EXPECT_EQ(failure_with("-few_eps_type", "krylovschur",
                         [&] { values = SmallEigen("few_").values(matrix); }),
            "");
  EXPECT_LE((values - exact).norm(), 1e-7);
  EXPECT_NE(failure_with("-few_eps_type", "power", [&] { SmallEigen("few_").values(matrix); })
                .find("EPSSolve: This solver supports only"),
            std::string::npos);
}

/// Lanczos without reorthogonalisation meets the same eigenvalue again and again.
TEST(SmallEigen, fewer_pairs_than_asked_for_is_a_failure_that_says_what_to_do) {
  const Matrix matrix = with_eigenvalues(Vector::LinSpaced(30, 2, 1.9), 3);
  RBVI_CALL(PetscOptionsSetValue(nullptr, "-few_eps_type", "lanczos"));
  RBVI_CALL(PetscOptionsSetValue(nullptr, "-few_eps_max_it", "1"));
  const std::string message = failure_with("-few_eps_lanczos_reorthog", "local",
                                           [&] { SmallEigen("few_").values(matrix); });
  RBVI_CALL(PetscOptionsClearValue(nullptr, "-few_eps_type"));
  RBVI_CALL(PetscOptionsClearValue(nullptr, "-few_eps_max_it"));
  EXPECT_NE(message.find("of 30 eigenvalues"), std::string::npos) << message;
  EXPECT_NE(message.find("leave out -few_eps_type"), std::string::npos) << message;
}

PetscErrorCode give_up(SVD) {
  SETERRQ(PETSC_COMM_SELF, PETSC_ERR_LIB, "Error in LAPACK subroutine gesdd: info=1");
}

PetscErrorCode create_unlucky(SVD svd) {
  (void)SVDCreate_LAPACK(svd);
  svd->ops->solve = give_up;
  return 0;
}

/// LAPACK's divide and conquer does not converge for some matrices, which depend on the BLAS.
TEST(SmallSvdObject, answers_where_lapack_gives_up) {
  const Matrix matrix = with_eigenvalues(Vector::LinSpaced(30, 2, 1.9), 3).leftCols(7);
  const SmallSvd expected = small_svd(matrix);
  const ErrorRecorder quiet;
  RBVI_CALL(SVDRegister("unlucky", create_unlucky));
  SmallSvd found;
  EXPECT_EQ(failure_with("-few_svd_type", "unlucky",
                         [&] {
                           found = small_svd(matrix, "few_");
                           EXPECT_LE((singular_values(matrix, "few_") - expected.values).norm(),
                                     1e-13);
                         }),
            "");
  EXPECT_LE((found.values - expected.values).norm(), 1e-13);
  EXPECT_LE((found.left * found.values.asDiagonal() * found.right.transpose() - matrix).norm(),
            1e-13);
}

TEST(SmallSvdObject, reads_its_options_and_is_made_anew_after_a_failure) {
  const Matrix matrix = with_eigenvalues(Vector::LinSpaced(30, 2, 1.9), 3);
  const ErrorRecorder quiet;
  EXPECT_NE(failure_with("-few_svd_type", "nothing", [&] { singular_values(matrix, "few_"); })
                .find("nothing"),
            std::string::npos);
  EXPECT_NEAR(singular_values(matrix, "few_")(0), 2, 1e-13);
  EXPECT_EQ(singular_values(matrix.leftCols(3), "few_").size(), 3);
}

} // namespace
} // namespace rbvi::small_eigen_test
