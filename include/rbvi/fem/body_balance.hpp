// All forces on a body, as outputs print them, added up: reactions, contact and springs, with the
// loads. They vanish along every direction in which the body is free, or where reactions have all
// that holds it; there the sum sees what neither the residual nor lambda^T B knows of: rows of a
// reaction, a spring, a load, a side of contact.
#pragma once

#include "rbvi/fem/problem.hpp"

namespace rbvi {

/// Terms of one sum.
struct BodyForces {
  std::string boundary; ///< of one of the bodies
  Point direction;
  std::map<int, double> outputs;  ///< named ones, by number: 1 of a reaction, shares of a spring
  std::map<int, double> contacts; ///< by number: 1 or -1, as they are the first or the other side
  double load = 0, sizes = 0;     ///< of all loads, and of their terms
};

/// Those of elastic bodies in the plane or turned whose terms are all known; none where something
/// is held, or pulled by a spring, that no output has, or along which images cancel. Collective.
std::vector<BodyForces> forces_on_bodies(const Problem &problem, const FullMu &mu);

/// What they leave, and the sum of the sizes of all terms.
std::array<double, 2> left_of(const BodyForces &forces, const Outputs &outputs);

/// Throws failure, naming the body, where forces leave more than `tolerance` of their sizes.
/// `round_off`: what else to count as one. Collective.
void check_balance(const Problem &problem, const FullMu &mu, const Outputs &outputs,
                   double tolerance, double round_off);

} // namespace rbvi
