#include "rbvi/mor/condensed.hpp"

#include "condensed_loads.hpp"
#include "growing_grid.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/mor/orthonormal.hpp"
#include "rbvi/mor/response_space.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/progress.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/solve/complement.hpp"
#include "rounding.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace rbvi {

namespace {

/// Sums of more than two exact terms: what the responses of the body may leave, relative. The
/// displacements of answers leave as much or less, as combinations of the loads take in more than
/// they have to, and 1e-6 of them is wanted: 2.9e-7 measured on the disk with two stiffnesses.
constexpr double response_tolerance = 3e-7;
constexpr int most_responses = 200; ///< factorisations

/// The free parameters of A over its common coefficient.
std::vector<GridAxis> axes_of(const Scene &scene) {
  std::vector<GridAxis> axes;
  for (const int i : parameters_beside_common(scene.a, scene.parameters))
    axes.push_back(axis_of(scene, i));
  return axes;
}

/// The blocks of H = `loads`^T A^-1 `loads`, below each other: column by column, m^2 entries each.
Vector blocks_of(const Matrix &h, Index m) {
  const Index terms = h.cols() / m;
  Vector blocks(terms * (terms + 1) / 2 * m * m);
  Index at = 0;
  for (Index p = 0; p < terms; ++p)
    for (Index q = p; q < terms; ++q, at += m * m) {
      const Matrix block = h.block(p * m, q * m, m, m);
      const double share = p == q ? 0.5 : 1;
      blocks.segment(at, m * m) = (share * (block + block.transpose())).reshaped();
    }
  return blocks;
}

/// As few terms as hold the coefficients of all points of the grid, columns * coordinates with
/// orthonormal columns, to the tolerance. `columns`: (blocks * `square`) x any number.
void compress(const Matrix &columns, const Matrix &coordinates, Index square, double tolerance,
              CondensedOperator &condensed) {
  constexpr double rounded = 1e-5; // single nodes see what is rough
  const Index blocks = columns.rows() / square;
  const SmallSvd svd = small_svd(coordinates.transpose()); // tall: of no more than its R
  Index count = 1;
  while (count < svd.values.size() && svd.values[count] > 0.1 * tolerance * svd.values[0])
    ++count;
  condensed.shape = svd.values.head(count).asDiagonal() * svd.left.leftCols(count).transpose();
  condensed.terms.resize(square, blocks * count);
  for (Index block = 0; block < blocks; ++block)
    condensed.terms.middleCols(block * count, count) =
        columns.middleRows(block * square, square) * svd.right.leftCols(count);
  for (Index j = 0; j < count && coordinates.cols() > 1; ++j)
    for (Index block = 0; block < blocks; ++block)
      round_entries(condensed.terms.col(block * count + j),
                    rounded * tolerance * svd.values[0] / svd.values[j] *
                        std::sqrt(12 / static_cast<double>(square)));
}

/// Combinations of the multipliers, as large as those of `multipliers` (m x P) make them, and at
/// every node as large as new active sets can change them.
Matrix weights_of(const Matrix &multipliers) {
  constexpr double new_at_a_node = 0.1; ///< of the largest multiplier
  const Index m = multipliers.rows();
  const double node = new_at_a_node * multipliers.cwiseAbs().maxCoeff();
  const Matrix covariance =
      multipliers * multipliers.transpose() / static_cast<double>(multipliers.cols()) +
      node * node * Matrix::Identity(m, m);
  return cholesky(covariance, "the covariance of the multipliers");
}

/// H at single mu, each A factorised; what `condense` appends to the modes on the way.
class FactorisedResponses {
public:
  FactorisedResponses(Problem &problem, const CondensedLoads &loads, double responses,
                      LinearBasis *modes)
      : problem_(problem), of_(loads), modes_(modes) {
    constexpr double beside_motion =
        0.1; // of a free body's response its rigid motion is a large part
    least_ = problem.free_bodies().empty() ? responses : beside_motion * responses;
  }

  /// `joins`: what responses have outside the modes is appended. Collective.
  Vector blocks_at(const Mu &mu, bool joins) {
    ++factorisations;
    const Mat a = problem_.assemble(mu).a;
    if (modes_ != nullptr && joins) {
      ResponseSolver solver(a, problem_.trace(), "hf_");
      if (of_.join)
        return blocks_of(of_.columns.transpose() * append(solver, of_.columns), of_.size);
      append(solver, unit_loads(of_.columns.rows(), of_.dofs));
      return blocks_of(condensed_by_loads(a, problem_.trace(), "hf_", of_.columns, &solver),
                       of_.size);
    }
    return blocks_of(condensed_by_loads(a, problem_.trace(), "hf_", of_.columns), of_.size);
  }

