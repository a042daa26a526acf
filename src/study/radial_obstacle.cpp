#include "rbvi/study/radial_obstacle.hpp"

#include "rbvi/core/error.hpp"

#include <cmath>
#include <numbers>

namespace rbvi {

using std::numbers::pi;

RadialObstacle radial_obstacle(double a, double f, double c) {
  // u'(s) = B / s - f s / 2 = -2 c s gives B; u(a) - u(s) = -psi(s) is left for s.
  const auto log_factor = [&](double s) { return s * s * (f / 2 - 2 * c); };
  const auto excess = [&](double s) {
    return log_factor(s) * std::log(a / s) - f / 4 * (a * a - s * s) - c * s * s;
  };
  double low = 1e-12 * a, high = a;
  if (!(f < 0 && c > 0 && excess(low) > 0 && excess(high * (1 - 1e-9)) < 0))
    throw failure("the radial obstacle problem has no ring-free contact set for these data");
  for (int k = 0; k < 200; ++k) {
    const double middle = (low + high) / 2;
    (excess(middle) > 0 ? low : high) = middle;
  }
  return {a, f, c, low, log_factor(low)};
}

double RadialObstacle::u(double rho) const {
  if (rho <= s) return -c * rho * rho;
  return log_factor * std::log(rho / a) - f / 4 * (rho * rho - a * a);
}

double RadialObstacle::multiplier() const {
  return 4 * c - f;
}

double RadialObstacle::area() const {
  return pi * s * s;
}

double RadialObstacle::force() const {
  return multiplier() * area();
}

double RadialObstacle::energy() const {
  // Green: int |grad u|^2 = int f u + int lambda u, so J = -int f u / 2 + int lambda u / 2.
  const auto power = [](double x) { return x * x * x * x; };
  const double inside = -c * pi * power(s) / 2; // int u over the contact set
  const double b = log_factor;
  const auto log_part = [&](double rho) { return rho * rho / 2 * (std::log(rho / a) - 0.5); };
  const double outside = 2 * pi *
                         (b * (log_part(a) - log_part(s)) -
                          f / 4 * ((power(a) - power(s)) / 4 - a * a * (a * a - s * s) / 2));
  return -f * (inside + outside) / 2 + multiplier() * inside / 2;
}

} // namespace rbvi
