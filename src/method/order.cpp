#include "order.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi::friction {

Order::Order(const NodeLaws &laws) : rows_(laws.rows) {
  for (const Index row : laws.normal)
    of_.push_back(row);
  for (Index i = 0; i < laws.nodes() && laws.has_tangents(); ++i)
    for (int k = 0; k < laws.tangents; ++k)
      of_.push_back(laws.has_tangent(i) ? laws.tangent[i] + k : -1);
  same_ = size() == rows_;
  for (Index j = 0; j < size(); ++j)
    same_ = same_ && row(j) == j;
}

Vector Order::inwards(const Vector &values) const {
  return same_ || values.size() == 0 ? values : Vector(reordered(values));
}

Matrix Order::reordered(const Matrix &values) const {
  Matrix result = Matrix::Zero(size(), values.cols());
  for (Index j = 0; j < size(); ++j)
    if (row(j) >= 0) result.row(j) = values.row(row(j));
  return result;
}

Vector Order::outwards(const Vector &values) const {
  if (same_) return values;
  Vector result = Vector::Zero(values.size() > 0 ? rows_ : 0);
  for (Index j = 0; j < size() && values.size() > 0; ++j)
    if (row(j) >= 0) result[row(j)] = values[j];
  return result;
}

ColumnSource Order::inwards(const ColumnSource &columns) const {
  if (same_) return columns;
  return [this, &columns](std::vector<Index> which) {
    for (Index &j : which)
      j = row(j);
    return reordered(columns(which));
  };
}

Laws laws_of(const NodeLaws &of) {
  const Index nodes = of.nodes();
  Laws laws{.nodes = nodes, .dim = of.has_tangents() ? 1 + of.tangents : 1, .of = of.bound};
  for (Index i = 0; i < nodes; ++i)
    if (!of.has_tangent(i)) laws.of[i] = {};
  return laws;
}

void describe(FrictionResult &result, const Laws &laws, const ActiveSets &sets) {
  result.active.clear();
  result.states.assign(laws.nodes, NodeState::open);
  for (Index i = 0; i < laws.nodes; ++i) {
    if (!(result.x[i] > 0)) continue;
    result.active.push_back(i);
    result.states[i] = sets.tangent_at(i) == Tangent::stick ? NodeState::stick : NodeState::slip;
  }
}

Vector smooth_start(const Vector &diagonal, const Laws &laws, const State &point) {
  Vector result = diagonal;
  for (Index i = 0; laws.dim == 3 && i < laws.nodes; ++i)
    result.segment(laws.tangent(i), 2).setConstant(result.segment(laws.tangent(i), 2).mean());
  const Index known = (result.array() > 0).count();
  const double mean = known > 0 ? result.sum() / static_cast<double>(known) : 1;
  for (Index j = 0; j < result.size(); ++j)
    result[j] = point.x[j] - point.w[j] / (result[j] > 0 ? result[j] : mean);
  return result;
}

Vector Laws::bounds(const Vector &x) const {
  return Vector::NullaryExpr(nodes, [&](Index i) { return bound(i, x[i]); });
}

Vector Laws::feasible(Vector x) const {
  for (Index i = 0; i < nodes; ++i) {
    x[i] = std::max(x[i], 0.0);
    auto tangential = x.segment(tangent(i), dim - 1);
    const double size = tangential.norm(), limit = bound(i, x[i]);
    if (size > limit) tangential *= limit / size;
  }
  return x;
}

bool Laws::jump() const {
  return std::ranges::any_of(of, &FrictionBound::jumps);
}

bool Laws::follow_pressure() const {
  return std::ranges::any_of(of, &FrictionBound::follows_pressure);
}

double Laws::steepest() const {
  double result = 0;
  for (const FrictionBound &law : of)
    result = std::max(result, law.steepest());
  return result;
}

int Laws::steps_to(double steepest) {
  constexpr double longest = 0.25;
  return std::max(1, static_cast<int>(std::ceil(steepest / longest)));
}

Laws Laws::with_slopes(double part) const {
  Laws result = *this;
  for (FrictionBound &law : result.of)
    law = law.with_slopes(part);
  return result;
}

Laws Laws::with_thresholds(double factor) const {
  Laws result = *this;
  for (FrictionBound &law : result.of)
    law = law.with_threshold(factor);
  return result;
}

std::vector<char> Laws::jumped(const Vector &x) const {
  std::vector<char> result(nodes);
  for (Index i = 0; i < nodes; ++i)
    result[i] = x[i] > 0 && of[i].jumps() ? 1 : 0;
  return result;
}

Laws Laws::without_jump(const std::vector<char> &jumped) const {
  Laws result = *this;
  for (Index i = 0; i < nodes; ++i) {
    if (of[i].jumps()) result.of[i] = of[i].with_threshold(jumped[i]);
    result.of[i].only_in_contact = false;
  }
  return result;
}

Laws Laws::frozen(const Vector &bounds) const {
  Laws result = *this;
  for (Index i = 0; i < nodes; ++i)
    result.of[i] = {.threshold = bounds[i]};
  return result;
}

} // namespace rbvi::friction
