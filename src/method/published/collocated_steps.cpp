#include "collocated_steps.hpp"

namespace rbvi::collocated {

namespace {

std::vector<Index> rows_above(const Vector &norms, double least) {
  std::vector<Index> result;
  for (Index j = 0; j < norms.size(); ++j)
    if (norms[j] > least) result.push_back(j);
  return result;
}

/// Newton's step on given sets: the bounds follow the pressure,
///
///   w_free = 0,   w_tau + T^T delta = 0,   side_j (T b)_j - slope (N a)_j = offset of its piece at
///   the nodes at a bound.
State newton_step(const ScaledProblem &p, const ActiveSets &sets) {
  std::vector<Index> unknowns, held;
  for (Index i = 0; i < p.generators(); ++i)
    if (sets.free[i] != 0) unknowns.push_back(i);
  const Index pressures = static_cast<Index>(unknowns.size());
  for (Index k = 0; k < p.modes(); ++k)
    unknowns.push_back(p.generators() + k);
  for (Index j = 0; j < p.nodes(); ++j)
    if (sets.side[j] != 0) held.push_back(j);

  const Index n = static_cast<Index>(unknowns.size()), m = static_cast<Index>(held.size());
  Matrix system = Matrix::Zero(n + m, n + m);
  Vector right(n + m);
  system.topLeftCorner(n, n) = p.h(unknowns, unknowns);
  right.head(n) = -p.q(unknowns);
  for (Index k = 0; k < m; ++k) {
    const Index j = held[k];
    const double side = sets.side[j], size = p.size[j];
    const auto [offset, slope] = p.bound[j].piece(sets.piece[j]);
    double reach = 0; // largest entry of the free generators: in contact by these sets
    for (Index i = 0; i < pressures; ++i) {
      const double value = p.normal(j, unknowns[i]);
      system(n + k, i) = -slope * value / size;
      reach = std::max(reach, value);
    }
    system.row(n + k).segment(pressures, p.modes()) = side / size * p.tangential.row(j);
    system.col(n + k).segment(pressures, p.modes()) = side / size * p.tangential.row(j).transpose();
    right[n + k] = reach > 0 || !p.bound[j].jumps() ? offset / size : 0;
  }
  Vector solution(n + m);
  if (n + m > 0) {
    const Eigen::PartialPivLU<Matrix> lu(system);
    solution = lu.solve(right);
    solution += lu.solve(right - system * solution);
  }
  State point;
  point.x = Vector::Zero(p.q.size());
  point.delta = Vector::Zero(p.nodes());
  point.x(unknowns) = solution.head(n);
  for (Index k = 0; k < m; ++k)
    point.delta[held[k]] = sets.side[held[k]] * solution[n + k] / p.size[held[k]];
  return point;
}

} // namespace

/// With the bounds s frozen the problem is convex; its dual is non-negative in the multipliers w_n
/// and delta of both signs: with H = L L^T, Y = L^-1 [-E_n, T^T, -T^T], c = -L^-1 q, g = (0, s, s).
class FrozenBounds {
public:
  explicit FrozenBounds(const ScaledProblem &p) : p_(p), qp_(p.q.size()), lower_(p.h) {
    if (!cholesky_in_place(lower_)) throw not_positive_definite();
    const Index r = p.generators(), s = p.modes(), m = p.nodes();
    y_.setZero(r + s, r + 2 * m);
    y_.topLeftCorner(r, r) = -Matrix::Identity(r, r);
    y_.block(r, r, s, m) = p.tangential.transpose() * p.size.cwiseInverse().asDiagonal();
    y_.block(r, r + m, s, m) = -y_.block(r, r, s, m);
    solve_lower(lower_, y_);
    c_ = -p.q;
    solve_lower(lower_, c_);
  }
  void start_from(const ActiveSets &sets) {
    std::vector<Index> active;
    for (Index i = 0; i < p_.generators(); ++i)
      if (sets.free[i] == 0) active.push_back(i);
    for (Index j = 0; j < p_.nodes(); ++j)
      if (const int side = sets.side[j]; side != 0)
        active.push_back(p_.generators() + j + (side > 0 ? 0 : p_.nodes()));
    qp_.start_from(std::move(active));
  }
  State solve(const Vector &s) {
    const Index r = p_.generators(), m = p_.nodes();
    const Vector g = s.cwiseQuotient(p_.size);
    Vector linear(r + 2 * m);
    linear << Vector::Zero(r), g, g;
    qp_.solve(y_, c_, linear);
    State point;
    point.x = qp_.residual();
    solve_lower_transposed(lower_, point.x);
    point.x.head(r) = point.x.head(r).cwiseMax(0);
    for (const Index column : qp_.active())
      if (column < r) point.x[column] = 0;
    point.delta = (qp_.x().segment(r, m) - qp_.x().tail(m)).cwiseQuotient(p_.size);
    return point;
  }
  ActiveSets sets() const {
    ActiveSets result(p_);
    for (const Index column : qp_.active()) {
      const Index j = column - p_.generators();
      if (j < 0) result.free[column] = 0;
      if (j >= 0) result.side[j % p_.nodes()] = j < p_.nodes() ? 1 : -1;
    }
    return result;
  }

private:
  const ScaledProblem &p_;
  NonnegativeQp qp_;
  Matrix lower_;
  Matrix y_;
  Vector c_;
};

Error not_positive_definite() {
  return failure("collocated friction: H is not positive definite: leave out what depends on the "
                 "other functions and modes");
}

ScaledProblem scaled(const CollocatedProblem &p) {
  const Index r = p.normal_rows.cols();
  const Vector unit = p.h.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix rows = p.tangential_rows * unit.tail(unit.size() - r).asDiagonal();
  const Vector norms = rows.rowwise().norm();
  const auto kept = rows_above(norms, norms.size() > 0 ? round_off * norms.maxCoeff() : 0);
  return {.unit = unit,
          .q = unit.cwiseProduct(p.q),
          .size = norms(kept),
          .h = unit.asDiagonal() * p.h * unit.asDiagonal(),
          .normal = p.normal_rows(kept, Eigen::all) * unit.head(r).asDiagonal(),
          .tangential = rows(kept, Eigen::all),
          .bound = bounds_at(bounds_per_node(p.bounds, rows.rows()), kept)};
}

ZeroBoundElimination::ZeroBoundElimination(const ScaledProblem &p, const std::vector<char> &closed)
    : closed_(closed), p_(p), reduced_(p) {
  for (Index j = 0; j < p.nodes(); ++j)
    (closed[j] != 0 ? zero_ : nodes_).push_back(j);
  if (!zero_.empty()) eliminate();
}

ZeroBoundElimination::~ZeroBoundElimination() = default;

void ZeroBoundElimination::eliminate() {
  const Index r = p_.generators(), s = p_.modes();
  const double least = round_off * p_.size.maxCoeff();
  qr_.compute(p_.tangential(zero_, Eigen::all).transpose());
  qr_.setThreshold(least / qr_.maxPivot());
  z_ = Matrix(qr_.householderQ()).rightCols(s - qr_.rank());
  reduced_.h.resize(r + z_.cols(), r + z_.cols());
  reduced_.h << p_.h.topLeftCorner(r, r), p_.h.topRightCorner(r, s) * z_,
      z_.transpose() * p_.h.bottomLeftCorner(s, r),
      z_.transpose() * p_.h.bottomRightCorner(s, s) * z_;
  reduced_.q.resize(r + z_.cols());
  reduced_.q << p_.q.head(r), z_.transpose() * p_.q.tail(s);

  const Matrix rows = p_.tangential(nodes_, Eigen::all) * z_;
  const Vector norms = rows.rowwise().norm();
  const std::vector<Index> kept = rows_above(norms, least);
  reduced_.tangential = rows(kept, Eigen::all);
  reduced_.size = norms(kept);
  std::vector<Index> nodes;
  for (const Index j : kept)
    nodes.push_back(nodes_[j]);
  nodes_ = std::move(nodes);
  reduced_.normal = p_.normal(nodes_, Eigen::all);
  reduced_.bound = bounds_at(p_.bound, nodes_);
}

State ZeroBoundElimination::newton(const ActiveSets &sets) const {
  return lifted(newton_step(reduced_, restricted(sets)));
}

State ZeroBoundElimination::frozen(const Vector &s, ActiveSets &sets) {
  if (!qp_) {
    qp_ = std::make_unique<FrozenBounds>(reduced_);
    qp_->start_from(restricted(sets));
  }
  State point = lifted(qp_->solve(s(nodes_)));
  const ActiveSets found = qp_->sets();
  sets = ActiveSets(p_);
  sets.free = found.free;
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    sets.side[nodes_[k]] = found.side[k];
  for (const Index j : zero_)
    sets.side[j] = sign(point.delta[j]);
  return point;
}

ActiveSets ZeroBoundElimination::restricted(const ActiveSets &sets) const {
  ActiveSets result(reduced_);
  result.free = sets.free;
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    result.side[k] = sets.side[nodes_[k]];
    result.piece[k] = sets.piece[nodes_[k]];
  }
  return result;
}

/// The multipliers of T_E b = 0 are those of what the others leave.
State ZeroBoundElimination::lifted(const State &point) const {
  if (zero_.empty()) return point;
  State full;
  const Index r = p_.generators(), s = p_.modes();
  full.x.resize(r + s);
  full.x << point.x.head(r), z_ * point.x.tail(z_.cols());
  full.delta = Vector::Zero(p_.nodes());
  full.delta(nodes_) = point.delta;
  const Vector left =
      p_.h.bottomRows(s) * full.x + p_.q.tail(s) + p_.tangential.transpose() * full.delta;
  if (left.allFinite()) full.delta(zero_) = -qr_.solve(left);
  return full;
}

} // namespace rbvi::collocated
