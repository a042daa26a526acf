#include "rbvi/method/balance.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/method/anderson.hpp"
#include "rbvi/method/nonnegative_qp.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace rbvi {

namespace {

/// Tractions whose sums with positive factors are all that a bound of 1 allows; of two components
/// the corners about the circle, so that no load counts as unbalanced which is not.
std::vector<std::array<double, 2>> tractions_of(Index components) {
  if (components < 2) return {{-1, 0}, {1, 0}};
  constexpr int corners = 32;
  constexpr double turn = 2 * std::numbers::pi / corners;
  std::vector<std::array<double, 2>> result;
  for (int k = 0; k < corners; ++k)
    result.push_back(
        {std::cos(k * turn) / std::cos(turn / 2), std::sin(k * turn) / std::cos(turn / 2)});
  return result;
}

} // namespace

Vector unbalanced_load(const NodeLaws &laws, const Matrix &held, const Vector &load,
                       const Vector &terms) {
  constexpr double round_off = 1e-9;
  if (!(load.norm() > round_off * terms.norm())) return Vector::Zero(load.size());
  std::vector<Vector> rays;
  for (Index node = 0; node < laws.nodes(); ++node) {
    const Vector normal = held.row(laws.normal[node]);
    const FrictionBound &bound = laws.bound[node];
    rays.push_back(normal);
    if (!laws.has_tangent(node) || !bound.carries_traction(true)) continue;
    for (const auto &[along, across] : tractions_of(laws.free_at(node))) {
      Vector traction = along * held.row(laws.tangent[node]).transpose();
      if (across != 0) traction += across * held.row(laws.tangent[node] + 1).transpose();
      const auto [offset, slope] = bound.piece(0);
      rays.push_back(offset > 0 ? traction : Vector(normal + slope * traction));
    }
  }
  Matrix columns(load.size(), std::ssize(rays));
  for (std::size_t ray = 0; ray < rays.size(); ++ray)
    columns.col(static_cast<Index>(ray)) = rays[ray];
  NonnegativeQp projection(load.size());
  projection.solve(columns, load);
  const Vector left = projection.residual();
  return left.norm() > round_off * terms.norm() ? left : Vector::Zero(load.size());
}

Vector forces_on_motions(const NodeLaws &laws, const Matrix &held, const Vector &terms,
                         const Vector &x) {
  Vector sizes = x.cwiseAbs();
  for (Index node = 0; node < laws.nodes(); ++node)
    for (Index t = 0; laws.has_tangent(node) && t < laws.tangents; ++t) {
      double &size = sizes[laws.tangent[node] + t];
      size = std::max(size, laws.bound[node].steepest() * std::abs(x[laws.normal[node]]));
    }
  return terms + held.cwiseAbs().transpose() * sizes;
}

