#include "friction_convex.hpp"

#include "friction_laws.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace rbvi::friction {

namespace {

/// Every node in turn goes to its best place along its normal, then down its tangential gradient.
void sweep(const LazyColumns &h, const NodeLaws &frozen, State &point) {
  const Index count = frozen.tangents;
  for (Index i = 0; i < frozen.nodes(); ++i) {
    const Index n = frozen.normal[i], t = frozen.tangent[i];
    if (h.has(n)) {
      const double change = std::max(0.0, point.x[n] - point.w[n] / h.diagonal()[n]) - point.x[n];
      point.x[n] += change;
      if (change != 0) point.w += change * h.column(n);
    }
    const double bound = frozen.friction_at(i).value(0);
    if (bound == 0 || !h.has(t)) continue;
    double curvature = 0;
    for (Index k = 0; k < count; ++k)
      curvature += h.diagonal()[t + k];
    const Vector old = point.x.segment(t, count);
    Vector next = old - point.w.segment(t, count) / curvature;
    const double size = next.norm();
    if (size > bound) next *= bound / size;
    point.x.segment(t, count) = next;
    for (Index k = 0; k < count; ++k)
      if (next[k] != old[k]) point.w += (next[k] - old[k]) * h.column(t + k);
  }
}

/// Held are the entries at a bound that the gradient presses on; all others are free.
ActiveSets held_sets(const Vector &diagonal, const NodeLaws &frozen, const State &point) {
  constexpr double round_off = 1e-12;
  ActiveSets sets(frozen);
  const Index count = frozen.tangents;
  for (Index i = 0; i < frozen.nodes(); ++i) {
    const Index n = frozen.normal[i], t = frozen.tangent[i];
    sets.active[i] = point.x[n] > 0 || point.w[n] < 0;
    const double bound = frozen.friction_at(i).value(0);
    if (bound == 0) continue;
    const auto x = point.x.segment(t, count);
    const bool presses = x.dot(point.w.segment(t, count)) <= 0;
    const bool held = x.norm() >= (1 - round_off) * bound && presses;
    sets.tangent[i] = held ? Tangent::slip : Tangent::stick;
    if (held) sets.direction.col(i) = x.normalized();
  }
  set_curvature(diagonal, frozen, smooth_start(diagonal, frozen, point), sets);
  return sets;
}

/// A half-line or disk that the way x + t d leaves.
struct Stop {
  double at; ///< t
  Index first, count;
};

std::vector<Stop> stops_along(const NodeLaws &frozen, const Vector &x, const Vector &d) {
  std::vector<Stop> stops;
  const Index count = frozen.tangents;
  for (Index i = 0; i < frozen.nodes(); ++i) {
    const Index n = frozen.normal[i], t = frozen.tangent[i];
    if (d[n] < 0) stops.push_back({-x[n] / d[n], n, 1});
    if (t < 0) continue;
    const auto from = x.segment(t, count), way = d.segment(t, count);
    const double a = way.squaredNorm(), b = from.dot(way), bound = frozen.bound[i].value(0);
    if (a == 0) continue;
    const double left = std::max(0.0, bound * bound - from.squaredNorm());
    stops.push_back({(std::sqrt(b * b + a * left) - b) / a, t, count});
  }
  std::ranges::sort(stops, {}, &Stop::at);
  return stops;
}

/// From the point towards `aim`, every entry (or disk) held from where it meets its bound, to where
/// the function is least along that way. Whether it ends before anything is held.
bool follow(const LazyColumns &h, const NodeLaws &frozen, const Vector &aim, State &point) {
  Vector d = aim - point.x, hd = Vector::Zero(d.size());
  const std::vector<Stop> stops = stops_along(frozen, point.x, d);
  for (Index j = 0; j < d.size(); ++j)
    if (d[j] != 0) hd += d[j] * h.column(j);
  double t = 0;
  for (std::size_t k = 0;; ++k) {
    const double slope = d.dot(point.w);
    if (!(slope < 0)) return false;
    const double least = -slope / d.dot(hd);
    const double next =
        k < stops.size() ? std::max(0.0, stops[k].at - t) : std::numeric_limits<double>::infinity();
    const double step = std::min(least, next);
    point.x += step * d;
    point.w += step * hd;
    t += step;
    if (least <= next) return k == 0;
    for (Index j = stops[k].first; j < stops[k].first + stops[k].count; ++j)
      if (d[j] != 0) hd -= std::exchange(d[j], 0.0) * h.column(j);
  }
}

} // namespace

bool minimise(LazyColumns &h, const Vector &q, const NodeLaws &frozen, double tolerance, int &steps,
              State &point) {
  ActiveSets sets = contact_sets(frozen, point.x);
  for (;;) {
    const Vector &diagonal = h.diagonal();
    const Verdict verdict = judge(diagonal, frozen, point, sets, tolerance);
    if (verdict.residual <= tolerance || steps <= 0) return true;
    --steps;
    sets = held_sets(diagonal, frozen, point);
    h.require(sets.support(frozen));
    State aim;
    if (System(h, frozen, sets).step(h, q, frozen, 1, aim) != Solved::yes) return false;
    if (!follow(h, frozen, aim.x, point)) sweep(h, frozen, point);
    point = evaluate(h, q, admissible(frozen, std::move(point.x)));
  }
}

} // namespace rbvi::friction
