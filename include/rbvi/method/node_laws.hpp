// The laws of contact and friction as data, node by node: x_n >= 0, and at nodes with friction
// |x_tau| <= s(x_n), a ball of d - 1 dimensions. A system can have nodes of both kinds, from
// interfaces with laws of their own, and rows in any order.
// Niakh (2022): (3.6), (3.13)-(3.16), (3.20)-(3.23), Remark 3.2.1, Remark 3.2.2.
#pragma once

#include "rbvi/core/dense.hpp"

#include <algorithm>
#include <limits>
#include <vector>

namespace rbvi {

/// A law of friction at one mu: the bound s = min(c (x_n - a)_+ + t, m) of |x_tau| at a node. Where
/// it adheres x_n is its pressure above the least one, -a, so that x_n >= 0 as without adhesion;
/// the pull a is a load. All that solvers ask of a law are its functions: they hold s as a function
/// that is linear piece by piece, and may jump where contact begins.
struct FrictionBound {
  double coefficient = 0;       ///< c >= 0
  double threshold = 0;         ///< t >= 0
  bool only_in_contact = false; ///< t = 0 while the node carries no pressure
  double limit = std::numeric_limits<double>::infinity(); ///< m >= 0
  double pull = 0;                                        ///< a >= 0

  /// s = offset + slope x_n while the node carries pressure.
  struct Piece {
    double offset, slope;
  };
  /// Which piece x_n is on: 0, where the pressure is above zero; 1, the limit; 2, below both of
  /// them. A part of the state of a node that slips.
  int piece_at(double x_n) const {
    if (pull > 0 && x_n <= pull) return 2;
    return threshold + coefficient * (x_n - pull) > limit ? 1 : 0;
  }
  Piece piece(int number) const {
    if (number == 0) return {threshold - coefficient * pull, coefficient};
    return {number == 1 ? limit : std::min(threshold, limit), 0};
  }
  /// What terms of s are of, at least, where pieces meet.
  double size_at_kinks(double s) const { return std::max(s, coefficient * pull); }
  double slope_at(double x_n) const { return piece(piece_at(x_n)).slope; }
  /// The slope where the pressure grows from 0, which no other piece exceeds.
  double steepest() const { return coefficient; }
  /// s, which does not fall as x_n grows; a negative x_n, or pressure, counts as zero.
  double value(double x_n) const {
    const double at_zero = x_n > 0 || !only_in_contact ? threshold : 0.0;
    return std::min(coefficient * std::max(x_n - pull, 0.0) + at_zero, limit);
  }
  /// Whether s at some x_n is above zero.
  bool acts() const { return limit > 0 && (coefficient > 0 || threshold > 0); }
  /// Whether s is zero at a node without pressure and above zero at any that has some.
  bool jumps() const { return only_in_contact && threshold > 0; }
  /// Whether s depends on x_n.
  bool follows_pressure() const { return coefficient > 0 || jumps(); }
  /// Whether x_tau of a node can differ from zero.
  bool carries_traction(bool in_contact) const {
    return acts() && (in_contact || (threshold > 0 && !only_in_contact));
  }
  /// Laws on the way to this one: with this part of its slopes; with s at zero so many times as
  /// high.
  FrictionBound with_slopes(double part) const {
    return {part * coefficient, threshold, only_in_contact, limit, pull};
  }
  FrictionBound with_threshold(double factor) const {
    return {coefficient, factor * threshold, only_in_contact, limit, pull};
  }
  /// Throws bad_input for a number that is negative or, but for m, not finite.
  void check() const;
};

/// One bound for each of so many nodes, from as many, or from one that is that of all. Throws
/// failure for another number, bad_input for a bound that is negative.
std::vector<FrictionBound> bounds_per_node(const std::vector<FrictionBound> &bounds, Index nodes);

/// Those of some nodes.
std::vector<FrictionBound> bounds_at(const std::vector<FrictionBound> &bounds,
                                     const std::vector<Index> &nodes);

/// s of each of these normal multipliers.
Vector values_of(const FrictionBound &bound, const Vector &normal);

struct NodeLaws {
  int tangents = 1;                 ///< entries of x_tau of a node with friction, d - 1
  Index rows = 0;                   ///< entries of x
  std::vector<Index> normal;        ///< per node: its entry x_n
  std::vector<Index> tangent;       ///< per node: the first entry of x_tau, -1: there is none
  std::vector<FrictionBound> bound; ///< per node
  /// Per node: the entries of x_tau, from the first, that need not be zero. H is zero in the rows
  /// of the others, as of a traction across a plane of symmetry. Empty: all of them.
  std::vector<int> free{};

  Index nodes() const { return static_cast<Index>(normal.size()); }
  bool has_tangent(Index node) const { return tangent[node] >= 0; }
  int free_at(Index node) const { return free.empty() ? tangents : free[node]; }
  bool has_tangents() const; ///< some node
  /// Of x_tau at a node; of one without a tangent none.
  const FrictionBound &friction_at(Index node) const {
    static const FrictionBound none;
    return has_tangent(node) ? bound[node] : none;
  }
  /// Whether some node can carry a tangential traction.
  bool friction() const;
};

/// `nodes` nodes of one law: all x_n, then all x_tau, `components` entries of x in all for each.
NodeLaws uniform_laws(Index nodes, int components, const FrictionBound &bound);

/// Puts the nodes and rows of `part` behind those of `laws`.
void append(const NodeLaws &part, NodeLaws &laws);

/// Throws failure unless every row is that of one node; bad_input for a negative bound.
void check(const NodeLaws &laws);

/// s of every node at x.
Vector bounds_of(const NodeLaws &laws, const Vector &x);

/// The projection onto x_n >= 0, then |x_tau| <= s(x_n), node by node (corrected (3.32)).
Vector admissible(const NodeLaws &laws, Vector x);

/// Largest violation of the laws, relative: |x - P(start)| over max |x|, start = x - w / H_jj and P
/// the projection of the laws; zero where x solves them.
double violation(const NodeLaws &laws, const Vector &x, const Vector &start);

/// Values of the rows x_n alone; zero in the others.
Vector normal_part(const NodeLaws &laws, const Vector &x);

} // namespace rbvi
