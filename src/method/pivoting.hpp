// The pivoting policy of all complementarity solvers, and the sets of entries it works on.
//
// A basis (an active set, or the states of all nodes) makes the problem linear; its solution tells
// which entries violate the law. Block exchange moves all of them to the other side at once: a
// semismooth Newton step (Judice and Pires 1994; Hintermueller, Ito and Kunisch 2002), which ends
// after a few bases but can run in circles. So it goes on for as long as it is worth while:
//
//   no violation left                                       the basis is the solution's
//   a basis returns                                         block exchange runs in a circle
//   `patience` bases in a row without a new least violation block exchange is lost
//
// and what then takes over is the solver's own: a single exchange by least index (Murty), which
// ends where the matrix is a P-matrix, or a convex problem with frozen bounds.
#pragma once

#include "rbvi/core/dense.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

namespace rbvi::pivoting {

/// The next exchange: all violated entries, or the solver's own fallback.
enum class Exchange { block, fallback };

/// `Basis`: ordered by <. `Violation`: how many entries violate the law, or by how much.
template <class Basis, class Violation> class Policy {
public:
  /// `patience` >= 1: block exchange ends with that many bases in a row that are no improvement.
  explicit Policy(int patience) : patience_(patience) {}

  /// For solvers that ask after a basis has been solved, and go back from single exchanges to
  /// blocks at a new least violation. `violation` > 0 is what `solved` leaves.
  Exchange after(const Basis &solved, Violation violation) {
    const bool improved = violation < least_, lost = is_lost(violation);
    if (improved)
      exchange_ = Exchange::block;
    else if (exchange_ == Exchange::block && (lost || visited_.contains(solved)))
      exchange_ = Exchange::fallback;
    if (exchange_ == Exchange::block) visited_.insert(solved);
    return exchange_;
  }

  /// The two questions apart, for solvers that look at a basis before they solve it.
  /// Whether the basis has been visited before; from now on it has.
  bool returns(const Basis &basis) { return !visited_.insert(basis).second; }
  /// Whether the patience is at its end with this violation.
  bool is_lost(Violation violation) {
    unimproved_ = violation < least_ ? 0 : unimproved_ + 1;
    least_ = std::min(least_, violation);
    return unimproved_ >= patience_;
  }
  Violation least() const { return least_; }
  /// A further run of blocks from elsewhere: the patience starts anew, visited bases stay visited.
  void restart() {
    unimproved_ = 0;
    least_ = std::numeric_limits<Violation>::max();
    exchange_ = Exchange::block;
  }

private:
  int patience_, unimproved_ = 0;
  Violation least_ = std::numeric_limits<Violation>::max();
  Exchange exchange_ = Exchange::block;
  std::set<Basis> visited_;
};

/// One basis of  x >= 0,  w >= 0,  x . w = 0:  x = 0 outside the active set, w = 0 inside.
struct BasicSolution {
  std::vector<Index> active;   ///< increasing
  Vector x;                    ///< values of the active entries
  Vector w;                    ///< values of all entries
  std::vector<Index> violated; ///< increasing: entries of either kind that are negative
  bool regular = true; ///< the active block can be factorised; otherwise nothing else is filled
};

/// Fills `violated`: active entries with x < -tolerance * (the largest |x|), others with
/// w < -tolerance * terms. `scaled_x`: the x in units in which its entries can be compared;
/// `terms`: the sum of the sizes of the terms of every w.
void find_violations(BasicSolution &basic, const Vector &scaled_x, const Vector &terms,
                     double tolerance);

/// The active set after `which` (increasing) changes sides.
std::vector<Index> exchanged(const std::vector<Index> &active, const std::vector<Index> &which);

/// A first guess of the active set of n entries, in order and each entry once. Throws failure if
/// an entry does not exist.
std::vector<Index> checked_guess(std::vector<Index> guess, Index n);

} // namespace rbvi::pivoting
