#include "friction_newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi::friction {

namespace {

constexpr Index many = 100; ///< unknowns, whose factors take longer than their refinement

/// Whether its determinant is negative.
bool is_negative(const Eigen::PartialPivLU<Matrix> &lu) {
  const bool odd = (lu.matrixLU().diagonal().array() < 0).count() % 2 == 1;
  return odd != (lu.permutationP().determinant() < 0);
}

} // namespace

double tangential_diagonal(const Vector &diagonal, const NodeLaws &laws, Index i) {
  const Index t = laws.tangent[i];
  return laws.free_at(i) < 2 ? diagonal[t] : (diagonal[t] + diagonal[t + 1]) / 2;
}

ActiveSets::ActiveSets(const NodeLaws &laws)
    : active(laws.nodes(), 0), tangent(laws.nodes(), Tangent::none),
      direction(Matrix::Zero(laws.tangents, laws.nodes())), piece(laws.nodes(), 0),
      curvature(Vector::Constant(laws.nodes(), -1)) {}

std::vector<Index> ActiveSets::support(const NodeLaws &laws) const {
  std::vector<Index> result;
  result.reserve(laws.rows);
  for (Index i = 0; i < laws.nodes(); ++i)
    if (is_active(i)) result.push_back(laws.normal[i]);
  for (Index i = 0; i < laws.nodes(); ++i)
    for (Index k = 0; k < laws.free_at(i) && tangent_at(i) != Tangent::none; ++k)
      result.push_back(laws.tangent[i] + k);
  return result;
}

Index ActiveSets::differences(const ActiveSets &other) const {
  Index count = 0;
  for (Index i = 0; i < std::ssize(active); ++i)
    count += differs(other, i);
  return count;
}

std::string ActiveSets::key() const {
  std::string result;
  result.reserve(active.size());
  for (std::size_t i = 0; i < active.size(); ++i) {
    const bool slips = tangent[i] == Tangent::slip;
    const int way = slips ? 8 * (direction(0, static_cast<Index>(i)) < 0) + 16 * piece[i] : 0;
    result.push_back(static_cast<char>(active[i] + 2 * static_cast<int>(tangent[i]) + way));
  }
  return result;
}

State evaluate(const LazyColumns &h, const Vector &q, Vector x) {
  std::vector<Index> support;
  support.reserve(x.size());
  for (Index j = 0; j < x.size(); ++j)
    if (x[j] != 0) support.push_back(j);
  auto [product, terms] = h.multiply(support, x(support));
  return {std::move(x), product + q, terms + q.cwiseAbs()};
}

ActiveSets contact_sets(const NodeLaws &laws, const Vector &x) {
  ActiveSets result(laws);
  for (Index i = 0; i < laws.nodes(); ++i)
    result.active[i] = x[laws.normal[i]] > 0;
  return result;
}

ActiveSets predicted_sets(const NodeLaws &laws, const Vector &y) {
  constexpr double round_off = 1e-10; // x itself is on its bound where it slips
  ActiveSets result(laws);
  for (Index i = 0; i < laws.nodes(); ++i) {
    const double normal = y[laws.normal[i]];
    const FrictionBound &law = laws.friction_at(i);
    result.active[i] = normal > 0;
    if (!law.carries_traction(normal > 0)) continue;
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2, 1> tangential =
        y.segment(laws.tangent[i], laws.tangents);
    tangential.tail(laws.tangents - laws.free_at(i)).setZero();
    const double size = tangential.norm();
    const bool slips = size > 0 && size >= (1 - round_off) * law.value(normal);
    result.tangent[i] = slips ? Tangent::slip : Tangent::stick;
    if (!slips) continue;
    result.direction.col(i) = tangential / size;
    result.piece[i] = static_cast<char>(law.piece_at(normal));
  }
  return result;
}

void set_curvature(const Vector &diagonal, const NodeLaws &laws, const Vector &y,
                   ActiveSets &sets) {
  for (Index i = 0; i < laws.nodes(); ++i)
    if (const double bound = laws.friction_at(i).value(y[laws.normal[i]]);
        sets.tangent_at(i) == Tangent::slip && bound > 0) {
      const double size = y.segment(laws.tangent[i], laws.tangents).norm();
      sets.curvature[i] =
          std::max(0.0, size - bound) * tangential_diagonal(diagonal, laws, i) / bound;
    }
}

