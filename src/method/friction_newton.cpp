#include "friction_newton.hpp"

#include "rbvi/core/largest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rbvi::friction {

namespace {

double tangential_diagonal(const Vector &diagonal, const Laws &laws, Index i) {
  const Index t = laws.tangent(i);
  return laws.dim == 2 ? diagonal[t] : (diagonal[t] + diagonal[t + 1]) / 2;
}

/// Whether its determinant is negative.
bool is_negative(const Eigen::PartialPivLU<Matrix> &lu) {
  const bool odd = (lu.matrixLU().diagonal().array() < 0).count() % 2 == 1;
  return odd != (lu.permutationP().determinant() < 0);
}

/// The verdict on a point, node by node.
class Judge {
public:
  Judge(const Vector &diagonal, const Laws &laws, const State &point, const ActiveSets &sets,
        double tolerance, double largest)
      : diagonal_(diagonal), laws_(laws), point_(point), sets_(sets), tolerance_(tolerance),
        largest_(largest), verdict_{.next = ActiveSets(laws.nodes, laws.dim)} {}
  Verdict all() {
    for (Index i = 0; i < laws_.nodes; ++i) {
      normal(i);
      if (laws_.dim > 1) tangent_of(i);
      verdict_.changed = verdict_.changed || verdict_.next.is_active(i) != sets_.is_active(i) ||
                         verdict_.next.tangent_at(i) != sets_.tangent_at(i) || turned(i);
    }
    return std::move(verdict_);
  }

private:
  double root(Index j) const { return std::sqrt(diagonal_[j]); }
  void violated(double size, double scale) {
    if (!(size <= 0)) verdict_.residual = larger(verdict_.residual, size / scale);
  }
  bool turned(Index i) const {
    return sets_.tangent_at(i) == Tangent::slip &&
           ((laws_.dim == 2 && verdict_.next.direction(0, i) != sets_.direction(0, i)) ||
            verdict_.next.piece[i] != sets_.piece[i]);
  }
  void normal(Index i) {
    const double x = point_.x[i], w = point_.w[i], terms = point_.terms[i];
    violated(x > 0 ? std::abs(w) : -w, terms);
    char &next = verdict_.next.active[i];
    const double counted = std::abs(w) <= tolerance_ * terms ? 0 : w;
    if (diagonal_[i] == 0) {
      next = counted < 0;
      return;
    }
    if (x < 0) violated(-x * root(i), largest_);
    const double y = x * root(i) - counted / root(i);
    next = sets_.is_active(i) && !laws_.at_node(i).jumps() ? y >= -tolerance_ * largest_ : y > 0;
  }
  void tangent_of(Index i) {
    Tangent &next = verdict_.next.tangent[i];
    const double bound = laws_.bound(i, point_.x[i]);
    const bool known = diagonal_[laws_.tangent(i)] != 0;
    if (known) measure(i, bound);
    if (!laws_.at_node(i).carries_traction(verdict_.next.is_active(i))) return;
    verdict_.next.direction.col(i) = sets_.direction.col(i);
    verdict_.next.piece[i] = sets_.piece[i];
    if (bound > 0 && known)
      predict(i, bound);
    else if (sets_.tangent_at(i) == Tangent::none)
      begin(i);
    else
      next = sets_.tangent_at(i);
  }
  /// Tangential components of a node; in the plane the second one is zero.
  using Pair = std::array<double, 2>;
  Pair tangential(const Vector &of, Index i) const {
    const Index t = laws_.tangent(i);
    return {of[t], laws_.dim == 3 ? of[t + 1] : 0};
  }
  static double size_of(const Pair &p) {
    return p[1] == 0 ? std::abs(p[0]) : std::hypot(p[0], p[1]);
  }
  static double dot(const Pair &p, const Pair &q) { return p[0] * q[0] + p[1] * q[1]; }
  void slip(Index i, const Pair &along, double size) {
    verdict_.next.tangent[i] = Tangent::slip;
    verdict_.next.piece[i] = piece_of(i);
    for (int k = 0; k < laws_.dim - 1; ++k)
      verdict_.next.direction(k, i) = along[k] / size;
  }
  /// The piece of the law at x_n; at a kink, where two are, that of the sets.
  char piece_of(Index i) const {
    const FrictionBound &law = laws_.at_node(i);
    const double x = point_.x[i], s = law.value(x);
    const auto [offset, slope] = sets_.piece_of(laws_, i);
    const bool stays = std::abs(offset + slope * x - s) <= tolerance_ * s;
    return stays ? sets_.piece[i] : static_cast<char>(law.piece_at(x));
  }
  /// The bound of a node that just came into contact was zero: it slips against its w_tau.
  void begin(Index i) {
    const Pair w = tangential(point_.w, i);
    const double size = size_of(w);
    verdict_.next.tangent[i] = Tangent::stick;
    if (size > 0) slip(i, w, -size);
  }
  void measure(Index i, double bound) {
    const Pair x = tangential(point_.x, i), w = tangential(point_.w, i);
    const double size = size_of(x), terms = size_of(tangential(point_.terms, i));
    if (size == 0 && bound == 0) return;
    violated((size - bound) * std::sqrt(tangential_diagonal(diagonal_, laws_, i)), largest_);
    if (size < bound * (1 - 1e-14)) {
      violated(size_of(w), terms);
      return;
    }
    const double along = dot(x, w) / size;
    violated(along, terms);
    if (laws_.dim == 3) violated(std::abs(x[0] * w[1] - x[1] * w[0]) / size, terms);
  }
  void predict(Index i, double bound) {
    const double diagonal = tangential_diagonal(diagonal_, laws_, i);
    const Pair w = tangential(point_.w, i);
    Pair y = tangential(point_.x, i);
    if (size_of(w) > tolerance_ * size_of(tangential(point_.terms, i)))
      y = {y[0] - w[0] / diagonal, y[1] - w[1] / diagonal};
    const double size = size_of(y);
    // A node that slips does not turn back before it has been stuck: otherwise it may do so
    // forever.
    const bool slips = sets_.tangent_at(i) == Tangent::slip
                           ? size >= bound * (1 - 1e-15) && dot(y, direction(i)) > 0
                           : size > bound + tolerance_ * largest_ / std::sqrt(diagonal);
    verdict_.next.tangent[i] = Tangent::stick;
    if (!slips) return;
    slip(i, y, size);
    verdict_.next.curvature[i] = std::max(0.0, size - bound) * diagonal / bound;
  }
  Pair direction(Index i) const {
    return {sets_.direction(0, i), laws_.dim == 3 ? sets_.direction(1, i) : 0};
  }