  int factorisations = 0, appended = 0;

private:
  /// E^T A^-1 E loads, and what of A^-1 E loads is new.
  Matrix append(ResponseSolver &solver, const Matrix &loads) {
    const double least = appended == 0 ? 1e-8 : least_;
    Matrix traces;
    appended += static_cast<int>(append_fields(solver, loads, *modes_, least, &traces).size());
    return traces;
  }

  Problem &problem_;
  const CondensedLoads &of_;
  double least_; ///< what is new of a response, relative to its norm
  LinearBasis *modes_;
};

/// The coefficients of a sparse grid that grows: of as many numbers as pairs of multipliers, in the
/// span of few.
class SpannedSurplus {
public:
  SpannedSurplus(const Scene &scene, SparseGrid &grid, const FullMu &all, double tolerance)
      : scene_(scene), grid_(grid), all_(all), tolerance_(tolerance) {}

  /// `blocks`: values at some points, a column for each, none of which is before another one along
  /// all axes. Returns what the interpolant so far misses there, relative to the largest value.
  Vector add(const std::vector<GridPoint> &points, const Matrix &blocks) {
    span_.append(blocks, tolerance_);
    Matrix surplus = span_.coordinates(blocks);
    largest_ = std::max(largest_, surplus.colwise().norm().maxCoeff());
    const Index before = surplus_.cols();
    for (std::size_t k = 0; k < points.size() && before > 0; ++k)
      surplus.col(static_cast<Index>(k)).head(surplus_.rows()) -=
          surplus_ * grid_functions(scene_, grid_, parameters_at(scene_, grid_, points[k], all_));
    for (const GridPoint &point : points)
      grid_.append(point);
    const Index known = surplus_.rows();
    surplus_.conservativeResize(surplus.rows(), before + surplus.cols());
    surplus_.bottomLeftCorner(surplus.rows() - known, before).setZero();
    surplus_.rightCols(surplus.cols()) = surplus;
    return surplus.colwise().norm().transpose() / largest_;
  }
  const Matrix &columns() const { return span_.columns(); }
  const Matrix &coordinates() const { return surplus_; } ///< columns() x points

private:
  const Scene &scene_;
  SparseGrid &grid_;
  const FullMu &all_;
  OrthonormalColumns span_;
  Matrix surplus_;
  double tolerance_, largest_ = 0;
};

/// Those that may matter to the tolerance, with no more than so many points along an axis.
std::vector<GridPoint> wanted_points(const std::map<GridPoint, double> &candidates,
                                     const CondensedOptions &options) {
  constexpr double together = 0.1; // what many points miss adds up
  std::vector<GridPoint> wanted;
  for (const auto &[point, remainder] : candidates)
    if (remainder > together * options.tolerance &&
        std::ranges::all_of(point, [&](int number) { return number < options.max_points; }))
      wanted.push_back(point);
  return wanted;
}

/// Interpolates the values over the common coefficient of A^-1 on a sparse grid that grows until
/// what its next points miss does not matter, or there are the most points along an axis.
/// `blocks_at`: at some mu and their points, a column for each. Collective.
template <class BlocksAt>
void interpolate(const Problem &problem, const CondensedLoads &loads, const FullMu &all,
                 const CondensedOptions &options, CondensedOperator &condensed,
                 BlocksAt &&blocks_at) {
  constexpr double left_out = 1e-2; // of the tolerance
  const auto for_all_ranks = static_cast<std::size_t>(ranks_of(problem.comm()));
  const Scene &scene = problem.scene();
  condensed.grid = {axes_of(scene), leja_points(options.max_points), {}};
  GrowingGrid growing(condensed.grid.axes, Grows::interpolant);
  SpannedSurplus known(scene, condensed.grid, all, left_out * options.tolerance);
  Progress progress("points of the condensed operator", 0, rank_of(problem.comm()) == 0);
  while (true) {
    const std::map<GridPoint, double> candidates = growing.candidates();
    std::vector<GridPoint> wanted = wanted_points(candidates, options);
    condensed.error = 0;
    for (const auto &[point, remainder] : candidates)
      condensed.error = std::max(condensed.error, remainder);
    if (wanted.empty()) break;
    wanted.resize(std::min(wanted.size(), for_all_ranks));
    std::vector<Mu> set;
    for (const GridPoint &point : wanted)
      set.push_back(free_parameters_at(scene, condensed.grid, point, all));
    const Vector missed = known.add(wanted, blocks_at(set, wanted));
    for (std::size_t k = 0; k < wanted.size(); ++k)
      growing.take(wanted[k], missed[static_cast<Index>(k)]);
    progress.update(static_cast<int>(condensed.grid.size()), 0,
                    "the last ones missed " + short_number(missed.maxCoeff()) + ", wanted " +
                        short_number(options.tolerance) + ", ");
  }
  const auto last = std::ranges::max_element(condensed.grid.points);
  condensed.grid.abscissae.conservativeResize(last == condensed.grid.points.end() ? 1 : *last + 1);
  compress(known.columns(), known.coordinates(), loads.size * loads.size, options.tolerance,
           condensed);
  condensed.dofs = loads.units;
  constexpr double useless = 1e-3;
  if (condensed.error > std::max(useless, options.tolerance))
    throw failure(
        "the condensed operator is interpolated to " + short_number(condensed.error) + " only by " +
        std::to_string(options.max_points) +
        " points along a parameter of the stiffness, too coarse for a model: narrow its "
        "bounds; one that switches between a few values is a choice (values: [ONE, OTHER] "
        "in place of its range)");
  if (condensed.error > options.tolerance && rank_of(problem.comm()) == 0)
    std::fprintf(stderr,
                 "rbvi: warning: the condensed operator is interpolated to %.1e only by %d points "
                 "along a parameter of the stiffness: narrow its bounds, or raise "
                 "-condensed_tolerance\n",
                 condensed.error, options.max_points);
}

} // namespace

