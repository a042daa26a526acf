#include "../../src/method/loaded_columns.hpp"
#include "random_matrix.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace rbvi::loaded_columns_test {
namespace {

/// A column of one of two bodies is zero on the other.
class TwoBodies : public Compliance {
public:
  TwoBodies(Index first, Index second, Random &random)
      : Compliance(first + second), first_(first),
        c_(Matrix::Zero(first + second, first + second)) {
    c_.topLeftCorner(first, first) = random.matrix(first, first);
    c_.bottomRightCorner(second, second) = random.matrix(second, second);
  }
  Range body_of(Index dof) const override {
    return dof < first_ ? Range{0, first_} : Range{first_, c_.rows() - first_};
  }
  const Matrix &dense() const { return c_; }

private:
  void make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) override {
    columns = c_(Eigen::all, dofs);
  }
  Index first_;
  Matrix c_;
};

// Against a dense product: any number of loads of either body, any part of the entries.
TEST(LoadedColumns, MoveAsTheWholeMatrix) {
  Random random(1);
  for (Index second = 0; second < 9; ++second) {
    TwoBodies bodies(7, second, random);
    const Index size = bodies.size();
    std::vector<Index> all(size);
    std::iota(all.begin(), all.end(), 0);
    bodies.require(all);
    for (Index zeros = 0; zeros <= size; zeros += 3) {
      Vector loads = random.vector(size);
      for (Index k = 0; k < zeros; ++k)
        loads[(5 * k) % size] = 0;
      LoadedColumns columns;
      columns.add(loads, bodies);
      const Vector u = random.vector(size);
      for (Index first = 0; first < size; first += 2)
        for (Index count = 0; first + count <= size; count += 3) {
          Vector left = u, expected = u;
          columns.subtract_from(left, {first, count});
          expected.segment(first, count) -= (bodies.dense() * loads).segment(first, count);
          EXPECT_LE((left - expected).norm(), 1e-13 * expected.norm());
        }
    }
  }
}

} // namespace
} // namespace rbvi::loaded_columns_test
