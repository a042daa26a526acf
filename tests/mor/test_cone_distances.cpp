#include "rbvi/mor/cones.hpp"

#include "multipliers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rbvi::cone_distances_test {
using namespace rbvi::testing_multipliers;

namespace {

class Random {
public:
  explicit Random(unsigned seed) : engine_(seed) {}
  Matrix signed_matrix(Index rows, Index columns) {
    return Matrix::NullaryExpr(rows, columns, [&] { return uniform_(engine_); });
  }
  Matrix nonnegative(Index rows, Index columns) {
    return signed_matrix(rows, columns).cwiseMax(0.0);
  }

private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

/// The modes as generators of either sign.
ConeBasis split(const ConeBasis &basis, const FreeModes &modes) {
  Matrix all(modes.columns.rows(), basis.generators.cols() + 2 * modes.columns.cols());
  all << basis.generators, modes.columns, -modes.columns;
  return {all};
}

} // namespace

TEST(DistancesToCone, NothingAndOfNothing) {
  const SparseMatrix product = identity(2);
  const Matrix values{{3, 0, -1}, {4, 0, -1}};
  const ConeBasis empty{Matrix(2, 0)};
  EXPECT_LT((distances_to_cone(values, empty, product) - Vector{{1, 0, std::sqrt(2.0) / 5}}).norm(),
            1e-15);
  const ConeBasis axes{Matrix::Identity(2, 2)};
  EXPECT_LT((distances_to_cone(values, axes, product) - Vector{{0, 0, std::sqrt(2.0) / 5}}).norm(),
            1e-15);
  EXPECT_EQ(distances_to_cone(Matrix::Zero(2, 3), axes, product), Vector::Zero(3));
}

TEST(DistancesToCone, ExactExampleWithAMode) {
  // The plane z = 0 is cut into its upper half by the mode e_x and the generator (1, 1, 0).
  const ConeBasis basis{Matrix{{1}, {1}, {0}}};
  const FreeModes modes{Matrix{{1}, {0}, {0}}};
  const Matrix values{{-5, 1, 0, 3}, {2, -3, 0, 0}, {0, 4, 10, 0}};
  const Vector distances = distances_to_cone(values, basis, identity(3), modes);
  EXPECT_LT((distances - Vector{{0, 0.5, 1, 0}}).norm(), 1e-15);
}

TEST(DistancesToCone, ModesAreGeneratorsOfEitherSign) {
  Random random(1);
  for (int k = 0; k < 40; ++k) {
    const Index n = 5 + k % 9, count = k % 5, free = 1 + k % 3;
    const Matrix factor = random.signed_matrix(n, n) + 2 * Matrix::Identity(n, n);
    const SparseMatrix product = sparse(factor.transpose() * factor);
    const ConeBasis basis{random.nonnegative(n, count)};
    const FreeModes modes{random.signed_matrix(n, free)};
    const Matrix values = random.signed_matrix(n, 6);
    const Vector distances = distances_to_cone(values, basis, product, modes);
    // Both are exact; what differs is round-off times the condition of the generators.
    EXPECT_LT((distances - distances_to_cone(values, split(basis, modes), product)).norm(), 1e-11);
    EXPECT_TRUE((distances.array() <= distances_to_cone(values, basis, product).array()).all());
  }
}

TEST(DistancesToCone, ModesThatDependOnEachOtherOrOnGenerators) {
  Random random(2);
  const Index n = 8;
  const SparseMatrix product = grid_mass(3).topLeftCorner(n, n);
  const Matrix values = random.signed_matrix(n, 5);
  const FreeModes modes{random.signed_matrix(n, 3)};
  const ConeBasis basis{random.nonnegative(n, 4)};
  const Vector distances = distances_to_cone(values, basis, product, modes);
  Matrix repeated(n, 7);
  repeated << modes.columns, 1e-3 * modes.columns.col(1), Vector::Zero(n),
      modes.columns * random.signed_matrix(3, 2);
  EXPECT_LT((distances_to_cone(values, basis, product, {repeated}) - distances).norm(), 1e-11);
  // A generator in the span of the modes adds nothing: its remainder is noise, no direction.
  Matrix more(n, 6);
  more << basis.generators, modes.columns * random.signed_matrix(3, 2);
  EXPECT_LT((distances_to_cone(values, {more}, product, modes) - distances).norm(), 1e-11);
  const FreeModes everything{random.signed_matrix(n, n)};
  EXPECT_LT(distances_to_cone(values, basis, product, everything).norm(), 1e-11);
}

TEST(DistancesToCone, NoModesAreNoModes) {
  Random random(3);
  const SparseMatrix product = grid_mass(3);
  const ConeBasis basis{random.nonnegative(9, 4)};
  const Matrix values = random.signed_matrix(9, 5);
  EXPECT_EQ(distances_to_cone(values, basis, product),
            distances_to_cone(values, basis, product, {Matrix(9, 0)}));
}

} // namespace rbvi::cone_distances_test