int add_load_responses(Problem &problem, const AffineOperators &affine,
                       const std::vector<Mu> &training, LinearBasis &modes) {
  std::vector<Handle<Vec>> mapped;
  std::vector<Vec> loads;
  for (const int snapshot : affine.f.snapshots) {
    problem.assemble(training[snapshot]);
    const Vec at_snapshot = problem.f_terms().mapped.get();
    Handle<Vec> copy;
    RBVI_CALL(VecDuplicate(at_snapshot, copy.put()));
    RBVI_CALL(VecCopy(at_snapshot, copy.get()));
    loads.push_back(copy.get());
    mapped.push_back(std::move(copy));
  }
  for (const Handle<Vec> &exact : problem.f_terms().exact)
    loads.push_back(exact.get());
  const Scene &scene = problem.scene();
  const ResponseSearch search{axes_of(scene), expand(scene.parameters, training.front()),
                              load_tolerance, most_responses};
  return append_load_responses(problem, loads, search, modes).functions;
}

Condensation condense(Problem &problem, const CondensedLoads &loads, const FullMu &all,
                      const CondensedOptions &options, LinearBasis *modes,
                      const Matrix &multipliers) {
  const Scene &scene = problem.scene();
  const Index size = loads.size;
  const bool appends =
      modes != nullptr && (loads.join || !loads.dofs.empty()) && options.responses > 0;
  const SplitSum &split = problem.a_terms().split;
  const auto common = [&](const Mu &mu) {
    return common_coefficient(scene.a, scene.parameters, expand(scene.parameters, mu));
  };
  Condensation result;
  CondensedOperator &condensed = result.condensed;
  if (appends && loads.join && split.mapped.empty() && split.exact.size() > 2) {
    const ResponseSpace space =
        append_responses(problem, loads.columns, weights_of(multipliers),
                         {axes_of(scene), all, response_tolerance, most_responses}, *modes);
    const ReducedResponses reduced(problem, loads.columns, *modes);
    interpolate(problem, loads, all, options, condensed, [&](const std::vector<Mu> &set, auto &) {
      Matrix blocks = Matrix::Zero(size * size, std::ssize(set));
      take_turns(problem.comm(), set.size(), [&](std::size_t k) {
        blocks.col(static_cast<Index>(k)) =
            common(set[k]) * blocks_of(reduced.compliance(expand(scene.parameters, set[k])), size);
      });
      for (auto column : blocks.colwise())
        over_ranks(problem.comm(), MPI_SUM, column);
      return blocks;
    });
    result.responses = space.functions;
    result.factorisations = space.points;
    return result;
  }
  FactorisedResponses exact(problem, loads, options.responses, appends ? modes : nullptr);
  interpolate(problem, loads, all, options, condensed,
              [&](const std::vector<Mu> &set, const std::vector<GridPoint> &points) {
                Matrix blocks;
                for (std::size_t k = 0; k < set.size(); ++k) {
                  const bool joins = std::ranges::all_of(points[k], [](int i) { return i <= 4; });
                  const Vector column = common(set[k]) * exact.blocks_at(set[k], joins);
                  blocks.conservativeResize(column.size(), std::ssize(set));
                  blocks.col(static_cast<Index>(k)) = column;
                }
                return blocks;
              });
  result.responses = exact.appended;
  result.factorisations = exact.factorisations;
  return result;
}

} // namespace rbvi