std::vector<Unknown> unknowns(const NodeLaws &laws, const ActiveSets &sets) {
  std::vector<Unknown> result;
  result.reserve(laws.rows);
  for (Index i = 0; i < laws.nodes(); ++i) {
    const Index n = laws.normal[i], t = laws.tangent[i];
    const bool slips = sets.tangent_at(i) == Tangent::slip;
    if (sets.is_active(i)) {
      result.push_back({.node = i, .first = n, .second = n});
      if (slips) result.back().slope = sets.piece_of(laws, i).slope;
    }
    if (sets.tangent_at(i) == Tangent::none) continue;
    for (Index k = 0; k < laws.free_at(i) && !slips; ++k)
      result.push_back({.node = i, .first = t + k, .second = t + k});
    if (slips && laws.free_at(i) == 2 && sets.curvature[i] >= 0)
      result.push_back({.node = i,
                        .first = t,
                        .second = t + 1,
                        .a = -sets.direction(1, i),
                        .b = sets.direction(0, i),
                        .curvature = sets.curvature[i]});
  }
  return result;
}

Vector fixed_part(const NodeLaws &laws, const ActiveSets &sets) {
  Vector x = Vector::Zero(laws.rows);
  for (Index i = 0; i < laws.nodes(); ++i)
    if (sets.tangent_at(i) == Tangent::slip)
      x.segment(laws.tangent[i], laws.tangents) =
          sets.piece_of(laws, i).offset * sets.direction.col(i);
  return x;
}

Vector expand(const NodeLaws &laws, const ActiveSets &sets, const std::vector<Unknown> &list,
              const Vector &u, Vector x) {
  for (Index k = 0; k < u.size(); ++k) {
    const Unknown &unknown = list[k];
    const double value = u[k];
    x[unknown.first] += unknown.a * value;
    if (unknown.b != 0) x[unknown.second] += unknown.b * value;
    if (unknown.slope > 0)
      x.segment(laws.tangent[unknown.node], laws.tangents) +=
          unknown.slope * value * sets.direction.col(unknown.node);
  }
  return x;
}

Vector on_circles(const NodeLaws &laws, const ActiveSets &sets, Vector x) {
  for (Index i = 0; laws.tangents == 2 && i < laws.nodes(); ++i) {
    if (sets.tangent_at(i) != Tangent::slip) continue;
    auto tangential = x.segment(laws.tangent[i], 2);
    const double bound = laws.bound[i].value(x[laws.normal[i]]);
    if (bound > 0 && tangential.norm() > 0) tangential *= bound / tangential.norm();
  }
  return x;
}

double unit_of(const Unknown &unknown, const Vector &diagonal, const NodeLaws &laws) {
  return 1 / std::sqrt(unknown.first == laws.normal[unknown.node]
                           ? diagonal[unknown.first]
                           : tangential_diagonal(diagonal, laws, unknown.node));
}

MovedBy::MovedBy(const LazyColumns &h, const NodeLaws &laws, const ActiveSets &sets,
                 const Unknown &unknown) {
  add(unknown.a, h, unknown.first);
  if (unknown.b != 0) add(unknown.b, h, unknown.second);
  if (unknown.slope > 0)
    for (int j = 0; j < laws.free_at(unknown.node); ++j)
      add(unknown.slope * sets.direction(j, unknown.node), h, laws.tangent[unknown.node] + j);
}

void MovedBy::add(double factor, const LazyColumns &h, Index column) {
  columns_[count_] = h.entries(column);
  factors_[count_++] = factor * h.factor();
}

System::System(const LazyColumns &h, const NodeLaws &laws, ActiveSets sets)
    : sets_(std::move(sets)) {
  for (const Index j : sets_.support(laws))
    if (!(h.diagonal()[j] > 0)) {
      solved_ = Solved::indefinite;
      return;
    }
  list_ = unknowns(laws, sets_);
  symmetric_ = std::ranges::all_of(list_, [](const Unknown &u) { return u.slope == 0; });
  if (list_.empty()) return;
  unit_ = Vector::NullaryExpr(std::ssize(list_),
                              [&](Index k) { return unit_of(list_[k], h.diagonal(), laws); });
  assemble(h, laws);
  if (!symmetric_ && laws.tangents == 2 && std::ssize(list_) >= many) {
    rough_.emplace(matrix_.cast<float>());
    return;
  }
  if (!symmetric_) {
    lu_.compute(matrix_);
    negative_ = is_negative(lu_);
    return;
  }
  lower_ = matrix_;
  if (!cholesky_in_place(lower_)) solved_ = Solved::indefinite;
}

