#include "friction_convex.hpp"

#include <algorithm>

namespace rbvi::friction {

namespace {

/// Every node in turn goes to its best place along its normal, then down its tangential gradient.
void sweep(const LazyColumns &h, const Laws &frozen, State &point) {
  const Index count = frozen.dim - 1;
  for (Index i = 0; i < frozen.nodes; ++i) {
    if (h.has(i)) {
      const double change = std::max(0.0, point.x[i] - point.w[i] / h.diagonal(i)) - point.x[i];
      point.x[i] += change;
      if (change != 0) point.w += change * h.column(i);
    }
    const Index t = frozen.tangent(i);
    if (frozen.threshold[i] == 0 || !h.has(t)) continue;
    double curvature = 0;
    for (Index k = 0; k < count; ++k)
      curvature += h.diagonal(t + k);
    const Vector old = point.x.segment(t, count);
    Vector next = old - point.w.segment(t, count) / curvature;
    const double size = next.norm();
    if (size > frozen.threshold[i]) next *= frozen.threshold[i] / size;
    point.x.segment(t, count) = next;
    for (Index k = 0; k < count; ++k)
      if (next[k] != old[k]) point.w += (next[k] - old[k]) * h.column(t + k);
  }
}

/// The part of the way to `aim` at which the function is least, at most 1.
double shorten(const State &point, const State &aim) {
  const Vector way = aim.x - point.x;
  const double slope = way.dot(point.w), curvature = way.dot(aim.w - point.w);
  if (!(slope < 0)) return 0;
  return curvature > -slope ? -slope / curvature : 1;
}

} // namespace

bool minimise(LazyColumns &h, const Vector &q, const Laws &frozen, double tolerance, int &steps,
              State &point) {
  ActiveSets sets = contact_sets(frozen, point.x);
  for (;;) {
    Verdict verdict = judge(diagonal_of(h, q.size()), frozen, point, sets, tolerance);
    if (verdict.residual <= tolerance || steps <= 0) return true;
    --steps;
    sets = std::move(verdict.next);
    h.require(sets.support(frozen));
    State aim;
    if (System(h, frozen, sets).step(h, q, frozen, aim) != Solved::yes) return false;
    aim = evaluate(h, q, frozen.feasible(std::move(aim.x)));
    const double part = shorten(point, aim);
    if (part == 1) {
      point = std::move(aim);
      continue;
    }
    point.x += part * (aim.x - point.x);
    point.w += part * (aim.w - point.w);
    sweep(h, frozen, point);
    point = evaluate(h, q, std::move(point.x));
  }
}

} // namespace rbvi::friction
