#include "rbvi/mor/stability.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/mor/small_svd.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double tie = 1e-10;
constexpr double inside = 1e-12;      // a supremizer this close to the space is in it
constexpr double same_space = 1e-9;   // sine of the largest principal angle
constexpr double cancellation = 1e-6; // a Gram matrix that shrank this much is computed afresh

/// One training parameter: sigma^2 is the largest eigenvalue of gram = range^T (I - Pi) range.
struct Candidate {
  Matrix range; // orthonormal columns that span S_R(mu); T(mu) X until it is first needed
  Matrix gram;
  double built = 1; // largest eigenvalue when gram was last computed afresh
  double sigma = 1; // upper bound
  Index seen = -1;  // columns of the space in gram; -1: range is still T(mu) X
  Index exact = -1; // number of columns at which sigma is the value itself
};

/// V_N + S in coordinates, and the supremizers that made it.
struct Space {
  Index contact, modes, size;
  Matrix columns; // storage for all, `size` of them in use
  Matrix sources; // contact x supremizers: unit vectors of S_R(mu) before projection

  auto in_use() const { return columns.leftCols(size); }

  /// (I - Pi) of vectors with contact coordinates alone.
  Matrix remainder(const Matrix &top) const {
    Matrix rest = Matrix::Zero(columns.rows(), top.cols());
    rest.topRows(contact) = top;
    rest.noalias() -= in_use() * (in_use().topRows(contact).transpose() * top);
    return rest;
  }

  void add(const Vector &source) {
    Vector column = remainder(source);
    column -= in_use() * (in_use().transpose() * column);
    sources.col(size - modes) = source;
    columns.col(size) = column.normalized();
    ++size;
  }
};

double largest_eigenvalue(const Matrix &gram) {
  if (gram.rows() == 0) return 0;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(gram, Eigen::EigenvaluesOnly);
  if (eigen.info() != Eigen::Success)
    throw failure("an eigenproblem of the projected greedy did not converge");
  return std::max(eigen.eigenvalues().tail(1)(0), 0.0);
}

void update(Candidate &candidate, const Space &space) {
  if (candidate.seen < 0) {
    candidate.range = orthonormal_range(candidate.range);
    candidate.gram.setIdentity(candidate.range.cols(), candidate.range.cols());
    candidate.seen = 0;
  }
  const auto fresh =
      space.columns.block(0, candidate.seen, space.contact, space.size - candidate.seen);
  const Matrix overlap = candidate.range.transpose() * fresh;
  candidate.gram.selfadjointView<Eigen::Lower>().rankUpdate(overlap, -1);
  candidate.seen = space.size;
}

/// Whether sigma is below `needed`, by a Cholesky factorisation: several times cheaper than the
/// eigenvalue, and all that most candidates need.
bool certainly_below(const Candidate &candidate, double needed) {
  const double square = needed * needed;
  if (square < cancellation * candidate.built) return false;
  Matrix shifted = -candidate.gram;
  shifted.diagonal().array() += square;
  return Eigen::LLT<Eigen::Ref<Matrix>>(shifted).info() == Eigen::Success;
}

void evaluate(Candidate &candidate, const Space &space) {
  double eigenvalue = largest_eigenvalue(candidate.gram);
  if (eigenvalue < cancellation * candidate.built) {
    const Matrix rest = space.remainder(candidate.range);
    candidate.gram.noalias() = rest.transpose() * rest;
    eigenvalue = candidate.built = largest_eigenvalue(candidate.gram);
  }
  candidate.sigma = std::min(candidate.sigma, std::sqrt(eigenvalue));
  candidate.exact = space.size;
}

/// The training index with the largest sigma, the lowest among equals. Only candidates whose old
/// value could still win are looked at, the most promising first.
int greedy_choice(std::vector<Candidate> &candidates, const Space &space, int &evaluations) {
  const auto count = static_cast<int>(candidates.size());
  const auto at = [&](int p) -> Candidate & { return candidates[static_cast<std::size_t>(p)]; };
  int winner = -1;
  double best = 0;
  const auto needed = [&](int p) { return p < winner ? best * (1 - tie) : best * (1 + tie); };
  while (true) {
    int next = -1;
    for (int p = 0; p < count; ++p) {
      const bool open = at(p).exact != space.size && (winner < 0 || at(p).sigma > needed(p));
      if (open && (next < 0 || at(p).sigma > at(next).sigma)) next = p;
    }
    if (next < 0) return winner;
    if (at(next).seen != space.size) update(at(next), space);
    if (winner >= 0 && certainly_below(at(next), needed(next))) {
      at(next).sigma = needed(next);
      continue;
    }
    evaluate(at(next), space);
    ++evaluations;
    best = std::max(best, at(next).sigma);
    for (int p = count - 1; p >= 0; --p)
      if (at(p).exact == space.size && at(p).sigma >= (1 - tie) * best) winner = p;
  }
}

