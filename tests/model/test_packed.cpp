// Symmetric matrices by the lower triangles of their diagonal blocks.
#include "rbvi/core/error.hpp"
#include "rbvi/model/packed.hpp"

#include <gtest/gtest.h>

namespace rbvi::packed_test {
namespace {

/// Two symmetric matrices with blocks of these orders, the second one with every other block alone.
Matrix two_matrices(const std::vector<int> &orders, Index n) {
  Matrix squares = Matrix::Zero(n * n, 2);
  Index first = 0;
  for (std::size_t k = 0; k < orders.size(); ++k) {
    const Matrix random = Matrix::Random(orders[k], orders[k]);
    for (Index t = 0; t < (k % 2 == 0 ? 2 : 1); ++t)
      squares.col(t).reshaped(n, n).block(first, first, orders[k], orders[k]) =
          random + random.transpose() +
          3.0 * Matrix::Constant(orders[k], orders[k], static_cast<double>(t + 1));
    first += orders[k];
  }
  return squares;
}

TEST(PackedBlocks, AreFoundAndComeBack) {
  for (const std::vector<int> &orders :
       {std::vector{3, 1, 4}, std::vector{5, 5}, std::vector{1}, std::vector{2, 6}}) {
    Index n = 0, entries = 0;
    for (const int order : orders) {
      n += order;
      entries += order * (order + 1) / 2;
    }
    const Matrix squares = two_matrices(orders, n);
    EXPECT_EQ(diagonal_blocks(squares), orders);
    const Matrix packed = pack_blocks(squares, orders);
    EXPECT_EQ(packed.rows(), entries);
    EXPECT_TRUE(unpacked_blocks(packed, orders) == squares);
  }
}

/// One entry of one matrix between two blocks makes them one, with all that lie between.
TEST(PackedBlocks, AreJoinedByOneEntry) {
  const Index n = 8;
  for (const Index term : {0, 1}) {
    Matrix squares = two_matrices({3, 1, 4}, n);
    auto square = squares.col(term).reshaped(n, n);
    square(6, 1) = square(1, 6) = 1e-300;
    const std::vector<int> blocks = diagonal_blocks(squares);
    EXPECT_EQ(blocks, std::vector{8});
    EXPECT_TRUE(unpacked_blocks(pack_blocks(squares, blocks), blocks) == squares);
  }
}

TEST(PackedBlocks, OfOtherOrdersAreRefused) {
  const Matrix packed = pack_blocks(two_matrices({3, 4}, 7), {3, 4});
  EXPECT_THROW(unpacked_blocks(packed, {3, 3}), Error);
  EXPECT_THROW(unpacked_blocks(packed, {7}), Error);
}

} // namespace
} // namespace rbvi::packed_test
