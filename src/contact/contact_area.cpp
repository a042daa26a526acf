#include "rbvi/contact/contact_area.hpp"

#include <algorithm>

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

} // namespace rbvi
