// Closed form of a radial obstacle problem: a membrane on the disc of radius a fixed at its rim,
// under a constant load f < 0, held by the obstacle psi = -c rho^2.
//
// It touches on rho <= s; outside, -Laplace u = f gives u = A + B ln rho - f rho^2 / 4. u(a) = 0
// and u = psi, u' = psi' at s leave one equation for s. On the contact set the multiplier is lambda
// = -Laplace psi - f = 4 c - f.
#pragma once

namespace rbvi {

struct RadialObstacle {
  double a, f, c;    ///< radius of the rim, load, curvature of the obstacle
  double s;          ///< radius of the contact set
  double log_factor; ///< B

  double u(double rho) const;
  double multiplier() const; ///< on the contact set
  double force() const;      ///< its integral
  double area() const;       ///< of the contact set
  double energy() const;     ///< int |grad u|^2 / 2 - f u
};

/// Solves for s by bisection to round-off. Needs f < 0 < c and a load that reaches the obstacle's
/// top; throws failure otherwise.
RadialObstacle radial_obstacle(double a, double f, double c);

} // namespace rbvi
