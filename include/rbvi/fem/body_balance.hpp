// All forces on a body, as outputs print them, added up: reactions, contact and springs, with the
// loads. They vanish along every direction in which the body is free, or where reactions have all
// that holds it; there the sum sees what neither the residual nor lambda^T B knows of: rows of a
// reaction, a spring, a load, a side of contact. A membrane has one direction, upwards, and of a
// full solve all that holds it is known without outputs: the rows of the held dofs.
#pragma once

#include "rbvi/fem/problem.hpp"

#include <optional>

namespace rbvi {

/// Terms of one sum.
struct BodyForces {
  std::string boundary; ///< of one of the bodies
  Point direction;
  bool membrane = false;
  std::map<int, double> outputs;  ///< named ones, by number: 1 of a reaction, shares of a spring
  std::map<int, double> contacts; ///< by number: 1 or -1, as they are the first or the other side
  double load = 0, sizes = 0;     ///< of all loads, and of their terms
};

/// Those of bodies and membranes whose terms are all known; none where something is held, or pulled
/// by a spring, that no output has, or along which images cancel. Collective.
std::vector<BodyForces> forces_on_bodies(const Problem &problem, const FullMu &mu);

/// What they leave, and the sum of the sizes of all terms.
std::array<double, 2> left_of(const BodyForces &forces, const Outputs &outputs);

/// Throws failure, naming the body, where forces leave more than `tolerance` of their sizes.
/// `round_off`: what else to count as one. Collective.
void check_balance(const Problem &problem, const FullMu &mu, const Outputs &outputs,
                   double tolerance, double round_off);

/// Of all of a membrane, upwards; of the domain, without its images.
struct MembraneForces {
  double load = 0;
  double contact = 0; ///< as outputs have it, without a pull of adhesion, which is a load
  double flux = 0;    ///< what holds it pulls with: the sum of the reactions of its held dofs
  double sizes = 0;   ///< of all terms
  double left() const { return load + contact + flux; }
};

/// Of an answer of `problem`, which is assembled at its mu; u at all dofs in natural order. Nothing
/// of what is no membrane, and where a constant does work in some term of a, or contact alone holds
/// it. Collective.
std::optional<MembraneForces> forces_on_membrane(const Problem &problem, const FullMu &mu,
                                                 const Vector &u, const Vector &lambda,
                                                 const Outputs &outputs);

/// Throws failure, naming the membrane by its contact, where they leave more than check_balance
/// allows. Collective.
void check_membrane(const Problem &problem, const FullMu &mu, const Vector &u, const Vector &lambda,
                    const Outputs &outputs, double tolerance, double round_off);

} // namespace rbvi
