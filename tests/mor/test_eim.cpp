#include "rbvi/mor/eim.hpp"

#include "grid.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rbvi::eim_test {
namespace {

using testing_grid::random_matrix;

constexpr Index entries = 60;

EntryKey key_of(Index e) {
  return {static_cast<PetscInt>(e / 7), static_cast<PetscInt>(e % 7)};
}

struct Local {
  Matrix values;
  std::vector<EntryKey> keys;
};

/// Entry e goes to rank (3 e + e / 5) mod ranks: interleaved.
Local scatter(const Matrix &all) {
  PetscMPIInt ranks = 0, rank = 0;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  std::vector<Index> mine;
  for (Index e = all.rows() - 1; e >= 0; --e)
    if ((3 * e + e / 5) % ranks == rank) mine.push_back(e);
  Local local{Matrix(static_cast<Index>(mine.size()), all.cols()), {}};
  for (std::size_t k = 0; k < mine.size(); ++k) {
    local.values.row(static_cast<Index>(k)) = all.row(mine[k]);
    local.keys.push_back(key_of(mine[k]));
  }
  return local;
}

Eim run(const Matrix &all, const EimOptions &options) {
  const Local local = scatter(all);
  return eim(PETSC_COMM_WORLD, local.values, local.keys, options);
}

Index entry_of(const EntryKey &key) {
  return 7 * static_cast<Index>(key.row) + key.column;
}

Matrix smooth(Index count) {
  Matrix values(entries, count);
  for (Index p = 0; p < count; ++p)
    for (Index e = 0; e < entries; ++e) {
      const double x = static_cast<double>(e) / (entries - 1);
      const double mu = static_cast<double>(p) / static_cast<double>(count - 1);
      values(e, p) = std::sin(3 * x * (1 + mu)) / (1.1 + x - mu);
    }
  return values;
}

/// The selected snapshots combined: A_1, ..., A_J.
Matrix terms_of(const Eim &result, const Matrix &all) {
  return all(Eigen::all, result.snapshots) * result.combination;
}

/// (B.35)-(B.36) for every training snapshot.
Matrix interpolant(const Eim &result, const Matrix &all) {
  Matrix sampled(result.size(), all.cols());
  for (Index j = 0; j < result.size(); ++j)
    sampled.row(j) = all.row(entry_of(result.entries[j]));
  return terms_of(result, all) *
         result.interpolation.triangularView<Eigen::UnitLower>().solve(sampled);
}

TEST(Eim, error_history_is_the_true_error_at_every_size) {
  const Matrix all = smooth(25);
  const Eim full = run(all, {.tolerance = 1e-9});
  EXPECT_EQ(full.reason, "tolerance reached");
  EXPECT_EQ(full.error.front(), 1);
  ASSERT_EQ(full.error.size(), full.snapshots.size() + 1);
  EXPECT_LE(full.error.back(), 1e-9);
  for (int size = 1; size <= full.size(); ++size) {
    const Eim result = run(all, {.tolerance = 0, .max_size = size});
    ASSERT_EQ(result.size(), size);
    const double error =
        (all - interpolant(result, all)).cwiseAbs().maxCoeff() / all.cwiseAbs().maxCoeff();
    EXPECT_NEAR(error, result.error.back(), 1e-6 * error + 1e-14);
    EXPECT_EQ(result.error.back(), full.error[size]);
  }
}

TEST(Eim, interpolates_sampled_entries_and_selected_snapshots) {
  const Matrix all = smooth(20);
  const Eim result = run(all, {.tolerance = 1e-7});
  const Matrix approximation = interpolant(result, all);
  for (int j = 0; j < result.size(); ++j) {
    const auto k = static_cast<std::size_t>(j);
    const Index e = entry_of(result.entries[k]);
    EXPECT_LE((approximation.row(e) - all.row(e)).cwiseAbs().maxCoeff(), 1e-12);
    const int p = result.snapshots[k];
    EXPECT_LE((approximation.col(p) - all.col(p)).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(Eim, interpolation_matrix_holds_the_terms_at_the_entries) {
  const Matrix all = smooth(20);
  const Eim result = run(all, {.tolerance = 1e-6});
  const Matrix terms = terms_of(result, all);
  ASSERT_EQ(result.interpolation.rows(), result.size());
  for (Index j = 0; j < result.size(); ++j) {
    const Index e = entry_of(result.entries[j]);
    EXPECT_EQ(result.interpolation(j, j), 1);
    for (Index i = 0; i < result.size(); ++i) {
      if (i > j) {
        EXPECT_EQ(result.interpolation(j, i), 0);
      }
      if (i > j) {
        EXPECT_EQ(result.combination(i, j), 0);
      }
      // Small remainders of large terms: the round-off of their sum.
      const Vector sum = all.row(e).transpose()(result.snapshots).cwiseAbs();
      EXPECT_NEAR(terms(e, i), result.interpolation(j, i),
                  4 * std::numeric_limits<double>::epsilon() *
                      sum.dot(result.combination.col(i).cwiseAbs()));
    }
    EXPECT_LE(result.interpolation.row(j).cwiseAbs().maxCoeff(), 1 + 1e-9);
  }
}

TEST(Eim, separable_input_stops_at_its_rank_and_says_so) {
  const Matrix one = random_matrix(entries, 1, 1) * random_matrix(1, 15, 2);
  const Eim first = run(1e-7 * one, {.tolerance = 1e-3});
  EXPECT_EQ(first.size(), 1);
  EXPECT_EQ(first.reason, "separable: rank 1, error at round-off");
  EXPECT_LE(first.error.back(), 1e-14);

  const Matrix three = random_matrix(entries, 3, 3) * random_matrix(3, 15, 4);
  const Eim third = run(three, {.tolerance = 0});
  EXPECT_EQ(third.size(), 3);
  EXPECT_EQ(third.reason, "separable: rank 3, error at round-off");
  EXPECT_LE((interpolant(third, three) - three).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Eim, one_snapshot_and_full_rank) {
  const Eim single = run(random_matrix(entries, 1, 5), {});
  EXPECT_EQ(single.size(), 1);
  const Matrix all = random_matrix(entries, 6, 6);
  const Eim every = run(all, {.tolerance = 0});
  EXPECT_EQ(every.size(), 6);
  EXPECT_LE((interpolant(every, all) - all).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_FALSE(every.exact());
  EXPECT_TRUE(every.unproved());
}

TEST(Eim, snapshots_that_repeat_prove_nothing) {
  const Matrix all = random_matrix(entries, 4, 7);
  Matrix twice(entries, 8);
  twice << all, all;
  EXPECT_TRUE(run(twice, {.tolerance = 0}).unproved());
  Matrix more(entries, 9);
  more << twice, all * Vector::LinSpaced(4, 1, 2);
  EXPECT_TRUE(run(more, {.tolerance = 0}).exact());
}

TEST(Eim, zero_needs_no_term) {
  const Eim result = run(Matrix::Zero(entries, 4), {});
  EXPECT_EQ(result.size(), 0);
  EXPECT_EQ(result.error, std::vector<double>{0});
  EXPECT_NE(result.reason.find("zero"), std::string::npos);
}

TEST(Eim, same_choice_as_on_one_rank_also_with_ties) {
  Matrix all = smooth(16);
  // Mirror images and copies: exact ties in the parameter and in the entry.
  all.col(9) = -all.col(2);
  all.row(40) = all.row(12);
  all.col(4) *= 1 + 1e-13;
  Local whole{all, {}};
  for (Index e = 0; e < entries; ++e)
    whole.keys.push_back(key_of(e));
  const EimOptions options{.tolerance = 1e-8};
  const Eim serial = eim(PETSC_COMM_SELF, whole.values, whole.keys, options);
  const Eim parallel = run(all, options);
  EXPECT_EQ(parallel.snapshots, serial.snapshots);
  EXPECT_EQ(parallel.entries, serial.entries);
  EXPECT_EQ(parallel.interpolation, serial.interpolation);
  EXPECT_EQ(parallel.combination, serial.combination);
  EXPECT_EQ(parallel.error, serial.error);
  for (const EntryKey &key : serial.entries)
    EXPECT_NE(entry_of(key), 40) << "a tie must go to the lowest key";
  for (const int p : serial.snapshots)
    EXPECT_NE(p, 9) << "a tie must go to the lowest training index";
}

TEST(Eim, refuses_what_is_not_finite_on_every_rank) {
  Matrix all = smooth(5);
  all(17, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(run(all, {}), Error);
  EXPECT_THROW(run(smooth(5), {.tolerance = -1}), Error);
}

} // namespace
} // namespace rbvi::eim_test