  const Vector &diagonal_;
  const Laws &laws_;
  const State &point_;
  const ActiveSets &sets_;
  double tolerance_, largest_;
  Verdict verdict_;
};

} // namespace

ActiveSets::ActiveSets(Index nodes, int dim)
    : active(nodes, 0), tangent(nodes, Tangent::none), direction(Matrix::Zero(dim - 1, nodes)),
      piece(nodes, 0), curvature(Vector::Constant(nodes, -1)) {}

std::vector<Index> ActiveSets::support(const Laws &laws) const {
  std::vector<Index> result;
  result.reserve(laws.nodes * laws.dim);
  for (Index i = 0; i < laws.nodes; ++i)
    if (is_active(i)) result.push_back(i);
  for (Index i = 0; i < laws.nodes; ++i)
    for (Index k = 0; k < laws.dim - 1 && tangent_at(i) != Tangent::none; ++k)
      result.push_back(laws.tangent(i) + k);
  return result;
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

ActiveSets contact_sets(const Laws &laws, const Vector &x) {
  ActiveSets result(laws.nodes, laws.dim);
  for (Index i = 0; i < laws.nodes; ++i)
    result.active[i] = x[i] > 0;
  return result;
}

ActiveSets predicted_sets(const Laws &laws, const Vector &y) {
  constexpr double round_off = 1e-10; // x itself is on its bound where it slips
  ActiveSets result(laws.nodes, laws.dim);
  for (Index i = 0; i < laws.nodes; ++i) {
    result.active[i] = y[i] > 0;
    if (!laws.at_node(i).carries_traction(y[i] > 0)) continue;
    const auto tangential = y.segment(laws.tangent(i), laws.dim - 1);
    const double size = tangential.norm();
    const bool slips = size > 0 && size >= (1 - round_off) * laws.bound(i, y[i]);
    result.tangent[i] = slips ? Tangent::slip : Tangent::stick;
    if (!slips) continue;
    result.direction.col(i) = tangential / size;
    result.piece[i] = static_cast<char>(laws.at_node(i).piece_at(y[i]));
  }
  return result;
}

void set_curvature(const Vector &diagonal, const Laws &laws, const Vector &y, ActiveSets &sets) {
  for (Index i = 0; i < laws.nodes; ++i)
    if (const double bound = laws.bound(i, y[i]);
        sets.tangent_at(i) == Tangent::slip && bound > 0) {
      const double size = y.segment(laws.tangent(i), laws.dim - 1).norm();
      sets.curvature[i] =
          std::max(0.0, size - bound) * tangential_diagonal(diagonal, laws, i) / bound;
    }
}

std::vector<Unknown> unknowns(const Laws &laws, const ActiveSets &sets) {
  std::vector<Unknown> result;
  result.reserve(laws.nodes * laws.dim);
  for (Index i = 0; i < laws.nodes; ++i) {
    const Index t = laws.tangent(i);
    const bool slips = sets.tangent_at(i) == Tangent::slip;
    if (sets.is_active(i)) {
      result.push_back({.node = i, .first = i, .second = i});
      if (slips) result.back().slope = sets.piece_of(laws, i).slope;
    }
    if (sets.tangent_at(i) == Tangent::none) continue;
    for (Index k = 0; k < laws.dim - 1 && !slips; ++k)
      result.push_back({.node = i, .first = t + k, .second = t + k});
    if (slips && laws.dim == 3 && sets.curvature[i] >= 0)
      result.push_back({.node = i,
                        .first = t,
                        .second = t + 1,
                        .a = -sets.direction(1, i),
                        .b = sets.direction(0, i),
                        .curvature = sets.curvature[i]});
  }
  return result;
}

Vector fixed_part(const Laws &laws, const ActiveSets &sets) {
  Vector x = Vector::Zero(laws.nodes * laws.dim);
  for (Index i = 0; i < laws.nodes; ++i)
    if (sets.tangent_at(i) == Tangent::slip)
      x.segment(laws.tangent(i), laws.dim - 1) =
          sets.piece_of(laws, i).offset * sets.direction.col(i);
  return x;
}

Vector expand(const Laws &laws, const ActiveSets &sets, const std::vector<Unknown> &list,
              const Vector &u, Vector x) {
  for (Index k = 0; k < u.size(); ++k) {
    const Unknown &unknown = list[k];
    const double value = u[k];
    x[unknown.first] += unknown.a * value;
    if (unknown.b != 0) x[unknown.second] += unknown.b * value;
    if (unknown.slope > 0)
      x.segment(laws.tangent(unknown.node), laws.dim - 1) +=
          unknown.slope * value * sets.direction.col(unknown.node);
  }
  for (Index i = 0; laws.dim == 3 && i < laws.nodes; ++i) {
    auto tangential = x.segment(laws.tangent(i), 2);
    const double bound = laws.bound(i, x[i]);
    if (sets.tangent_at(i) == Tangent::slip && bound > 0 && tangential.norm() > 0)
      tangential *= bound / tangential.norm();
  }
  return x;
}

double largest_scaled(const Vector &diagonal, const Vector &x) {
  double largest = 0;
  for (Index j = 0; j < x.size(); ++j)
    if (x[j] != 0) largest = std::max(largest, std::abs(x[j]) * std::sqrt(diagonal[j]));
  return largest;
}

Verdict judge(const Vector &diagonal, const Laws &laws, const State &point, const ActiveSets &sets,
              double tolerance, double largest) {
  return Judge(diagonal, laws, point, sets, tolerance, largest).all();
}

Verdict judge(const Vector &diagonal, const Laws &laws, const State &point, const ActiveSets &sets,
              double tolerance) {
  return judge(diagonal, laws, point, sets, tolerance, largest_scaled(diagonal, point.x));
}

System::System(const LazyColumns &h, const Laws &laws, ActiveSets sets) : sets_(std::move(sets)) {
  for (const Index j : sets_.support(laws))
    if (!(h.diagonal()[j] > 0)) {
      solved_ = Solved::indefinite;
      return;
    }
  list_ = unknowns(laws, sets_);
  symmetric_ = std::ranges::all_of(list_, [](const Unknown &u) { return u.slope == 0; });
  if (list_.empty()) return;
  const Vector &diagonal = h.diagonal();
  unit_ = Vector::NullaryExpr(std::ssize(list_), [&](Index k) {
    const Unknown &u = list_[k];
    return 1 / std::sqrt(u.first < laws.nodes ? diagonal[u.first]
                                              : tangential_diagonal(diagonal, laws, u.node));
  });
  assemble(h, laws);
  if (!symmetric_) {
    lu_.compute(matrix_);
    negative_ = is_negative(lu_);
    return;
  }
  lower_ = matrix_;
  if (!cholesky_in_place(lower_)) solved_ = Solved::indefinite;
}

void System::assemble(const LazyColumns &h, const Laws &laws) {
  const Index count = std::ssize(list_);
  matrix_.resize(count, count);
  std::vector<Index> rows, turns; // turns: rows of two entries
  rows.reserve(count);
  for (Index k = 0; k < count; ++k) {
    rows.push_back(list_[k].first);
    if (list_[k].b != 0) turns.push_back(k);
  }
  Vector column;
  for (Index k = 0; k < count; ++k) {
    const Unknown &u = list_[k];
    column = u.a * h.column(u.first);
    if (u.b != 0) column += u.b * h.column(u.second);
    if (u.slope > 0)
      for (int j = 0; j < laws.dim - 1; ++j)
        column += u.slope * sets_.direction(j, u.node) * h.column(laws.tangent(u.node) + j);
    auto of_rows = matrix_.col(k);
    for (Index r = 0; r < count; ++r) // twice as fast as an expression with indices
      of_rows[r] = column[rows[r]];
    for (const Index r : turns)
      of_rows[r] = list_[r].a * column[list_[r].first] + list_[r].b * column[list_[r].second];
    of_rows[k] += u.curvature;
    of_rows.array() *= unit_[k] * unit_.array();
  }
}

Vector System::right_side(const Vector &y) const {
  return Vector::NullaryExpr(unit_.size(), [&](Index k) {
    const Unknown &u = list_[k];
    return -unit_[k] * (u.a * y[u.first] + u.b * y[u.second]);
  });
}

Vector System::solve(const Vector &right, int refinements) const {
  if (right.size() == 0) return right;
  const auto once = [&](const Vector &r) -> Vector {
    return symmetric_ ? cholesky_solve(lower_, r) : Vector(lu_.solve(r));
  };
  Vector u = once(right);
  for (int k = 0; k < refinements; ++k)
    u -= once(matrix_ * u - right);
  return u.cwiseProduct(unit_);
}

Solved System::step(const LazyColumns &h, const Vector &q, const Laws &laws, int refinements,
                    State &point) const {
  if (solved_ != Solved::yes) return solved_;
  Vector x = fixed_part(laws, sets_);
  Vector start = q;
  for (Index j = laws.nodes; j < x.size(); ++j)
    if (x[j] != 0) start += x[j] * h.column(j);
  const Vector u = solve(right_side(start), refinements);
  if (!u.allFinite()) return symmetric_ ? Solved::indefinite : Solved::singular;
  point = evaluate(h, q, expand(laws, sets_, list_, u, std::move(x)));
  point.negative = negative_;
  return Solved::yes;
}

State System::near(const LazyColumns &h, const Vector &x, const Laws &laws, const Vector &left,
                   const Laws &other_laws) const {
  Vector moved = Vector::Zero(x.size());
  for (Index i = 0; i < laws.nodes; ++i)
    if (sets_.tangent_at(i) == Tangent::slip) {
      const FrictionBound::Piece now = sets_.piece_of(other_laws, i);
      const double change = now.slope - sets_.piece_of(laws, i).slope;
      moved.segment(laws.tangent(i), laws.dim - 1) =
          (now.offset + change * x[i]) * sets_.direction.col(i);
    }
  const Vector q = left - (evaluate(h, Vector::Zero(x.size()), x).w);
  const Vector right = right_side(evaluate(h, q, moved).w);
  return evaluate(h, q, expand(other_laws, sets_, list_, solve(right, 1), std::move(moved)));
}

Matrix System::change(const Laws &laws, const Matrix &of_q) const {
  Matrix result(of_q.rows(), of_q.cols());
  for (Index k = 0; k < of_q.cols(); ++k)
    result.col(k) =
        expand(laws, sets_, list_, solve(right_side(of_q.col(k)), 1), Vector::Zero(of_q.rows()));
  return result;
}

} // namespace rbvi::friction
