#include "rbvi/contact/contact_area.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

double contact_area(const Vector &weights, const Vector &lambda, const std::vector<int> &cells,
                    int corners) {
  Vector largest = lambda;
  for (auto cell = cells.begin(); cell != cells.end(); cell += corners) {
    double of_cell = 0;
    for (auto node = cell; node != cell + corners; ++node)
      of_cell = std::max(of_cell, lambda[*node]);
    for (auto node = cell; node != cell + corners; ++node)
      largest[*node] = std::max(largest[*node], of_cell);
  }
  double area = 0;
  for (Index i = 0; i < lambda.size(); ++i)
    if (lambda[i] > 0) area += weights[i] * lambda[i] / largest[i];
  return area;
}

double way_to_zone(const NodesBeside &outside) {
  const auto power = [](double value) { return std::cbrt(value * value); };
  const auto [near, far] = outside.values;
  if (!(far > std::max(near, 0.0))) return std::numeric_limits<double>::quiet_NaN();
  const double here = power(std::max(near, 0.0));
  return outside.apart * here / (power(far) - here);
}

double way_into_edge(const NodesBeside &inside, const NodesBeside &outside, double edge) {
  const auto [last, before] = inside.values;
  const double apart = inside.apart, force = apart * (before + last) / 2 + edge * last / 2,
               moment =
                   apart * apart * (before / 6 + last / 3) + edge * last * (apart / 2 + edge / 6);
  double sum = 0, count = 0;
  for (const double way : {2.5 * moment / force - apart, edge - way_to_zone(outside)})
    if (!std::isnan(way)) {
      sum += way;
      ++count;
    }
  return count > 0 ? std::clamp(sum / count, 0.0, edge) : edge / 2;
}

double integral_of_magnitude(const std::array<double, 2> &hats, const std::array<double, 2> &v) {
  const double whole = hats[0] * v[0] + hats[1] * v[1];
  if (v[0] * v[1] >= 0) return std::abs(whole);
  const double zero = v[0] / (v[0] - v[1]), first = 4 * hats[0] - 2 * hats[1],
               slope = 6 * (hats[1] - hats[0]);
  const double part = v[0] * zero * (first / 2 + slope * zero / 6);
  return std::abs(part) + std::abs(whole - part);
}

} // namespace rbvi
