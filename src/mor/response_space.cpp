#include "rbvi/mor/response_space.hpp"

#include "growing_grid.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/par/progress.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/response_solver.hpp"
#include "rbvi/solve/vectors.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <random>

namespace rbvi {

namespace {

/// The point of which most is expected.
std::pair<GridPoint, double> next_of(const GrowingGrid &grid) {
  std::pair<GridPoint, double> best{{}, 0};
  for (const auto &[point, expected] : grid.candidates())
    if (expected > best.second) best = {point, expected};
  return best;
}

/// A basis that grows, with its product P V, so that what is inside costs no product.
class GrowingBasis {
public:
  /// `product`, P: the basis is orthonormal in it. Collective.
  GrowingBasis(LinearBasis &basis, Mat product) : basis_(basis), product_(product) { keep_up(); }

  struct Appended {
    double longest; ///< of the directions outside the basis
    Index count;    ///< of those that were appended
  };
  /// Appends the directions of `fields` outside the basis that are longer than `least`. Collective.
  Appended append_remainder(Mat fields, double least) {
    Matrix rest = BorrowedRows(fields).rows();
    Matrix inside = of_product_.leftCols(known_).transpose() * rest;
    over_ranks(comm_of(fields), MPI_SUM, inside);
    with_columns(0, known_,
                 [&](Mat columns) { rest.noalias() -= BorrowedRows(columns).rows() * inside; });
    const Handle<Mat> outside = dense_like(fields, rest);
    const EigenPairs gram = eigen_pairs(projected(outside.get(), product_, outside.get()));
    const Vector lengths = gram.values.cwiseMax(0).cwiseSqrt();
    const Index count = (lengths.array() > least).count();
    const Matrix directions = rest * gram.vectors.rightCols(count).rowwise().reverse();
    if (count > 0) append_orthonormalised(basis_, dense_like(fields, directions).get(), 1e-10);
    keep_up();
    return {lengths.tail(1)[0], count};
  }

private:
  /// Takes the columns that are new. Collective.
  void keep_up() {
    const PetscInt all = basis_.size();
    if (known_ == all) return;
    with_columns(known_, all, [&](Mat fresh) {
      Handle<Mat> product;
      RBVI_CALL(MatMatMult(product_, fresh, MAT_INITIAL_MATRIX, PETSC_DEFAULT, product.put()));
      const BorrowedRows more(product.get());
      if (of_product_.cols() < all) of_product_.conservativeResize(more.rows().rows(), 2 * all);
      of_product_.middleCols(known_, all - known_) = more.rows();
    });
    known_ = all;
  }
  /// Calls use(these columns of the basis). Collective.
  template <class Use> void with_columns(PetscInt first, PetscInt after, const Use &use) {
    const BV columns = basis_.columns.get();
    RBVI_CALL(BVSetActiveColumns(columns, first, after));
    use(BorrowedColumns(columns).get());
    RBVI_CALL(BVSetActiveColumns(columns, 0, basis_.size()));
  }

