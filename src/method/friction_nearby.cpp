// The step of active sets that differ at few nodes from those whose system is factorised.
#include "friction_newton.hpp"

namespace rbvi::friction {

namespace {

constexpr Index part = 6; ///< of the unknowns, that may be other ones

/// Pairs of places in two lists of unknowns, and the places in one of them alone.
struct Difference {
  std::vector<std::pair<Index, Index>> kept;
  std::vector<Index> removed, added;
};

Difference difference(const std::vector<Unknown> &before, const std::vector<Unknown> &after) {
  const auto is_same = [](const Unknown &u, const Unknown &v) {
    return u.node == v.node && u.first == v.first && u.second == v.second && u.slope == v.slope;
  };
  const auto comes_before = [](const Unknown &u, const Unknown &v) {
    return std::pair(u.node, u.first) <= std::pair(v.node, v.first);
  };
  Difference result;
  const Index n = std::ssize(before), m = std::ssize(after);
  for (Index k = 0, j = 0; k < n || j < m;)
    if (k < n && j < m && is_same(before[k], after[j]))
      result.kept.emplace_back(k++, j++);
    else if (j == m || (k < n && comes_before(before[k], after[j])))
      result.removed.push_back(k++);
    else
      result.added.push_back(j++);
  return result;
}

/// The slips of nodes that did and do slip become those of the point, which is on their circles.
void turn(const NodeLaws &laws, const ActiveSets &from, const Vector &x, ActiveSets &sets) {
  for (Index i = 0; i < laws.nodes(); ++i) {
    if (from.tangent_at(i) != Tangent::slip || sets.tangent_at(i) != Tangent::slip) continue;
    const auto traction = x.segment(laws.tangent[i], laws.tangents);
    if (const double size = traction.norm(); size > 0) sets.direction.col(i) = traction / size;
  }
}

/// x_i of a node that these sets allow.
void admit(const NodeLaws &laws, const ActiveSets &sets, Index i, Vector &x) {
  if (!sets.is_active(i)) x[laws.normal[i]] = 0;
  if (!laws.has_tangent(i)) return;
  auto traction = x.segment(laws.tangent[i], laws.tangents);
  if (sets.tangent_at(i) == Tangent::none) traction.setZero();
  if (sets.tangent_at(i) != Tangent::slip) return;
  const FrictionBound::Piece piece = sets.piece_of(laws, i);
  traction = (piece.offset + piece.slope * x[laws.normal[i]]) * sets.direction.col(i);
}

/// The point moves to where its nodes that change are admitted; its terms stay.
void admit_changes(const LazyColumns &h, const NodeLaws &laws, const ActiveSets &from,
                   const ActiveSets &to, State &point) {
  const Vector before = point.x;
  for (Index i = 0; i < laws.nodes(); ++i)
    if (from.differs(to, i)) admit(laws, to, i, point.x);
  for (Index j = 0; j < before.size(); ++j)
    if (const double change = point.x[j] - before[j]; change != 0) point.w += change * h.column(j);
}

/// The row of an unknown times the columns of others, by the symmetry of H.
double entry(const Unknown &of, const MovedBy &row, const NodeLaws &laws, const ActiveSets &sets) {
  double result = along(of, row);
  for (int j = 0; j < laws.free_at(of.node) && of.slope > 0; ++j)
    result += of.slope * sets.direction(j, of.node) * row[laws.tangent[of.node] + j];
  return result;
}

} // namespace

Solved System::step_nearby(const LazyColumns &h, const Vector &q, const NodeLaws &laws,
                           const ActiveSets &from, ActiveSets to, State &point) const {
  if (solved_ != Solved::yes) return Solved::far;
  turn(laws, from, point.x, to);
  const std::vector<Unknown> list = unknowns(laws, to);
  const auto [kept, removed, added] = difference(list_, list);
  const Index n = std::ssize(list_), a = std::ssize(added), r = std::ssize(removed), k = a + r;
  if (part * k > n) return Solved::far;
  admit_changes(h, laws, from, to, point);

  // Bordered by the columns of what is added and, for what is removed, by unit columns with rows
  // that keep it zero; the last column is the right side.
  Matrix sides = Matrix::Zero(n, k + 1), schur = Matrix::Zero(k, k);
  Vector right = Vector::Zero(k), unit(a), u(std::ssize(list));
  for (Index j = 0; j < a; ++j)
    unit[j] = unit_of(list[added[j]], h.diagonal(), laws);
  // Curvatures change by factors where bounds are small; then they are most of their rows, which
  // are scaled.
  Vector scale = unit_;
  for (const auto &[of, now] : kept) {
    const double square = unit_[of] * unit_[of];
    scale[of] *= (1 + square * list_[of].curvature) / (1 + square * list[now].curvature);
    sides(of, k) = -scale[of] * along(list[now], point.w);
  }
  for (Index j = 0; j < a; ++j) {
    const MovedBy moved(h, laws, to, list[added[j]]);
    for (const auto &[of, now] : kept)
      sides(of, j) = scale[of] * unit[j] * along(list[now], moved);
    for (Index i = 0; i < a; ++i)
      schur(i, j) = unit[i] * unit[j] * along(list[added[i]], moved);
    schur(j, j) += list[added[j]].curvature * unit[j] * unit[j];
  }
  for (Index j = 0; j < r; ++j)
    sides(removed[j], a + j) = 1;
  const Matrix found = times_inverse(sides);
  for (Index i = 0; i < a; ++i) {
    Unknown of_row = list[added[i]];
    of_row.slope = 0;
    const MovedBy row(h, laws, to, of_row);
    Vector entries = Vector::Zero(n);
    for (const auto &[of, now] : kept)
      entries[of] = unit_[of] * unit[i] * entry(list[now], row, laws, to);
    schur.row(i) -= entries.transpose() * found.leftCols(k);
    right[i] = -unit[i] * along(list[added[i]], point.w) - entries.dot(found.col(k));
  }
  for (Index i = 0; i < r; ++i) {
    schur.row(a + i) = -found.row(removed[i]).head(k);
    right[a + i] = -found(removed[i], k);
  }
  const Vector border = lu_solve(schur, right);
  const Vector change = found.col(k) - found.leftCols(k) * border;
  for (const auto &[of, now] : kept)
    u[now] = unit_[of] * change[of];
  for (Index j = 0; j < a; ++j)
    u[added[j]] = unit[j] * border[j];
  if (!u.allFinite()) return Solved::far;
  point = evaluate(h, q, on_circles(laws, to, expand(laws, to, list, u, std::move(point.x))));
  return Solved::yes;
}

} // namespace rbvi::friction
