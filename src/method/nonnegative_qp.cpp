#include "rbvi/method/nonnegative_qp.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

enum : char { may_enter, in_set, banned };

std::uint64_t hash_of(Index column) {
  auto z = static_cast<std::uint64_t>(column + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

} // namespace

NonnegativeQp::NonnegativeQp(Index rows, NonnegativeQpOptions options)
    : options_(options), qr_(rows) {}

void NonnegativeQp::reset() {
  stale_ = true;
  norms_.resize(0);
}

void NonnegativeQp::start_from(std::vector<Index> active) {
  active_ = std::move(active);
  reset();
}

/// Norms of new columns, scaled linear term, flags, room; drops starting columns that cannot be.
void NonnegativeQp::prepare(const Columns &y, const Vector &g) {
  const Index old = norms_.size(), columns = y.cols();
  if (old > columns) reset();
  const Index known = norms_.size();
  norms_.conservativeResize(columns);
  for (Index j = known; j < columns; ++j)
    norms_[j] = y.col(j).norm();
  linear_ = Vector::Zero(columns);
  if (g.size() > 0) linear_ = (norms_.array() > 0).select(g.cwiseQuotient(norms_), g);

  status_.assign(columns, may_enter);
  if (stale_) {
    std::erase_if(active_, [&](Index j) {
      if (j < 0 || j >= columns || norms_[j] == 0) return true;
      return std::exchange(status_[j], in_set) == in_set;
    });
    factorise(y);
  }
  status_.assign(columns, may_enter);
  for (const Index j : active_)
    status_[j] = in_set;

  const Index room = std::min(y.rows(), columns);
  for (Vector *work : {&values_, &minimiser_, &image_})
    work->resize(room);
  gains_.resize(columns);
  x_.resize(columns);
  seen_.clear();
  report_ = {};
}

/// QR of the starting set in one block, or column by column without those that depend on others.
void NonnegativeQp::factorise(const Columns &y) {
  stale_ = false;
  Matrix start(y.rows(), static_cast<Index>(active_.size()));
  for (Index k = 0; k < start.cols(); ++k) {
    const Index j = active_[k];
    start.col(k) = y.col(j) / norms_[j];
  }
  if (qr_.assign(start)) return;
  std::vector<Index> independent;
  for (Index k = 0; k < start.cols(); ++k)
    if (qr_.append(start.col(k), options_.dependence)) independent.push_back(active_[k]);
  active_ = std::move(independent);
}

/// The minimum over the active columns, whatever its signs:
/// R^T R z = R^T Q^T c - g  gives  image = R z = Q^T c - R^-T g.
void NonnegativeQp::minimise(const Eigen::Ref<const Vector> &c) {
  const Index count = qr_.size();
  auto image = image_.head(count);
  auto minimiser = minimiser_.head(count);
  minimiser = linear_(active_);
  const auto upper = qr_.r().triangularView<Eigen::Upper>();
  if (!minimiser.isZero(0)) upper.transpose().solveInPlace(minimiser);
  image = -minimiser;
  image.noalias() += qr_.q().transpose() * c;
  minimiser = image;
  upper.solveInPlace(minimiser);
}

void NonnegativeQp::drop(Index position) {
  const Index left = qr_.size() - position - 1;
  values_.segment(position, left) = values_.segment(position + 1, left).eval();
  status_[active_[position]] = may_enter;
  active_.erase(active_.begin() + position);
  qr_.remove(position);
}

/// Active columns without a positive value leave, and with them the one that blocks.
void NonnegativeQp::drop_zeros(Index blocking) {
  values_[blocking] = 0;
  for (Index k = qr_.size() - 1; k >= 0; --k) {
    if (values_[k] > 0) continue;
    drop(k);
    ++report_.iterations;
  }
}

/// The column that has just been appended to the QR becomes active.
void NonnegativeQp::take(Index column, double value) {
  values_[qr_.size() - 1] = value;
  active_.push_back(column);
  status_[column] = in_set;
  ++report_.iterations;
}

/// Makes any set a valid start: columns with a negative minimiser leave until none is left.
void NonnegativeQp::drop_negative(const Eigen::Ref<const Vector> &c) {
  for (;;) {
    minimise(c);
    const Index before = qr_.size();
    for (Index k = before - 1; k >= 0; --k)
      if (!(minimiser_[k] > 0)) drop(k);
    if (qr_.size() == before) break;
  }
  values_.head(qr_.size()) = minimiser_.head(qr_.size());
}

/// Lawson-Hanson inner loop: towards the minimum over the active columns; those that become zero
/// on the way leave, until it is positive.
void NonnegativeQp::settle(const Eigen::Ref<const Vector> &c) {
  for (;;) {
    minimise(c);
    double step = 1;
    Index blocking = -1;
    for (Index k = 0; k < qr_.size(); ++k) {
      if (minimiser_[k] > 0) continue;
      const double ratio = values_[k] > 0 ? values_[k] / (values_[k] - minimiser_[k]) : 0.0;
      if (blocking >= 0 && ratio >= step) continue;
      step = ratio;
      blocking = k;
    }
    if (blocking < 0) break;
    auto values = values_.head(qr_.size());
    values += step * (minimiser_.head(qr_.size()) - values);
    drop_zeros(blocking);
  }
  values_.head(qr_.size()) = minimiser_.head(qr_.size());
}

/// The column with the largest gain per unit length (-1: none), after the residual.
Index NonnegativeQp::best_column(const Columns &y, const Eigen::Ref<const Vector> &c) {
  const auto image = image_.head(qr_.size());
  residual_ = c;
  residual_.noalias() -= qr_.q() * image;
  gains_.noalias() = y.transpose() * residual_;
  const double scale = c.norm() + image.norm();
  Index best = -1;
  double largest = 0;
  banned_gain_ = 0;
  for (Index j = 0; j < y.cols(); ++j) {
    const char state = status_[j];
    if (state == in_set) continue;
    const double size = norms_[j] > 0 ? scale + std::abs(linear_[j]) : std::abs(linear_[j]);
    const double gain = (norms_[j] > 0 ? gains_[j] / norms_[j] : 0.0) - linear_[j];
    if (state == banned) banned_gain_ = std::max(banned_gain_, gain / size);
    if (state == banned || !(gain > options_.tolerance * size) || gain <= largest) continue;
    largest = gain;
    best = j;
  }
  return best;
}

/// Takes `column` into the active set; false if that proves the minimum to be -infinity.
bool NonnegativeQp::enter(const Columns &y, Index column) {
  if (norms_[column] == 0) return false;
  column_ = y.col(column) / norms_[column];
  if (!qr_.append(column_, options_.dependence)) return exchange(column);
  take(column, 0);
  return true;
}

/// A column that depends on the active ones, y_j = Y_P a: along x_j += t, x_P -= t a the objective
/// falls at the rate a.g_P - g_j, for as long as x_P >= 0.
bool NonnegativeQp::exchange(Index column) {
  const Index count = qr_.size();
  Vector a = qr_.q().transpose() * column_;
  qr_.r().triangularView<Eigen::Upper>().solveInPlace(a);
  double slope = linear_[column], scale = std::abs(slope);
  for (Index k = 0; k < count; ++k) {
    const double term = a[k] * linear_[active_[k]];
    slope -= term;
    scale += std::abs(term);
  }
  status_[column] = banned;
  if (!(slope < -options_.dependence * scale)) return true;

  const double least = options_.dependence * std::max(1.0, a.cwiseAbs().maxCoeff());
  double step = std::numeric_limits<double>::infinity();
  Index blocking = -1;
  for (Index k = 0; k < count; ++k) {
    if (a[k] <= least || values_[k] / a[k] >= step) continue;
    step = values_[k] / a[k];
    blocking = k;
  }
  if (blocking < 0) return false;
  values_.head(count) -= step * a;
  drop_zeros(blocking);
  if (!qr_.append(column_, options_.dependence)) return true;
  take(column, step);
  return true;
}

/// In exact arithmetic never true: the objective falls from one visited set to the next.
bool NonnegativeQp::seen_before() {
  std::uint64_t hash = 0;
  for (const Index j : active_)
    hash ^= hash_of(j);
  if (std::find(seen_.begin(), seen_.end(), hash) != seen_.end()) return true;
  seen_.push_back(hash);
  std::replace(status_.begin(), status_.end(), banned, may_enter);
  return false;
}

NonnegativeQpReport NonnegativeQp::solve(const Columns &y, const Eigen::Ref<const Vector> &c,
                                         const Vector &g) {
  if (y.rows() != qr_.rows() || c.size() != y.rows() || (g.size() != 0 && g.size() != y.cols()))
    throw failure("non-negative QP: the sizes of Y, c and g do not fit");
  prepare(y, g);
  drop_negative(c);
  const int limit = options_.max_iterations > 0 ? options_.max_iterations
                                                : 20 * (static_cast<int>(y.cols()) + 10);
  bool changed = true, returned = false;
  for (;;) {
    if (changed) returned = seen_before();
    const Index column = best_column(y, c);
    if (column < 0) {
      report_.converged = banned_gain_ <= options_.dependence && residual_.allFinite();
      break;
    }
    if (report_.iterations >= limit) break;
    const int before = report_.iterations;
    if (returned) {
      status_[column] = banned;
      returned = false;
    } else if (!enter(y, column)) {
      report_.unbounded = true;
      break;
    }
    changed = report_.iterations != before;
    if (changed) settle(c);
  }
  x_.setZero();
  x_(active_) = values_.head(qr_.size()).cwiseQuotient(norms_(active_));
  return report_;
}

} // namespace rbvi
