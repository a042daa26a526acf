// Niakh (2022): (2.27)-(2.29), (2.31), (2.32), (A.21), (A.22), Algorithm 1, Lemma 2.3.1.
// Niakh (2022): Remark 2.3.1.
#include "rbvi/mor/stability.hpp"

#include "pga_candidate.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/small_svd.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace rbvi {

namespace {

/// Collective. `matrix` of rank `root` on every rank.
Matrix broadcast(MPI_Comm comm, int root, Matrix matrix) {
  std::array<Index, 2> size{matrix.rows(), matrix.cols()};
  MPI_Bcast(size.data(), static_cast<int>(sizeof size), MPI_BYTE, root, comm);
  matrix.resize(size[0], size[1]);
  MPI_Bcast(matrix.data(), static_cast<int>(matrix.size()), MPI_DOUBLE, root, comm);
  return matrix;
}

constexpr double in_the_space = 1e-12; // a supremizer this close to the space is in it
constexpr double same_space = 1e-9;    // sine of the largest principal angle
constexpr double arithmetic = 1e-8;    // what bounds by different ways may differ by, relative

/// The training parameters, shared among the ranks: those of this rank, and of all the bounds.
class Candidates {
public:
  /// Collective. `supremizers`: T(mu_p) X for p = rank, rank + ranks, ...
  Candidates(MPI_Comm comm, std::vector<Matrix> supremizers) : comm_(comm), eigen_("pga_") {
    for (Matrix &one : supremizers)
      mine_.emplace_back(std::move(one));
    unsigned long count = mine_.size();
    MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_UNSIGNED_LONG, MPI_SUM, comm);
    sigma_.assign(count, 1);
  }

  /// Collective. The training index with the largest sigma, the lowest among equals. Most are ruled
  /// out by bounds: old values, then Cholesky factorisations with numbers that the largest is not
  /// below. The others are evaluated, the same for any number of ranks.
  int choose(const PgaSpace &space) {
    constexpr int most_bisections = 8;
    double needed = (1 - arithmetic) * floor(space);
    screen(needed, space);
    for (int k = 0; k < most_bisections && above(needed) > 1; ++k) {
      const double middle = (needed + *std::max_element(sigma_.begin(), sigma_.end())) / 2;
      screen(middle, space);
      if (above(middle) > 0) needed = middle;
    }
    return evaluate_above(needed, space);
  }

  double sigma(int p) const { return sigma_[p]; }
  int evaluations() const { return evaluations_; }

  /// Collective. Of the candidate that was chosen: PgaCandidate::farthest.
  Matrix farthest(int p) const {
    const int owner = p % ranks_;
    Matrix vectors;
    if (rank_ == owner) vectors = mine_[p / ranks_].farthest();
    return broadcast(comm_, owner, vectors);
  }

private:
  /// Calls visit(p, candidate) for those of this rank; a failure is that of every rank.
  template <class Visit> void each(Visit &&visit) {
    collectively(comm_, [&] {
      for (std::size_t k = 0; k < mine_.size(); ++k)
        visit(static_cast<std::size_t>(rank_) + k * static_cast<std::size_t>(ranks_), mine_[k]);
    });
  }

  /// A number that the largest sigma is not below: the best of a few with the largest bounds.
  double floor(const PgaSpace &space) {
    constexpr std::size_t promising = 16;
    std::vector<std::size_t> order(sigma_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t p, std::size_t q) { return sigma_[p] > sigma_[q]; });
    order.resize(std::min(order.size(), promising));
    double highest = 0;
    each([&](std::size_t p, PgaCandidate &candidate) {
      if (std::find(order.begin(), order.end(), p) != order.end())
        highest = std::max(highest, candidate.lower_bound(space));
    });
    MPI_Allreduce(MPI_IN_PLACE, &highest, 1, MPI_DOUBLE, MPI_MAX, comm_);
    return highest;
  }

  long above(double needed) const {
    return std::count_if(sigma_.begin(), sigma_.end(), [&](double s) { return s > needed; });
  }

  /// Lowers the bounds to `needed` where sigma is certainly below.
  void screen(double needed, const PgaSpace &space) {
    each([&](std::size_t p, PgaCandidate &candidate) {
      if (sigma_[p] > needed && candidate.certainly_below(space, needed)) sigma_[p] = needed;
    });
    share_bounds();
  }

  void share_bounds() { over_ranks(comm_, MPI_MIN, sigma_); }

  /// Evaluates the candidates whose bounds are above `needed`, which the largest is not below, and
  /// where that turns out to be within a tie of it those whose bound it is; the winner.
  int evaluate_above(double needed, const PgaSpace &space) {
    std::vector<char> exact(sigma_.size(), 0);
    double best = 0;
    while (true) {
      std::vector<char> open(sigma_.size(), 0);
      for (std::size_t p = 0; p < open.size(); ++p)
        open[p] = exact[p] == 0 && sigma_[p] > needed ? 1 : 0;
      each([&](std::size_t p, PgaCandidate &candidate) {
        if (open[p] != 0) sigma_[p] = std::min(sigma_[p], candidate.evaluate(space, eigen_));
      });
      share_bounds();
      for (std::size_t p = 0; p < open.size(); ++p) {
        if (open[p] == 0) continue;
        exact[p] = 1;
        ++evaluations_;
        best = std::max(best, sigma_[p]);
      }
      const double equals = (1 - 2 * pga_tie) * best;
      if (needed <= equals) break;
      needed = equals;
    }
    std::size_t winner = 0;
    while (exact[winner] == 0 || sigma_[winner] < (1 - pga_tie) * best)
      ++winner;
    return static_cast<int>(winner);
  }

  MPI_Comm comm_;
  int rank_ = rank_of(comm_), ranks_ = ranks_of(comm_), evaluations_ = 0;
  SmallEigen eigen_;
  std::vector<PgaCandidate> mine_;
  std::vector<double> sigma_; // upper bounds of all, the same on every rank
};