void System::assemble(const LazyColumns &h, const NodeLaws &laws) {
  const Index count = std::ssize(list_);
  matrix_.resize(count, count);
  for (Index k = 0; k < count; ++k) {
    const MovedBy moved(h, laws, sets_, list_[k]);
    for (Index r = 0; r < count; ++r)
      matrix_(r, k) = unit_[k] * unit_[r] * along(list_[r], moved);
    matrix_(k, k) += list_[k].curvature * unit_[k] * unit_[k];
  }
}

Vector System::right_side(const Vector &y) const {
  return Vector::NullaryExpr(unit_.size(), [&](Index k) { return -unit_[k] * along(list_[k], y); });
}

Vector System::refined(const Vector &right, double accuracy) const {
  constexpr double shrinks = 0.1;
  Vector u = Vector::Zero(right.size()), left = right;
  for (double before = std::numeric_limits<double>::infinity(), scale = 0;
       (scale = left.norm()) > 0;) {
    const Vector change = scale * times_inverse(Vector(left / scale));
    u += change;
    const double size = change.norm() / u.norm();
    if (size <= accuracy) return u;
    if (!(size <= shrinks * before)) return Eigen::PartialPivLU<Matrix>(matrix_).solve(right);
    before = size;
    left = right - matrix_ * u;
  }
  return u;
}

Vector System::solve(const Vector &right, int refinements) const {
  if (right.size() == 0) return right;
  if (rough_) return refined(right, refinements > 0 ? 1e-13 : 1e-3).cwiseProduct(unit_);
  Vector u = times_inverse(right);
  for (int k = 0; k < refinements; ++k)
    u -= times_inverse(Vector(matrix_ * u - right));
  return u.cwiseProduct(unit_);
}

Solved System::step(const LazyColumns &h, const Vector &q, const NodeLaws &laws, int refinements,
                    State &point) const {
  if (solved_ != Solved::yes) return solved_;
  Vector x = fixed_part(laws, sets_);
  Vector start = q;
  for (Index j = 0; j < x.size(); ++j)
    if (x[j] != 0) start += x[j] * h.column(j);
  const Vector u = solve(right_side(start), refinements);
  if (!u.allFinite()) return symmetric_ ? Solved::indefinite : Solved::singular;
  point = evaluate(h, q, on_circles(laws, sets_, expand(laws, sets_, list_, u, std::move(x))));
  point.negative = negative_;
  return Solved::yes;
}

State System::near(const LazyColumns &h, const Vector &x, const NodeLaws &laws, const Vector &left,
                   const NodeLaws &other_laws) const {
  Vector moved = Vector::Zero(x.size());
  for (Index i = 0; i < laws.nodes(); ++i)
    if (sets_.tangent_at(i) == Tangent::slip) {
      const FrictionBound::Piece now = sets_.piece_of(other_laws, i);
      const double change = now.slope - sets_.piece_of(laws, i).slope;
      moved.segment(laws.tangent[i], laws.tangents) =
          (now.offset + change * x[laws.normal[i]]) * sets_.direction.col(i);
    }
  const Vector q = left - (evaluate(h, Vector::Zero(x.size()), x).w);
  const Vector right = right_side(evaluate(h, q, moved).w);
  moved = expand(other_laws, sets_, list_, solve(right, 1), std::move(moved));
  return evaluate(h, q, on_circles(other_laws, sets_, std::move(moved)));
}

Matrix System::change(const NodeLaws &laws, const Matrix &of_q) const {
  Matrix result(of_q.rows(), of_q.cols());
  for (Index k = 0; k < of_q.cols(); ++k)
    result.col(k) =
        expand(laws, sets_, list_, solve(right_side(of_q.col(k)), 1), Vector::Zero(of_q.rows()));
  return result;
}

} // namespace rbvi::friction
