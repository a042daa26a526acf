#include "friction_newton.hpp"
#include "rbvi/core/largest.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rbvi::friction {

namespace {

/// The verdict on a point, node by node.
class Judge {
public:
  Judge(const Vector &diagonal, const NodeLaws &laws, const State &point, const ActiveSets &sets,
        double tolerance, double largest)
      : diagonal_(diagonal), laws_(laws), point_(point), sets_(sets), tolerance_(tolerance),
        largest_(largest), verdict_{.next = ActiveSets(laws)} {}
  Verdict all() {
    for (Index i = 0; i < laws_.nodes(); ++i) {
      normal(i);
      if (laws_.has_tangent(i)) tangent_of(i);
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
           ((laws_.tangents == 1 && verdict_.next.direction(0, i) != sets_.direction(0, i)) ||
            verdict_.next.piece[i] != sets_.piece[i]);
  }
  void normal(Index i) {
    const Index n = laws_.normal[i];
    const double x = point_.x[n], w = point_.w[n], terms = point_.terms[n];
    violated(x > 0 ? std::abs(w) : -w, terms);
    char &next = verdict_.next.active[i];
    const double counted = std::abs(w) <= tolerance_ * terms ? 0 : w;
    if (diagonal_[n] == 0) {
      next = counted < 0;
      return;
    }
    if (x < 0) violated(-x * root(n), largest_);
    const double y = x * root(n) - counted / root(n);
    next =
        sets_.is_active(i) && !laws_.friction_at(i).jumps() ? y >= -tolerance_ * largest_ : y > 0;
  }
  void tangent_of(Index i) {
    Tangent &next = verdict_.next.tangent[i];
    const FrictionBound &law = laws_.bound[i];
    const double bound = law.value(point_.x[laws_.normal[i]]);
    const bool known = diagonal_[laws_.tangent[i]] != 0;
    if (known) measure(i, bound);
    if (!law.carries_traction(verdict_.next.is_active(i))) return;
    verdict_.next.direction.col(i) = sets_.direction.col(i);
    verdict_.next.piece[i] = sets_.piece[i];
    if (bound > 0 && known)
      predict(i, bound);
    else if (sets_.tangent_at(i) == Tangent::none)
      begin(i);
    else if (bound == 0 && law.pull > 0)
      slide(i);
    else
      next = sets_.tangent_at(i);
  }
  /// Tangential components of a node; where one is free the second one is zero.
  using Pair = std::array<double, 2>;
  Pair tangential(const Vector &of, Index i) const {
    const Index t = laws_.tangent[i];
    return {of[t], laws_.free_at(i) == 2 ? of[t + 1] : 0};
  }
  static double size_of(const Pair &p) {
    return p[1] == 0 ? std::abs(p[0]) : std::hypot(p[0], p[1]);
  }
  static double dot(const Pair &p, const Pair &q) { return p[0] * q[0] + p[1] * q[1]; }
  void slip(Index i, const Pair &along, double size) {
    verdict_.next.tangent[i] = Tangent::slip;
    verdict_.next.piece[i] = piece_of(i);
    for (int k = 0; k < laws_.tangents; ++k)
      verdict_.next.direction(k, i) = along[k] / size;
  }
  /// The round-off of bounds, which are differences where nodes adhere; 0: they are none.
  static double round_off_of(const FrictionBound &law) { return 1e-11 * law.size_at_kinks(0); }
  /// The piece of the law at x_n; at a kink, where two are, that of the sets.
  char piece_of(Index i) const {
    const FrictionBound &law = laws_.bound[i];
    const double x = point_.x[laws_.normal[i]], s = law.value(x);
    const auto [offset, slope] = sets_.piece_of(laws_, i);
    const bool stays = std::abs(offset + slope * x - s) <= tolerance_ * s + round_off_of(law);
    return stays ? sets_.piece[i] : static_cast<char>(law.piece_at(x));
  }
  /// The bound of a node that just came into contact was zero: it slips against its w_tau.
  void begin(Index i) {
    const Pair w = tangential(point_.w, i);
    const double size = size_of(w);
    verdict_.next.tangent[i] = Tangent::stick;
    if (size > 0) slip(i, w, -size);
  }
  /// So does one that adheres and is not pressed; where it does not move, as before, or as it
  /// pulled.
  void slide(Index i) {
    const Pair x = tangential(point_.x, i), w = tangential(point_.w, i);
    verdict_.next.tangent[i] = Tangent::stick;
    if (size_of(w) > tolerance_ * size_of(tangential(point_.terms, i)))
      slip(i, w, -size_of(w));
    else if (sets_.tangent_at(i) == Tangent::slip)
      slip(i, direction(i), 1);
    else if (size_of(x) > round_off_of(laws_.bound[i]))
      slip(i, x, size_of(x));
  }
  void measure(Index i, double bound) {
    const Pair x = tangential(point_.x, i), w = tangential(point_.w, i);
    const double size = size_of(x), terms = size_of(tangential(point_.terms, i));
    if (std::max(size, bound) <= round_off_of(laws_.bound[i])) return;
    violated((size - bound) * std::sqrt(tangential_diagonal(diagonal_, laws_, i)), largest_);
    if (size < bound * (1 - 1e-14) - round_off_of(laws_.bound[i])) {
      violated(size_of(w), terms);
      return;
    }
    const double along = dot(x, w) / size;
    violated(along, terms);
    if (laws_.tangents == 2) violated(std::abs(x[0] * w[1] - x[1] * w[0]) / size, terms);
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
    const bool slips =
        sets_.tangent_at(i) == Tangent::slip
            ? size >= bound * (1 - 1e-15) - round_off_of(laws_.bound[i]) && dot(y, direction(i)) > 0
            : size > bound + tolerance_ * largest_ / std::sqrt(diagonal);
    verdict_.next.tangent[i] = Tangent::stick;
    if (!slips) return;
    slip(i, y, size);
    verdict_.next.curvature[i] = std::max(0.0, size - bound) * diagonal / bound;
  }
  Pair direction(Index i) const {
    return {sets_.direction(0, i), laws_.tangents == 2 ? sets_.direction(1, i) : 0};
  }

  const Vector &diagonal_;
  const NodeLaws &laws_;
  const State &point_;
  const ActiveSets &sets_;
  double tolerance_, largest_;
  Verdict verdict_;
};

} // namespace

double largest_scaled(const Vector &diagonal, const Vector &x) {
  double largest = 0;
  for (Index j = 0; j < x.size(); ++j)
    if (x[j] != 0) largest = std::max(largest, std::abs(x[j]) * std::sqrt(diagonal[j]));
  return largest;
}

Verdict judge(const Vector &diagonal, const NodeLaws &laws, const State &point,
              const ActiveSets &sets, double tolerance, double largest) {
  return Judge(diagonal, laws, point, sets, tolerance, largest).all();
}

Verdict judge(const Vector &diagonal, const NodeLaws &laws, const State &point,
              const ActiveSets &sets, double tolerance) {
  return judge(diagonal, laws, point, sets, tolerance, largest_scaled(diagonal, point.x));
}

} // namespace rbvi::friction