  LinearBasis &basis_;
  Mat product_;
  PetscInt known_ = 0; ///< columns whose product is there
  Matrix of_product_;  ///< this rank's rows of P V, and room for more columns
};

/// Fields of the body at one mu after the other. Collective.
struct FieldSource {
  Index count;
  std::function<void(const Operators &)> set;
  std::function<Handle<Mat>(const Matrix &combinations)> combined; ///< `count` x any number
};

/// All of them, or random combinations that are as large as a single direction of them is.
Matrix combinations(Index fields, Index wanted, std::mt19937 &generator) {
  if (wanted == fields) return Matrix::Identity(fields, fields);
  std::normal_distribution<double> normal(0, 1 / std::sqrt(static_cast<double>(wanted)));
  return Matrix::NullaryExpr(fields, wanted, [&] { return normal(generator); });
}

/// Appends what fields have outside the basis by as many of their combinations as leave some
/// without a direction to append (Halko, Martinsson, Tropp 2011). `expected`: directions; then
/// those that were found. Returns the longest remainder. Collective.
double append_by_combinations(const FieldSource &source, double least, std::mt19937 &generator,
                              GrowingBasis &growing, Index &expected) {
  constexpr Index more = 8, without = 4;
  const Index wanted = std::min(source.count, expected + more);
  double longest = 0;
  expected = 0;
  while (true) {
    const Handle<Mat> fields = source.combined(combinations(source.count, wanted, generator));
    const GrowingBasis::Appended appended = growing.append_remainder(fields.get(), least);
    longest = std::max(longest, appended.longest);
    expected += appended.count;
    if (wanted == source.count || appended.count + without <= wanted) return longest;
  }
}

/// Appends what the fields of each point of a sparse grid have outside the basis, point by point
/// where most is expected. Collective.
ResponseSpace append_fields(Problem &problem, const FieldSource &source,
                            const ResponseSearch &search, LinearBasis &basis) {
  const auto &[axes, all_parameters, tolerance, most] = search;
  const SparseGrid grid{axes, leja_points(most), {}};
  const PetscInt before = basis.size();
  GrowingBasis growing(basis, problem.v_product());
  ResponseSpace result;
  GrowingGrid reached(axes, Grows::space);
  std::mt19937 generator(1); // the same on every rank
  double scale = 0;
  Index expected = 0;
  Progress progress("factorisations for displacements under unit loads", 0,
                    rank_of(problem.comm()) == 0);
  for (auto next = next_of(reached); next.second > tolerance; next = next_of(reached)) {
    result.left = next.second;
    if (result.points == most) {
      if (rank_of(problem.comm()) == 0)
        std::fprintf(
            stderr,
            "rbvi: warning: the displacements under unit loads are known to %.1e only after %d "
            "factorisations: narrow the bounds of the parameters of the stiffness\n",
            result.left, most);
      break;
    }
    const Mu mu = free_parameters_at(problem.scene(), grid, next.first, all_parameters);
    source.set(problem.assemble(mu));
    double longest = 0;
    if (scale == 0) { // at the first point all fields are wanted as they are, for their size
      const Handle<Mat> all = source.combined(Matrix::Identity(source.count, source.count));
      scale = std::sqrt(projected(all.get(), problem.v_product(), all.get()).trace());
      if (scale == 0) return result;
      const GrowingBasis::Appended first = growing.append_remainder(all.get(), tolerance * scale);
      longest = first.longest;
      expected = first.count;
    } else {
      longest = append_by_combinations(source, tolerance * scale, generator, growing, expected);
    }
    reached.take(next.first, longest / scale);
    progress.update(++result.points, 0,
                    "largest remainder " + short_number(next.second) + ", wanted " +
                        short_number(tolerance) + ", ");
  }
  result.functions = static_cast<int>(basis.size() - before);
  return result;
}

} // namespace

ResponseSpace append_responses(Problem &problem, const Matrix &loads, const Matrix &weights,
                               const ResponseSearch &search, LinearBasis &basis) {
  const Matrix weighted = loads * weights;
  std::optional<ResponseSolver> solver;
  const FieldSource source{
      weighted.cols(),
      [&](const Operators &op) {
        if (solver)
          solver->set(op.a);
        else
          solver.emplace(op.a, problem.trace(), "hf_");
      },
      [&](const Matrix &combinations) { return solver->fields(weighted * combinations); }};
  return append_fields(problem, source, search, basis);
}

ResponseSpace append_load_responses(Problem &problem, const std::vector<Vec> &loads,
                                    const ResponseSearch &search, LinearBasis &basis) {
  const Handle<KSP> ksp = make_direct_solver(problem.comm(), "hf_");
  Mat a = nullptr;
  const FieldSource source{std::ssize(loads),
                           [&](const Operators &op) {
                             a = op.a;
                             set_operator(ksp.get(), a);
                           },
                           [&](const Matrix &combinations) {
                             const Handle<Vec> u = like(loads.front());
                             PetscInt rows = 0;
                             RBVI_CALL(VecGetLocalSize(u.get(), &rows));
                             Matrix fields(rows, std::ssize(loads));
                             for (Index k = 0; k < fields.cols(); ++k) {
                               solve_linear(ksp.get(), loads[k], u.get());
                               fields.col(k) = local_values(u.get());
                             }
                             return dense_like(a, fields * combinations);
                           }};
  return append_fields(problem, source, search, basis);
}

ReducedResponses::ReducedResponses(const Problem &problem, const Matrix &loads,
                                   const LinearBasis &basis)
    : problem_(problem) {
  const BorrowedColumns columns(basis.columns.get());
  for (const Handle<Mat> &term : problem.a_terms().exact) {
    const Matrix full = projected(columns.get(), term.get(), columns.get());
    terms_.push_back((full + full.transpose()) / 2);
  }
  loads_ = restrict_to(problem.trace(), columns.get()).transpose() * loads;
}

Matrix ReducedResponses::compliance(const FullMu &all_parameters) const {
  const Scene &scene = problem_.scene();
  const std::vector<double> theta =
      exact_coefficients(scene.a, problem_.a_terms().split, scene.parameters, all_parameters);
  Matrix sum = theta[0] * terms_[0];
  for (std::size_t q = 1; q < theta.size(); ++q)
    sum += theta[q] * terms_[q];
  if (!cholesky_in_place(sum))
    throw failure("the stiffness is not positive definite at " +
                  describe(scene.parameters, all_parameters));
  Matrix half = loads_;
  solve_lower(sum, half);
  return half.transpose() * half;
}

} // namespace rbvi