struct Target {
  double sigma; // stop at or below
  Index size;   // and at this number of supremizers
  const char *reached;

  const char *stop(double sigma_now, Index size_now) const {
    if (sigma_now <= in_the_space) return "the space contains all supremizers";
    if (sigma_now <= sigma) return reached;
    return size_now >= size ? "maximal size reached" : nullptr;
  }
};

Target make_target(const PgaOptions &options, Index largest) {
  if (!(options.tolerance >= 0 && options.tolerance < 1))
    throw bad_input("the tolerance of the projected greedy must be in [0, 1)");
  if (!(options.stability > 0 && options.stability < 1))
    throw bad_input("the stability fraction of the projected greedy must be in (0, 1)");
  if (options.max_size < 0)
    throw bad_input("the maximal size of the projected greedy must not be negative");
  const Index size = options.max_size > 0 ? std::min<Index>(options.max_size, largest) : largest;
  if (options.tolerance > 0) return {options.tolerance, size, "tolerance reached"};
  return {std::sqrt((1 - options.stability) * (1 + options.stability)), size, "stability reached"};
}

/// Collective. An orthonormal basis of S_R(mu_0), and whether it is that of every training mu.
struct FirstSpace {
  Matrix range;
  bool only;
};

FirstSpace first_space(MPI_Comm comm, const std::vector<Matrix> &supremizers) {
  FirstSpace first;
  int differ = 0;
  collectively(comm, [&] {
    if (rank_of(comm) == 0) first.range = orthonormal_range(supremizers.front());
  });
  first.range = broadcast(comm, 0, std::move(first.range));
  collectively(comm, [&] {
    const bool same = std::all_of(supremizers.begin(), supremizers.end(), [&](const Matrix &one) {
      const Matrix basis = orthonormal_range(one);
      return basis.cols() == first.range.cols() &&
             (basis - first.range * (first.range.transpose() * basis)).norm() <= same_space;
    });
    differ = same ? 0 : 1;
  });
  MPI_Allreduce(MPI_IN_PLACE, &differ, 1, MPI_INT, MPI_MAX, comm);
  first.only = differ == 0;
  return first;
}

/// The greedy on a single space takes the singular vectors of (I - Pi) range one after the other.
void take_singular_vectors(Pga &result, PgaSpace &space, const Matrix &range,
                           const Target &target) {
  result.evaluations = 1;
  const SmallSvd svd = small_svd(space.remainder(range), "pga_");
  for (Index n = 0;; ++n) {
    result.sigma.push_back(n < svd.values.size() ? std::min(svd.values(n), 1.0) : 0);
    if (const char *reason = target.stop(result.sigma.back(), n)) {
      result.reason = reason;
      return;
    }
    space.take(range * svd.right.col(n), svd.left.col(n));
    result.selected.push_back(-1);
  }
}

void sweep(Pga &result, PgaSpace &space, Candidates candidates, const Target &target) {
  while (true) {
    const int chosen = candidates.choose(space);
    const double sigma = candidates.sigma(chosen);
    const char *reason = target.stop(sigma, space.size - space.modes);
    if (reason != nullptr) {
      result.sigma.push_back(sigma);
      result.evaluations = candidates.evaluations();
      result.reason = reason;
      return;
    }
    const Matrix sources = candidates.farthest(chosen);
    const Index room = target.size - (space.size - space.modes);
    for (Index k = 0; k < std::min(sources.cols(), room); ++k) {
      space.add(sources.col(k));
      result.sigma.push_back(sigma);
      result.selected.push_back(chosen);
    }
  }
}

} // namespace

Pga projected_greedy(MPI_Comm comm, const RieszSpace &space, const Matrix &modes,
                     std::vector<Matrix> supremizers, const PgaOptions &options) {
  const Index contact = space.factor.rows();
  const Target target = make_target(options, contact);
  collectively(comm, [&] {
    if (rank_of(comm) == 0 && supremizers.empty())
      throw failure("the projected greedy needs a training parameter");
  });
  PgaSpace enriched{contact, modes.cols(), modes.cols(),
                    Matrix(modes.rows(), modes.cols() + target.size), Matrix(contact, target.size)};
  enriched.columns.leftCols(modes.cols()) = modes;

  Pga result;
  const FirstSpace first = first_space(comm, supremizers);
  if (first.only)
    take_singular_vectors(result, enriched, first.range, target);
  else
    sweep(result, enriched, Candidates(comm, std::move(supremizers)), target);
  result.coordinates = enriched.in_use();
  const Index added = enriched.size - enriched.modes;
  result.representers = enriched.sources.leftCols(added);
  if (added > 0)
    space.factor.transpose().triangularView<Eigen::Upper>().solveInPlace(result.representers);
  return result;
}

} // namespace rbvi
