// Inf-sup constants of contact with friction on a rigid disk.
#include "../linear_algebra.hpp"
#include "disk.hpp"
#include "reduced.hpp"

#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/mor/high_fidelity_pair.hpp"
#include "rbvi/mor/nodal_dual_basis.hpp"
#include "rbvi/solve/response_solver.hpp"
#include "rbvi/study/stability_report.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::support_stability_test {
namespace {

using namespace testing_reduced;

/// Roots of the smallest and of the largest theta with squares y = theta gram y.
std::pair<double, double> extremes(const Matrix &squares, const Matrix &gram) {
  const Vector values = generalised_eigenvalues(squares, gram);
  return {std::sqrt(std::max(values(0), 0.0)), std::sqrt(values(values.size() - 1))};
}

/// Constants of normal and tangential multipliers together, against generalised eigenproblems of
/// the reduced b that a query uses, and of B V^-1 B^T.
TEST(SupportStability, ConstantsAreThoseOfGeneralisedEigenproblems) {
  Reduced r(disk("radius", {{"normal", "rigid"}}), "grid:21");
  r.reduce(published());
  const std::vector<Mu> set{{0.73}, {1.01}, {1.28}};
  const StabilityCheck check = make_stability_check(r.problem, r.model);
  const std::vector<InfSup> found =
      infsup_over(PETSC_COMM_WORLD, r.problem, check, at_rest(set), r.model.contact.b.size() == 1);
  ResponseSolver solver(r.problem.v_product(), r.problem.trace(), "v_");
  // Generators of a greedy cone nearly depend on each other: orthonormal functions of their span.
  const Matrix w = Matrix(r.problem.w_product());
  const Eigen::LLT<Matrix> factor(w);
  const Matrix functions =
      multiplier_functions(r.model.contact.dual_basis, r.model.contact.law->basis);
  const ThinSvd svd = thin_svd((factor.matrixU() * functions).colwise().normalized());
  ASSERT_GT(svd.values(functions.cols() - 1), 1e-8 * svd.values(0));
  const Matrix x = factor.matrixU().solve(svd.left);
  const Matrix coefficients = nodal_coefficients(r.model.contact.dual_basis, x);
  const Matrix one = Matrix::Identity(x.cols(), x.cols());
  Operators op;
  for (std::size_t p = 0; p < set.size(); ++p) {
    r.problem.assemble_contact(set[p], op);
    const FullMu all = expand(r.problem.scene().parameters, set[p]);
    const Vector theta = contact_coefficients(r.model.contact.b, Part::b, r.problem.contact(),
                                              r.problem.scene(), all);
    const Matrix b =
        coefficients.transpose() * (r.model.contact.b.reduced * theta)
                                       .reshaped(r.model.contact.generators, r.model.primal_size());
    const Matrix modes = b.leftCols(r.model.body.modes);
    const Matrix loads = Matrix(op.b.transpose());
    const Matrix squares = op.b * solver.responses(loads);
    const auto [beta, c] = extremes(squares, w);
    const InfSup &at = found[p];
    EXPECT_NEAR(at.hf, beta, 1e-8 * beta);
    EXPECT_NEAR(at.c_hf, c, 1e-10 * c);
    const double on = extremes(x.transpose() * squares * x, one).first;
    EXPECT_NEAR(at.on, on, 1e-6 * on);
    const double off = extremes(b * b.transpose(), one).first;
    EXPECT_NEAR(at.off, off, 1e-6 * off);
    EXPECT_NEAR(at.dec, extremes(modes * modes.transpose(), one).first, 1e-6 * c);
    EXPECT_GE(at.on * (1 + 1e-9), at.off);
    EXPECT_GE(at.off * (1 + 1e-9), at.dec);
    EXPECT_GE(at.on * (1 + 1e-9), at.hf);
  }
}

/// sigma below the smallest beta_HF / c_HF meets the published condition of stability (2.23) at
/// every training mu.
TEST(SupportStability, TheToleranceIsThatOfTheHighFidelityPair) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  for (const char *normal : {"radial", "rigid"}) {
    SCOPED_TRACE(normal);
    Reduced r(disk("radius", {{"normal", normal}}), "grid:13");
    r.reduce(published());
    const std::vector<Mu> set = r.mus();
    const StabilityCheck check = make_stability_check(r.problem, r.model);
    double smallest = 1;
    for (const InfSup &at : infsup_over(world, r.problem, check, at_rest(set), false))
      smallest = std::min(smallest, at.hf / at.c_hf);
    ASSERT_EQ(r.model.made.histories.at("pga/tolerance").size(), 1U);
    EXPECT_NEAR(r.model.made.histories.at("pga/tolerance").front(), smallest, 1e-9 * smallest);
    EXPECT_LE(r.model.made.histories.at("pga/sigma").back(), smallest);
    const auto rows =
        stability_along(world, r.problem, check, at_rest(set), {0, r.model.body.supremizers});
    EXPECT_GE(rows.front().condition, 1) << "without supremizers the condition says nothing";
    EXPECT_LT(rows.back().condition, 1);
    EXPECT_GT(rows.back().classic, 0);
  }
}

/// A similarity multiplies b by the radius: so do the constants, and those of the smallest radius
/// are the smallest.
TEST(SupportStability, ConstantsAreProportionalToTheRadius) {
  Problem problem(PETSC_COMM_WORLD, disk("radius"), {});
  const RieszSpace space = make_riesz_space(problem.v_product(), problem.trace());
  Operators op;
  problem.assemble_contact({1}, op);
  const PairConstants one = dense_constants(problem, space, op);
  EXPECT_GT(one.beta, 0);
  problem.assemble_contact({0.8}, op);
  const PairConstants other = dense_constants(problem, space, op);
  EXPECT_NEAR(other.beta, 0.8 * one.beta, 1e-9 * one.beta);
  EXPECT_NEAR(other.c, 0.8 * one.c, 1e-9 * one.c);
  EXPECT_EQ(weakest_form(problem, at_rest({{0.9}, {0.75}, {1.3}})).mu, Mu{0.75});
}

/// In the norms of the mapped half-disk, V(R) = R^2 (mass + stiffness / R^2) and W(R) = R W, as the
/// text has the tolerance. Another code gives 0.059 as the smallest over [0.7, 1.3] on a mesh of
/// as many arc nodes; the ratio goes with the root of the mesh width beside the arc.
TEST(SupportStability, TheRatioInNormsOfTheMappedDomainIsThatOfAnotherCode) {
  std::vector<double> ratios;
  for (const double radius : {0.7, 1.3}) {
    Scene scene = make_scene("rigid_disk");
    scene.v_product = {exact_term(h1_product(1 / radius, 2, 2))};
    Problem problem(PETSC_COMM_WORLD, scene, {});
    const RieszSpace space = make_riesz_space(problem.v_product(), problem.trace());
    Operators op;
    problem.assemble_contact({radius}, op);
    const PairConstants pair = dense_constants(problem, space, op);
    ratios.push_back(pair.beta / pair.c);
  }
  EXPECT_NEAR(ratios[0], 0.059, 0.002);
  EXPECT_GT(ratios[1], ratios[0]);
}

} // namespace
} // namespace rbvi::support_stability_test
