#include "rbvi/mor/stability.hpp"

#include "grid.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/small_svd.hpp"
#include "stability_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rbvi::pga_test {
namespace {

using testing_grid::random_matrix;

constexpr Index contact = 24;

RieszSpace make_space(unsigned seed) {
  Matrix factor = random_matrix(contact, contact, seed).triangularView<Eigen::Lower>();
  factor.diagonal().array() = factor.diagonal().array().abs() + 2;
  return {factor, {}, {}, {}, nullptr};
}

Matrix orthonormal(Index rows, Index columns, unsigned seed) {
  return Eigen::HouseholderQR<Matrix>(random_matrix(rows, columns, seed)).householderQ() *
         Matrix::Identity(rows, columns);
}

/// Modes that see the contact dofs, and supremizers that turn slowly with the parameter.
struct Example {
  RieszSpace space;
  Matrix modes;
  std::vector<Matrix> supremizers;
};

Example make_example(Index size, Index cone, Index parameters, unsigned seed) {
  Example example{make_space(seed), orthonormal(contact + size, size, seed + 1), {}};
  const Matrix common = random_matrix(contact, cone, seed + 2);
  const Vector decay = Vector::LinSpaced(contact, 0, -6).array().exp();
  for (Index p = 0; p < parameters; ++p)
    example.supremizers.push_back(
        common + 0.4 * decay.asDiagonal() *
                     random_matrix(contact, cone, seed + 10 + static_cast<unsigned>(p)));
  return example;
}

Matrix embedded(const Matrix &top, Index rows) {
  Matrix all = Matrix::Zero(rows, top.cols());
  all.topRows(top.rows()) = top;
  return all;
}

/// sigma_S(mu) from scratch: largest singular value of (I - Pi) on an orthonormal basis of S_R(mu).
double brute_sigma(const Matrix &space, const Matrix &supremizers) {
  const Matrix range = embedded(small_svd(supremizers).left, space.rows());
  return singular_values(range - space * (space.transpose() * range))(0);
}

double brute_worst(const Matrix &space, const std::vector<Matrix> &supremizers) {
  double worst = 0;
  for (const Matrix &one : supremizers)
    worst = std::max(worst, brute_sigma(space, one));
  return worst;
}

class Greedy : public testing::TestWithParam<std::tuple<Index, Index, unsigned>> {};

TEST_P(Greedy, sigma_and_the_stability_bound_hold_at_every_step) {
  const auto [size, cone, seed] = GetParam();
  const Example example = make_example(size, cone, 7, seed);
  const Pga pga = projected_greedy(PETSC_COMM_SELF, example.space, example.modes,
                                   example.supremizers, {.tolerance = 1e-4});
  const auto added = static_cast<Index>(pga.selected.size());
  ASSERT_EQ(pga.coordinates.cols(), size + added);
  ASSERT_EQ(pga.sigma.size(), pga.selected.size() + 1);
  EXPECT_EQ(pga.coordinates.leftCols(size), example.modes);
  EXPECT_LE(
      (pga.coordinates.transpose() * pga.coordinates - Matrix::Identity(size + added, size + added))
          .cwiseAbs()
          .maxCoeff(),
      1e-12);
  EXPECT_GE(pga.selected.front(), 0);
  EXPECT_LE(pga.sigma.back(), 1e-4);
  for (Index step = 0; step <= added; ++step) {
    const Matrix enriched = pga.coordinates.leftCols(size + step);
    const double sigma = pga.sigma[step];
    EXPECT_NEAR(sigma, brute_worst(enriched, example.supremizers), 1e-9 + 1e-6 * sigma);
    if (step > 0) {
      EXPECT_LE(sigma, pga.sigma[step - 1]);
    }
    for (const Matrix &supremizers : example.supremizers) {
      const double off = infsup_constant(enriched, supremizers);
      const double on = singular_values(supremizers)(cone - 1);
      // The root of 1 - sigma^2 turns the round-off of sigma near 1 into 2e-8.
      EXPECT_LE(std::sqrt(std::max(1 - sigma * sigma, 0.0)) * on, off + 3e-8 * on);
      const StabilityBound bound = stability_bound(enriched, supremizers);
      EXPECT_LE(bound.sharp, off + 1e-13 * on);
      EXPECT_LE(bound.classic, off + 1e-13 * on);
      EXPECT_LE(bound.sigma, sigma + 1e-9);
    }
  }
}

TEST_P(Greedy, each_step_takes_the_worst_parameter_and_its_worst_direction) {
  const auto [size, cone, seed] = GetParam();
  const Example example = make_example(size, cone, 7, seed);
  const Pga pga = projected_greedy(PETSC_COMM_SELF, example.space, example.modes,
                                   example.supremizers, {.tolerance = 0.05});
  const auto added = static_cast<Index>(pga.selected.size());
  ASSERT_EQ(pga.representers.cols(), added);
  const Matrix sources = example.space.factor.transpose() * pga.representers;
  for (Index step = 0; step < added; ++step) {
    const Matrix enriched = pga.coordinates.leftCols(size + step);
    const auto chosen = static_cast<std::size_t>(pga.selected[step]);
    const double sigma = pga.sigma[step];
    EXPECT_NEAR(brute_sigma(enriched, example.supremizers[chosen]), sigma, 1e-9);
    for (std::size_t p = 0; p < chosen; ++p)
      EXPECT_LT(brute_sigma(enriched, example.supremizers[p]), sigma) << "ties go to the lowest";
    // The source is a unit vector of S_R(mu), the new column its normalised remainder.
    const Matrix range = small_svd(example.supremizers[chosen]).left;
    const Vector source = sources.col(step);
    EXPECT_NEAR(source.norm(), 1, 1e-10);
    EXPECT_LE((source - range * (range.transpose() * source)).norm(), 1e-10);
    const Vector top = embedded(source, enriched.rows());
    const Vector rest = top - enriched * (enriched.transpose() * top);
    EXPECT_NEAR(rest.norm(), sigma, 1e-9);
    EXPECT_LE((rest / rest.norm() - pga.coordinates.col(size + step)).norm(), 1e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Greedy,
                         testing::Combine(testing::Values<Index>(0, 3, 9),
                                          testing::Values<Index>(1, 4, 6),
                                          testing::Values(20U, 60U)));

TEST(Pga, stability_fraction_is_reached_and_not_by_luck) {
  const Example example = make_example(4, 6, 9, 100);
  for (const double fraction : {0.5, 0.9, 0.99}) {
    const Pga pga = projected_greedy(PETSC_COMM_SELF, example.space, example.modes,
                                     example.supremizers, {.stability = fraction});
    EXPECT_EQ(pga.reason, "stability reached");
    for (const Matrix &supremizers : example.supremizers)
      EXPECT_GE(infsup_constant(pga.coordinates, supremizers),
                fraction * singular_values(supremizers)(5) * (1 - 1e-12));
    const double before = pga.sigma[pga.sigma.size() - 2];
    EXPECT_LT(std::sqrt(1 - before * before), fraction);
  }
}

TEST(Pga, few_eigenproblems_per_step) {
  const Example example = make_example(6, 5, 40, 200);
  const Pga pga = projected_greedy(PETSC_COMM_SELF, example.space, example.modes,
                                   example.supremizers, {.tolerance = 0.02});
  EXPECT_GT(pga.selected.size(), 10U);
  EXPECT_LT(pga.evaluations, 8 * static_cast<int>(pga.sigma.size())) << "of 40 candidates each";
}

TEST(Pga, small_sigma_is_not_round_off) {
  // Two spaces that differ by an angle of 1e-7: sigma^2 is below round-off of one.
  Example example = make_example(0, 3, 1, 300);
  const double angle = 1e-7;
  const Matrix q = orthonormal(contact, 4, 301);
  Matrix turned = q.leftCols(3);
  turned.col(1) = std::cos(angle) * q.col(1) + std::sin(angle) * q.col(3);
  example.supremizers = {q.leftCols(3), turned};
  const Pga pga = projected_greedy(PETSC_COMM_SELF, example.space, example.modes,
                                   example.supremizers, {.tolerance = 1e-10});
  ASSERT_EQ(pga.sigma.size(), 5U);
  EXPECT_NEAR(pga.sigma[3], angle, 1e-3 * angle);
  EXPECT_LE(pga.sigma[4], 1e-10);
  EXPECT_EQ(pga.selected, (std::vector<int>{0, 0, 0, 1}));
  EXPECT_LE((pga.coordinates.transpose() * pga.coordinates - Matrix::Identity(4, 4)).norm(), 1e-12);
}

TEST(Pga, one_space_for_all_parameters_needs_one_svd) {
  Example example = make_example(5, 6, 1, 400);
  const Matrix first = example.supremizers.front();
  for (int p = 1; p < 6; ++p)
    example.supremizers.push_back((1 + 0.3 * p) * first);
  const PgaOptions options{.tolerance = 1e-3};
  const Pga pga =
      projected_greedy(PETSC_COMM_SELF, example.space, example.modes, example.supremizers, options);
  EXPECT_EQ(pga.selected.front(), -1);
  EXPECT_EQ(pga.evaluations, 1);
  for (const int p : pga.selected)
    EXPECT_EQ(p, -1);
  const auto added = static_cast<Index>(pga.selected.size());
  for (Index step = 0; step <= added; ++step)
    EXPECT_NEAR(pga.sigma[step], brute_sigma(pga.coordinates.leftCols(5 + step), first), 1e-10);
  EXPECT_LE((pga.coordinates.transpose() * pga.coordinates - Matrix::Identity(5 + added, 5 + added))
                .norm(),
            1e-12);
  const Pga alone =
      projected_greedy(PETSC_COMM_SELF, example.space, example.modes, {first}, options);
  EXPECT_EQ(alone.coordinates, pga.coordinates);

  // The sweep finds the same space: made to run by a second space that is contained already.
  example.supremizers = {first, first.leftCols(3)};
  const Pga swept =
      projected_greedy(PETSC_COMM_SELF, example.space, example.modes, example.supremizers, options);
  EXPECT_GE(swept.selected.front(), 0);
  ASSERT_EQ(swept.sigma.size(), pga.sigma.size());
  for (std::size_t k = 0; k < pga.sigma.size(); ++k)
    EXPECT_NEAR(swept.sigma[k], pga.sigma[k], 1e-9);
}

TEST(Pga, nothing_to_add) {
  Example example = make_example(3, 4, 3, 500);
  example.modes = Matrix::Identity(contact + contact, contact);
  const Pga pga =
      projected_greedy(PETSC_COMM_SELF, example.space, example.modes, example.supremizers, {});
  EXPECT_EQ(pga.selected.size(), 0U);
  EXPECT_EQ(pga.representers.cols(), 0);
  EXPECT_EQ(pga.coordinates.cols(), contact);
  EXPECT_LE(pga.sigma.front(), 1e-12);
  EXPECT_EQ(pga.reason, "the space contains all supremizers");
}

/// The matrices of this rank's turns.
std::vector<Matrix> mine_of(const std::vector<Matrix> &all) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  std::vector<Matrix> mine;
  for (auto p = static_cast<std::size_t>(rank); p < all.size();
       p += static_cast<std::size_t>(ranks))
    mine.push_back(all[p]);
  return mine;
}

TEST(Pga, choices_and_counts_do_not_depend_on_the_number_of_ranks) {
  for (const Index parameters : {2, 11, 30}) {
    Example example = make_example(6, 5, parameters, 800);
    // Exact ties, on different ranks: the same spaces once more, spanned by other vectors.
    for (Index p = 0; p < parameters; ++p)
      example.supremizers.push_back(example.supremizers[p] *
                                    orthonormal(5, 5, 900 + static_cast<unsigned>(p)));
    const PgaOptions options{.tolerance = 1e-3};
    const Pga alone = projected_greedy(PETSC_COMM_SELF, example.space, example.modes,
                                       example.supremizers, options);
    const Pga shared = projected_greedy(PETSC_COMM_WORLD, example.space, example.modes,
                                        mine_of(example.supremizers), options);
    EXPECT_GT(alone.selected.size(), 4U);
    EXPECT_EQ(shared.selected, alone.selected);
    EXPECT_EQ(shared.evaluations, alone.evaluations);
    EXPECT_EQ(shared.reason, alone.reason);
    EXPECT_EQ(shared.sigma, alone.sigma);
    EXPECT_EQ(shared.coordinates, alone.coordinates);
    EXPECT_EQ(shared.representers, alone.representers);
    for (const int p : alone.selected)
      EXPECT_LT(p, parameters) << "of equals the lowest index";
  }
}

TEST(Pga, one_space_on_several_ranks) {
  Example example = make_example(5, 6, 1, 810);
  const Matrix first = example.supremizers.front();
  for (int p = 1; p < 7; ++p)
    example.supremizers.push_back((1 + 0.3 * p) * first);
  const Pga pga = projected_greedy(PETSC_COMM_WORLD, example.space, example.modes,
                                   mine_of(example.supremizers), {.tolerance = 1e-3});
  const Pga one =
      projected_greedy(PETSC_COMM_SELF, example.space, example.modes, {first}, {.tolerance = 1e-3});
  EXPECT_EQ(pga.selected.front(), -1);
  EXPECT_EQ(pga.coordinates, one.coordinates);
}

TEST(Pga, a_failure_on_one_rank_is_that_of_all) {
  Example example = make_example(3, 4, 9, 820);
  example.supremizers.back()(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(projected_greedy(PETSC_COMM_WORLD, example.space, example.modes,
                                mine_of(example.supremizers), {}),
               Error);
  EXPECT_THROW(projected_greedy(PETSC_COMM_WORLD, example.space, example.modes, {}, {}), Error);
}

TEST(Pga, dependent_supremizers_and_more_of_them_than_dofs) {
  Example example = make_example(2, 4, 3, 600);
  for (Matrix &one : example.supremizers)
    one = (one * random_matrix(4, contact + 5, 601)).eval();
  const Pga pga = projected_greedy(PETSC_COMM_SELF, example.space, example.modes,
                                   example.supremizers, {.tolerance = 1e-6});
  EXPECT_LE(pga.sigma.back(), 1e-6);
  EXPECT_LE(pga.selected.size(), 12U);
}

TEST(Pga, size_bound_and_bad_options) {
  const Example example = make_example(2, 5, 4, 700);
  const Pga pga = projected_greedy(PETSC_COMM_SELF, example.space, example.modes,
                                   example.supremizers, {.tolerance = 1e-3, .max_size = 4});
  EXPECT_EQ(pga.selected.size(), 4U);
  EXPECT_EQ(pga.reason, "maximal size reached");
  const auto run = [&](const PgaOptions &options) {
    return projected_greedy(PETSC_COMM_SELF, example.space, example.modes, example.supremizers,
                            options);
  };
  EXPECT_THROW(run({.tolerance = 1}), Error);
  EXPECT_THROW(run({.stability = 1}), Error);
  EXPECT_THROW(run({.max_size = -1}), Error);
  Example bad = make_example(2, 5, 4, 700);
  bad.supremizers[2](1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(projected_greedy(PETSC_COMM_SELF, bad.space, bad.modes, bad.supremizers, {}), Error);
}

} // namespace
} // namespace rbvi::pga_test
