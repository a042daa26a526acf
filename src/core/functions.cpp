#include "rbvi/core/functions.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>

namespace rbvi {

namespace {

struct Identity {
  Point operator()(const FullMu &, const Point &x) const { return x; }
};

/// Of components of any one type, the others zero.
template <class Number> struct SameEverywhere {
  std::vector<Number> components;
  Point operator()(const FullMu &mu, const Point &) const {
    Point vector{};
    for (std::size_t c = 0; c < components.size(); ++c)
      vector[c] = components[c](mu);
    return vector;
  }
};

} // namespace

std::string place_text(const Point &x) {
  return "(" + short_number(x[0]) + ", " + short_number(x[1]) + ", " + short_number(x[2]) + ")";
}

std::function<NumberMap> logarithm() {
  return [](double x) { return std::log(x); };
}

std::function<NumberMap> exponential() {
  return [](double x) { return std::exp(x); };
}

std::function<NumberMap> logarithm_to_half() {
  return [](double x) { return std::log(1 - 2 * x); };
}

std::function<NumberMap> exponential_to_half() {
  return [](double x) { return (1 - std::exp(x)) / 2; };
}

std::function<Coefficient> affine(double value, double factor, int index) {
  return AffineCoefficient{value, factor, static_cast<std::size_t>(index)};
}

std::function<Coefficient> parameter(int index) {
  return affine(0, 1, index);
}

std::function<Coefficient> constant(double value) {
  return AffineCoefficient{value};
}

std::function<PointMap> identity() {
  return Identity{};
}

bool is_identity(const std::function<PointMap> &map) {
  return map.target<Identity>() != nullptr;
}

bool is_everywhere(const std::function<PointMap> &map) {
  return map.target<SameEverywhere<AffineCoefficient>>() != nullptr ||
         map.target<SameEverywhere<std::function<Coefficient>>>() != nullptr;
}

std::function<PointValue> everywhere(double value) {
  return [value](const FullMu &, const Point &) { return value; };
}

std::function<PointMap> everywhere(const Point &vector) {
  return SameEverywhere<AffineCoefficient>{{{vector[0]}, {vector[1]}, {vector[2]}}};
}

std::function<PointMap> everywhere(const std::vector<std::function<Coefficient>> &components) {
  std::vector<AffineCoefficient> lines;
  for (const auto &component : components)
    if (const auto *line = component.target<AffineCoefficient>()) lines.push_back(*line);
  if (lines.size() == components.size()) return SameEverywhere<AffineCoefficient>{lines};
  return SameEverywhere<std::function<Coefficient>>{components};
}

std::function<PointValue> everywhere(const std::function<Coefficient> &value) {
  return [value](const FullMu &mu, const Point &) { return value(mu); };
}

std::function<PointMap> scaled(const std::function<Coefficient> &scale) {
  if (const auto *line = scale.target<AffineCoefficient>()) return Scaling{*line};
  return [scale](const FullMu &mu, const Point &x) { return scale(mu) * x; };
}

std::function<Material> everywhere(const Lame &material) {
  return [material](const FullMu &, const Point &) { return material; };
}

} // namespace rbvi
