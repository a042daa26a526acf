#include "rbvi/mor/condensed.hpp"

#include "condensed_loads.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/mor/orthonormal.hpp"
#include "rbvi/mor/response_space.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/progress.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/solve/complement.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>

namespace rbvi {

namespace {

/// Sums of more than two exact terms: what the responses of the body may leave, relative. The
/// displacements of answers leave as much or less, as combinations of the loads take in more than
/// they have to, and 1e-6 of them is wanted: 2.9e-7 measured on the disk with two stiffnesses.
constexpr double response_tolerance = 5e-7;
constexpr int most_responses = 200; ///< factorisations

/// The free parameters of A over its common coefficient, each with so many points.
std::vector<ChebyshevAxis> axes_of(const Scene &scene, int points) {
  std::vector<ChebyshevAxis> axes;
  for (const int i : parameters_beside_common(scene.a, scene.parameters)) {
    const Parameter &p = scene.parameters.all[i];
    const auto [lower, upper] =
        std::minmax({coordinate_at(scene, i, p.lower), coordinate_at(scene, i, p.upper)});
    axes.push_back({i, lower, upper, points});
  }
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

/// As few terms as hold the values at all grid points, columns * coordinates with orthonormal
/// columns, to the tolerance. `columns`: (blocks * `square`) x any number.
void compress(const Matrix &columns, const Matrix &coordinates, Index square, double tolerance,
              CondensedOperator &condensed) {
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
}

/// The free parameters at each point of a grid over those of A, the others as in `all_parameters`.
std::vector<Mu> free_grid(const Scene &scene, const std::vector<ChebyshevAxis> &axes,
                          const FullMu &all_parameters) {
  std::vector<Mu> result;
  for (const FullMu &point : grid_points(scene, axes, all_parameters)) {
    Mu mu;
    for (const int i : scene.parameters.free)
      mu.push_back(point[i]);
    result.push_back(std::move(mu));
  }
  return result;
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
                      LinearBasis *modes, std::vector<Mu> ends)
      : problem_(problem), of_(loads), responses_(responses), modes_(modes),
        ends_(std::move(ends)) {}

  /// Collective.
  Vector blocks_at(const Mu &mu) {
    ++factorisations;
    const Mat a = problem_.assemble(mu).a;
    if (modes_ != nullptr && std::find(ends_.begin(), ends_.end(), mu) != ends_.end()) {
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
    const double least = appended == 0 ? 1e-8 : responses_;
    Matrix traces;
    appended += static_cast<int>(append_fields(solver, loads, *modes_, least, &traces).size());
    return traces;
  }

  Problem &problem_;
  const CondensedLoads &of_;
  double responses_;
  LinearBasis *modes_;
  std::vector<Mu> ends_;
};

/// Values at points, a few at a time: a grid has thousands of them, of as many numbers as pairs of
/// multipliers, in the span of few.
class SpannedValues {
public:
  explicit SpannedValues(double tolerance) : tolerance_(tolerance) {}

  /// At the points that are not there yet. `blocks_at`: a column for each of some mu. Collective.
  template <class BlocksAt>
  void add(const std::vector<Mu> &grid, bool reports, BlocksAt &&blocks_at) {
    constexpr std::size_t width = 16; // points at a time
    std::vector<Mu> added;
    std::ranges::copy_if(grid, std::back_inserter(added),
                         [&](const Mu &mu) { return !known_.contains(mu); });
    Progress progress("points of the condensed operator", static_cast<int>(added.size()), reports);
    const double start = MPI_Wtime();
    for (std::size_t first = 0; first < added.size(); first += width) {
      const std::size_t end = std::min(first + width, added.size());
      const std::vector<Mu> part(added.begin() + static_cast<std::ptrdiff_t>(first),
                                 added.begin() + static_cast<std::ptrdiff_t>(end));
      const Matrix blocks = blocks_at(part);
      span_.append(blocks, tolerance_);
      const Matrix coordinates = span_.coordinates(blocks);
      for (std::size_t k = 0; k < part.size(); ++k)
        known_.emplace(part[k], coordinates.col(static_cast<Index>(k)));
      const double left = static_cast<double>(added.size() - end) / static_cast<double>(end);
      if (progress.due()) progress.update(static_cast<int>(end), left * (MPI_Wtime() - start));
    }
  }
  const Matrix &columns() const { return span_.columns(); }
  /// columns() x points.
  Matrix coordinates_at(const std::vector<Mu> &grid) const {
    Matrix result = Matrix::Zero(columns().cols(), std::ssize(grid));
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const Vector &known = known_.at(grid[k]);
      result.col(static_cast<Index>(k)).head(known.size()) = known;
    }
    return result;
  }

private:
  double tolerance_;
  OrthonormalColumns span_;
  std::map<Mu, Vector> known_; // a finer grid holds the points of the coarser one, bit by bit
};

/// Values at a grid that is made finer along the axes that need it until the interpolant is right
/// to the tolerance, or has the most points along them: their coordinates in the columns of
/// `known`. `blocks_at`: at some mu, a column for each, over the common coefficient of A^-1.
/// Collective.
template <class BlocksAt>
Matrix values_on_grid(const Problem &problem, const FullMu &all, const CondensedOptions &options,
                      CondensedOperator &condensed, SpannedValues &known, BlocksAt &&blocks_at) {
  const Scene &scene = problem.scene();
  condensed.axes = axes_of(scene, 5);
  while (true) {
    const std::vector<Mu> grid = free_grid(scene, condensed.axes, all);
    known.add(grid, rank_of(problem.comm()) == 0, blocks_at);
    Matrix coordinates = known.coordinates_at(grid);
    const Vector tails = chebyshev_tails(condensed.axes, coordinates);
    condensed.error = tails.size() > 0 ? tails.maxCoeff() : 0;
    bool finer = false;
    for (std::size_t d = 0; d < condensed.axes.size(); ++d) {
      ChebyshevAxis &axis = condensed.axes[d];
      if (tails[d] <= options.tolerance || 2 * axis.points - 1 > options.max_points) continue;
      axis.points = 2 * axis.points - 1;
      finer = true;
    }
    if (finer) continue;
    if (condensed.error > options.tolerance && rank_of(problem.comm()) == 0)
      std::fprintf(
          stderr,
          "rbvi: warning: the condensed operator is interpolated to %.1e only by %d points "
          "along a parameter of the stiffness: narrow its bounds, or raise "
          "-condensed_tolerance\n",
          condensed.error, options.max_points);
    return coordinates;
  }
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
  const ResponseSearch search{axes_of(scene, 1), expand(scene.parameters, training.front()),
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
  constexpr double left_out = 1e-2; // of the tolerance
  SpannedValues known(left_out * options.tolerance);
  Matrix coordinates;
  if (appends && loads.join && split.mapped.empty() && split.exact.size() > 2) {
    const ResponseSpace space =
        append_responses(problem, loads.columns, weights_of(multipliers),
                         {axes_of(scene, 1), all, response_tolerance, most_responses}, *modes);
    const ReducedResponses reduced(problem, loads.columns, *modes);
    coordinates =
        values_on_grid(problem, all, options, condensed, known, [&](const std::vector<Mu> &set) {
          Matrix blocks = Matrix::Zero(size * size, std::ssize(set));
          take_turns(problem.comm(), set.size(), [&](std::size_t k) {
            blocks.col(static_cast<Index>(k)) =
                common(set[k]) *
                blocks_of(reduced.compliance(expand(scene.parameters, set[k])), size);
          });
          for (auto column : blocks.colwise())
            over_ranks(problem.comm(), MPI_SUM, column);
          return blocks;
        });
    result.responses = space.functions;
    result.factorisations = space.points;
  } else {
    FactorisedResponses exact(problem, loads, options.responses, appends ? modes : nullptr,
                              free_grid(scene, axes_of(scene, 3), all));
    coordinates =
        values_on_grid(problem, all, options, condensed, known, [&](const std::vector<Mu> &set) {
          Matrix blocks;
          for (std::size_t k = 0; k < set.size(); ++k) {
            const Vector column = common(set[k]) * exact.blocks_at(set[k]);
            blocks.conservativeResize(column.size(), std::ssize(set));
            blocks.col(static_cast<Index>(k)) = column;
          }
          return blocks;
        });
    result.responses = exact.appended;
    result.factorisations = exact.factorisations;
  }
  condensed.dofs = loads.units;
  compress(known.columns(), coordinates, size * size, options.tolerance, condensed);
  return result;
}

} // namespace rbvi