namespace {

using Lengths = std::function<SpringState(const Vector &beta)>;

/// The lengths; nothing where the contact problem has no answer.
std::optional<SpringState> attempt(const Lengths &lengths, const Vector &beta) {
  try {
    return lengths(beta);
  } catch (const Error &) {
    return std::nullopt;
  }
}

/// Whether the excess is as small as can be.
bool balances(const Balance &at, double scale, double tolerance) {
  constexpr double round_off = 1e-10;
  const double resolved =
      std::numeric_limits<double>::epsilon() * at.beta.norm(); // of lengths - beta
  return resolved <= round_off * scale && at.excess.norm() <= tolerance * scale;
}

/// Steps of Newton's method where slopes are known, else of Anderson's acceleration.
class Steps {
public:
  explicit Steps(Index motions) : anderson_(motions) {}
  void forget() {
    anderson_ = Anderson(excess_.size());
    images_.clear();
  }
  Vector next(const SpringState &state, const Vector &beta, const Vector &excess) {
    constexpr double longest = 1e6; // over the excess
    constexpr int most_rises = 4;   // of the excess, after which slopes are not followed
    if (excess_.size() > 0 && excess.norm() > excess_.norm()) ++rises_;
    excess_ = excess;
    images_.push_back(state.lengths);
    const Vector shares = anderson_.combine(excess);
    if (std::ssize(images_) > shares.size()) images_.erase(images_.begin());
    if (state.slope.size() > 0 && rises_ < most_rises) {
      const Eigen::FullPivLU<Matrix> slope(state.slope);
      const Vector step = -slope.solve(excess);
      if (slope.isInvertible() && step.norm() <= longest * excess.norm()) return step;
    }
    Vector step = -beta;
    for (Index j = 0; j < shares.size(); ++j)
      step += shares[j] * images_[j];
    if (step.norm() > longest * excess.norm()) step *= longest * excess.norm() / step.norm();
    return step;
  }

private:
  Anderson anderson_;
  std::vector<Vector> images_;
  Vector excess_;
  int rises_ = 0;
};

/// The balance from `beta` on by Anderson's acceleration of beta <- lengths(beta), or by Newton's
/// steps where slopes are known. Where the excess hardly changes from solve to solve, the bodies
/// fly apart: then beta grows along the excess, four times as far each time, until something
/// touches or `flies` says that nothing does. Not converged: the least excess that was met.
Balance accelerated(Vector beta, const Lengths &lengths) {
  constexpr int most_solves = 100, patience = 30; // without a smaller excess
  constexpr double tolerance = 1e-12, round_off = 1e-10, farthest = 1e10;
  constexpr double constant = 1e-6, weak = 0.04; // changes of the excess, over it
  Balance result;
  Steps steps(beta.size());
  Vector last, tried_at, best;
  double step = 1, least = 0, tried = std::numeric_limits<double>::infinity();
  int best_at = 0;
  while (result.solves < std::min(most_solves, best_at + patience)) {
    const std::optional<SpringState> solved =
        result.solves == 0 ? lengths(beta) : attempt(lengths, beta);
    ++result.solves;
    if (!solved) break;
    const SpringState &state = *solved;
    const double before = least;
    result.beta = beta;
    result.excess = state.lengths - beta;
    const double size = result.excess.norm();
    const bool stalls = result.solves > 1 && size > 0.5 * before;
    // The excess stays as it is where nothing touches, and nearly so where what touches is much
    // softer than the springs: there one accelerated step is tried first.
    const double change = last.size() > 0 ? (result.excess - last).norm() : size;
    const bool hardly = size > 0 && change <= weak * size;
    bool flies = hardly && !(step == 1 && change > constant * size && size < 0.5 * tried);
    result.converged = !flies && balances(result, state.scale, stalls ? round_off : tolerance);
    result.flies = !(step < farthest);
    if (result.converged || result.flies) return result;
    if (result.solves == 1 || size < least) {
      best = beta;
      best_at = result.solves;
    }
    least = result.solves == 1 ? size : std::min(least, size);
    if (tried_at.size() > 0 && !(size < 0.5 * tried)) {
      beta = tried_at;
      result.excess = last;
      flies = true;
    }
    tried_at.resize(0);
    step = flies ? 4 * step : 1;
    last = result.excess;
    if (flies) {
      steps.forget();
      beta += step * result.excess;
      continue;
    }
    if (hardly) {
      tried = size;
      tried_at = beta;
    }
    beta += steps.next(state, beta, result.excess);
  }
  result.beta = best;
  return result;
}

/// The path along which what the springs bear at first is let go: points (beta, s) with
///
///   excess(beta) = (1 - s) excess(first),    s = 0 at first, and 1 where forces balance,
///
/// the balance under a load between two that can be balanced. Of a piecewise affine excess it is a
/// chain of lines. It is followed by its length, so that it may turn back in s, past the plateaus
/// and corners about which Newton's method turns for ever. Beta in parts of |excess(first)|: of
/// loads that are proportional the same path.
class Path {
public:
  Path(Vector first, int solves, const Lengths &lengths)
      : lengths_(lengths), first_(std::move(first)), motions_(first_.size()) {
    found_.solves = solves;
  }
  Balance run() {
    constexpr int most_solves = 3000;
    constexpr double first_length = 0.1, at_corner = 1e-4, farthest = 1e8;
    here_ = Vector::Zero(motions_ + 1);
    if (!begin()) return std::move(found_);
    double length = first_length;
    bool going = set_direction();
    while (going && found_.solves < most_solves && here_.norm() < farthest) {
      Vector next = here_ + length * direction_;
      const bool ends = next[motions_] >= 1;
      if (ends) next = here_ + (1 - here_[motions_]) / direction_[motions_] * direction_;
      const Vector beyond = next;
      const Matrix slopes = slopes_;
      const int steps = correct(next, ends, length);
      if (found_.converged) return std::move(found_);
      if (steps == 0 && length > at_corner) {
        slopes_ = slopes;
        length /= 4;
        continue;
      }
      // Across a corner the path may turn by more than a right angle.
      here_ = steps > 0 ? next : beyond;
      length *= steps == 0 ? 4 : steps <= 2 ? 2 : 1;
      if (here_[motions_] < -at_corner && !turned_) { // on a plateau both ways are as good
        turned_ = true;
        side_ = -side_;
        here_.setZero();
        length = first_length;
      }
      going = set_direction();
    }
    return std::move(found_);
  }

private:
  static constexpr double difference = 1e-7, near = 1e-8;