/// Unit vectors of S_R(mu) that are farthest from the space: one, or all of a multiple eigenvalue.
Matrix farthest(const Candidate &candidate) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(candidate.gram);
  if (eigen.info() != Eigen::Success)
    throw failure("an eigenproblem of the projected greedy did not converge");
  const Vector &values = eigen.eigenvalues();
  Index multiplicity = 1;
  while (multiplicity < values.size() &&
         values(values.size() - 1 - multiplicity) >= (1 - 2 * tie) * values(values.size() - 1))
    ++multiplicity;
  return candidate.range * eigen.eigenvectors().rightCols(multiplicity).rowwise().reverse();
}

struct Target {
  double sigma; // stop at or below
  Index size;   // and at this number of supremizers
  const char *reached;

  const char *stop(double sigma_now, Index size_now) const {
    if (sigma_now <= inside) return "the space contains all supremizers";
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

bool one_space(const Matrix &range, const std::vector<Matrix> &supremizers) {
  return std::all_of(supremizers.begin() + 1, supremizers.end(), [&](const Matrix &other) {
    const Matrix basis = orthonormal_range(other);
    return basis.cols() == range.cols() &&
           (basis - range * (range.transpose() * basis)).norm() <= same_space;
  });
}

/// The greedy on a single space takes the singular vectors of (I - Pi) range one after the other.
void take_singular_vectors(Pga &result, Space &space, const Matrix &range, const Target &target) {
  result.parameter_independent = true;
  result.evaluations = 1;
  const SmallSvd svd = small_svd(space.remainder(range));
  for (Index n = 0;; ++n) {
    result.sigma.push_back(n < svd.values.size() ? std::min(svd.values(n), 1.0) : 0);
    if (const char *reason = target.stop(result.sigma.back(), n)) {
      result.reason = reason;
      return;
    }
    space.add(range * svd.right.col(n));
    result.selected.push_back(-1);
  }
}

void sweep(Pga &result, Space &space, std::vector<Matrix> supremizers, const Target &target) {
  std::vector<Candidate> candidates(supremizers.size());
  for (std::size_t p = 0; p < candidates.size(); ++p)
    candidates[p].range = std::move(supremizers[p]);
  while (true) {
    const int chosen = greedy_choice(candidates, space, result.evaluations);
    const Candidate &candidate = candidates[static_cast<std::size_t>(chosen)];
    const char *reason = target.stop(candidate.sigma, space.size - space.modes);
    if (reason != nullptr) {
      result.sigma.push_back(candidate.sigma);
      result.reason = reason;
      return;
    }
    const Matrix sources = farthest(candidate);
    const Index room = target.size - (space.size - space.modes);
    for (Index k = 0; k < std::min(sources.cols(), room); ++k) {
      space.add(sources.col(k));
      result.sigma.push_back(candidate.sigma);
      result.selected.push_back(chosen);
    }
  }
}

} // namespace

Pga projected_greedy(const RieszSpace &space, const Matrix &modes, std::vector<Matrix> supremizers,
                     const PgaOptions &options) {
  const Index contact = space.factor.rows();
  const Target target = make_target(options, contact);
  if (supremizers.empty()) throw failure("the projected greedy needs a training parameter");
  Space enriched{contact, modes.cols(), modes.cols(),
                 Matrix(modes.rows(), modes.cols() + target.size), Matrix(contact, target.size)};
  enriched.columns.leftCols(modes.cols()) = modes;

  Pga result;
  const Matrix range = orthonormal_range(supremizers.front());
  if (one_space(range, supremizers))
    take_singular_vectors(result, enriched, range, target);
  else
    sweep(result, enriched, std::move(supremizers), target);
  result.coordinates = enriched.in_use();
  const Index added = enriched.size - enriched.modes;
  result.representers = enriched.sources.leftCols(added);
  if (added > 0)
    space.factor.transpose().triangularView<Eigen::Upper>().solveInPlace(result.representers);
  return result;
}

} // namespace rbvi
