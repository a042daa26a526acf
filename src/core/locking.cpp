#include "rbvi/core/locking.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>

namespace rbvi {

double locking_ratio(const Scene &scene, const FullMu &all_parameters,
                     const std::vector<Point> &points) {
  constexpr double locks_from = 0.49;
  if (scene.degree != 1 || !scene.material) return 0;
  double largest = 0;
  for (const Point &x : points) {
    const auto [lambda, shear] = scene.material(all_parameters, x);
    largest = std::max(largest, lambda / (2 * (lambda + shear)));
  }
  return largest < locks_from - 1e-12 ? 0 : largest;
}

void warn_of_locking(double ratio, std::ostream &out) {
  if (ratio == 0) return;
  out << "warning: Poisson's ratio is " << short_number(ratio)
      << ", where elements of degree 1 lock: forces may be a tenth or more too large, peaks of the "
         "pressure several times, and a finer mesh does not mend that: use -degree 2\n";
}

} // namespace rbvi