  bool begin() {
    const std::optional<Vector> excess = excess_at(here_);
    if (!excess || !(excess->norm() > 0)) return false;
    unit_ = excess->norm();
    let_go_ = *excess / unit_;
    return true;
  }
  /// The lengths; nothing where the contact problem has no answer.
  std::optional<Vector> excess_at(const Vector &point) {
    ++found_.solves;
    found_.beta = first_ + unit_ * point.head(motions_);
    const std::optional<SpringState> state = attempt(lengths_, found_.beta);
    if (!state) return std::nullopt;
    found_.excess = state->lengths - found_.beta;
    scale_ = state->scale;
    slope_ = state->slope;
    return found_.excess;
  }
  /// How far off the path, in parts of what is let go.
  std::optional<Vector> off_path(const Vector &point) {
    std::optional<Vector> excess = excess_at(point);
    if (excess) *excess = *excess / unit_ - (1 - point[motions_]) * let_go_;
    return excess;
  }
  /// The way on from here: what the slopes leave free, always with the same side to its left.
  bool set_direction() {
    slopes_.resize(motions_, motions_ + 1);
    const std::optional<Vector> off = off_path(here_);
    if (!off) return false;
    slopes_.col(motions_) = let_go_;
    const bool known = slope_.size() > 0;
    if (known) slopes_.leftCols(motions_) = slope_;
    for (Index j = 0; j < motions_ && !known; ++j) {
      Vector moved = here_;
      moved[j] += difference;
      const std::optional<Vector> there = off_path(moved);
      if (!there) return false;
      slopes_.col(j) = (*there - *off) / difference;
    }
    const Eigen::JacobiSVD<Matrix, Eigen::FullPivHouseholderQRPreconditioner> svd(
        slopes_, Eigen::ComputeFullV);
    direction_ = svd.matrixV().col(motions_);
    const double turn = bordered(direction_).determinant();
    if (side_ == 0) side_ = direction_[motions_] < 0 ? -turn : turn;
    if (turn * side_ < 0) direction_ = -direction_;
    return true;
  }
  Matrix bordered(const Vector &last) const {
    Matrix rows(motions_ + 1, motions_ + 1);
    rows << slopes_, last.transpose();
    return rows;
  }
  /// Back onto the path, across it or, at its end, with s = 1; no farther than that. Returns the
  /// solves, 0: in vain.
  int correct(Vector &point, bool ends, double farthest) {
    constexpr double tolerance = 1e-12, round_off = 1e-10;
    const int most = ends ? 20 : 6;
    const Vector across = ends ? Vector::Unit(motions_ + 1, motions_) : direction_;
    const Vector predicted = point;
    std::optional<Vector> off = off_path(point);
    for (int solves = 1; off; ++solves) {
      if (ends && balances(found_, scale_, solves < most ? tolerance : round_off)) {
        found_.converged = true;
        return solves;
      }
      if (!ends && off->norm() <= near) return solves;
      if (solves == most) return 0;
      Vector right = Vector::Zero(motions_ + 1);
      right.head(motions_) = -*off;
      const Vector step = bordered(across).fullPivLu().solve(right);
      point += step;
      if (!((point - predicted).norm() <= farthest)) return 0;
      const std::optional<Vector> next = off_path(point);
      if (!next) return 0;
      if (step.norm() > 0) // Broyden's: of one corner the slopes beyond it
        slopes_ += (*next - *off - slopes_ * step) * step.transpose() / step.squaredNorm();
      off = next;
    }
    return 0;
  }

  const Lengths &lengths_;
  const Vector first_;
  const Index motions_;
  Balance found_;
  Vector here_, direction_, let_go_;
  Matrix slopes_, slope_; ///< of off_path by the point; those that are known
  double unit_ = 1, scale_ = 0, side_ = 0;
  bool turned_ = false;
};

} // namespace

Balance find_balance(Vector beta, const Lengths &lengths) {
  Balance result = accelerated(beta, lengths);
  if (result.converged || result.flies) return result;
  Balance along_path = Path(std::move(beta), result.solves, lengths).run();
  if (along_path.converged) return along_path;
  result.solves = along_path.solves;
  return result;
}

} // namespace rbvi
