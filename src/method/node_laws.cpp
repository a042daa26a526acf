#include "rbvi/method/node_laws.hpp"

#include "rbvi/core/error.hpp"

#include <cmath>
#include <string>

namespace rbvi {

void FrictionBound::check() const {
  const bool valid = std::isfinite(coefficient + threshold + pull) && coefficient >= 0 &&
                     threshold >= 0 && limit >= 0 && pull >= 0;
  if (!valid)
    throw bad_input("coefficient, threshold and limit of friction, and adhesion, must not be "
                    "negative");
}

std::vector<FrictionBound> bounds_per_node(const std::vector<FrictionBound> &bounds, Index nodes) {
  if (bounds.size() != 1 && std::ssize(bounds) != nodes)
    throw failure("laws of contact: " + std::to_string(bounds.size()) +
                  " bounds of friction instead of " + std::to_string(nodes));
  for (const FrictionBound &bound : bounds)
    bound.check();
  return bounds.size() == 1 ? std::vector(nodes, bounds.front()) : bounds;
}

std::vector<FrictionBound> bounds_at(const std::vector<FrictionBound> &bounds,
                                     const std::vector<Index> &nodes) {
  std::vector<FrictionBound> result;
  for (const Index j : nodes)
    result.push_back(bounds[j]);
  return result;
}

Vector values_of(const FrictionBound &bound, const Vector &normal) {
  return normal.unaryExpr([&](double x_n) { return bound.value(x_n); });
}

bool NodeLaws::has_tangents() const {
  return std::ranges::any_of(tangent, [](Index row) { return row >= 0; });
}

bool NodeLaws::friction() const {
  for (Index i = 0; i < nodes(); ++i)
    if (friction_at(i).acts()) return true;
  return false;
}

NodeLaws uniform_laws(Index nodes, int components, const FrictionBound &bound) {
  NodeLaws laws;
  laws.tangents = std::max(1, components - 1);
  laws.rows = nodes * components;
  for (Index i = 0; i < nodes; ++i) {
    laws.normal.push_back(i);
    laws.tangent.push_back(components > 1 ? nodes + i * (components - 1) : -1);
  }
  laws.bound.assign(nodes, bound);
  laws.free.assign(nodes, components - 1);
  return laws;
}

void append(const NodeLaws &part, NodeLaws &laws) {
  if (laws.nodes() == 0) laws.tangents = part.tangents;
  for (Index i = 0; i < part.nodes(); ++i) {
    laws.normal.push_back(laws.rows + part.normal[i]);
    laws.tangent.push_back(part.has_tangent(i) ? laws.rows + part.tangent[i] : -1);
    laws.bound.push_back(part.bound[i]);
    laws.free.push_back(part.has_tangent(i) ? part.free_at(i) : 0);
    if (part.has_tangent(i)) laws.tangents = part.tangents;
  }
  laws.rows += part.rows;
}

void check(const NodeLaws &laws) {
  std::vector<int> count(laws.rows, 0);
  const auto take = [&](Index row) {
    if (row < 0 || row >= laws.rows) throw failure("laws of contact: a node has no such row");
    ++count[row];
  };
  if (laws.tangents < 1 || laws.tangents > 2)
    throw failure("laws of contact: the dimension is not 2 or 3");
  for (Index i = 0; i < laws.nodes(); ++i) {
    take(laws.normal[i]);
    for (int k = 0; k < laws.tangents && laws.has_tangent(i); ++k)
      take(laws.tangent[i] + k);
    laws.bound[i].check();
  }
  if (std::ranges::any_of(count, [](int times) { return times != 1; }))
    throw failure("laws of contact: a row belongs to no node, or to two");
}

Vector bounds_of(const NodeLaws &laws, const Vector &x) {
  return Vector::NullaryExpr(laws.nodes(),
                             [&](Index i) { return laws.friction_at(i).value(x[laws.normal[i]]); });
}

Vector admissible(const NodeLaws &laws, Vector x) {
  for (Index i = 0; i < laws.nodes(); ++i) {
    double &normal = x[laws.normal[i]];
    normal = std::max(normal, 0.0);
    if (!laws.has_tangent(i)) continue;
    auto tangential = x.segment(laws.tangent[i], laws.tangents);
    tangential.tail(laws.tangents - laws.free_at(i)).setZero();
    const double size = tangential.norm(), limit = laws.bound[i].value(normal);
    if (size > limit) tangential *= limit / size;
  }
  return x;
}

double violation(const NodeLaws &laws, const Vector &x, const Vector &start) {
  const double size = x.cwiseAbs().maxCoeff();
  const double largest = (x - admissible(laws, start)).cwiseAbs().maxCoeff();
  return size > 0 ? largest / size : largest;
}

Vector normal_part(const NodeLaws &laws, const Vector &x) {
  Vector result = Vector::Zero(x.size());
  result(laws.normal) = x(laws.normal);
  return result;
}

} // namespace rbvi
