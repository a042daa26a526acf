// Contact that follows the displacement, seen from the nodes of its multipliers: where every point
// of it has one normal n(s), B(s) is int eta n . v, and for displacements that are alike over the
// support of a multiplier's function
//
//   B(s)_a v = n_a . (A v)_a,    n_a = int eta_a n(s),    (A v)_a: v averaged with the weight
//   eta_a,
//
// where A depends neither on mu nor on s. So do the blocks G_ab = (A C A^T)_ab of 2 x 2, and
// H_ab = n_a . G_ab n_b is B(s) C B(s)^T up to the second order in the mesh width: a tangent that
// is made from stored numbers, without C, beside residuals that are exact.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/method/compliance.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace rbvi {

/// The condition of contact at a state s, with multipliers x. Rows of x and w: normal ones of all
/// nodes, then (friction) tangential ones.
struct NodalCondition {
  Vector w;                ///< g(s) - B(s) s
  Vector load;             ///< B(s)^T x, at the contact dofs
  Eigen::Matrix2Xd normal; ///< 2 x nodes: n_a
  Vector rotation; ///< per node, int eta x k: k times a tangential displacement turns the normal
};

/// An evaluation of the condition at the nodes of `near` (empty: all of them), among which are all
/// with a multiplier: of other nodes nothing is told, and the state is asked for on the functions
/// of these nodes alone.
using NodalEvaluation =
    std::function<void(const Vector &state, const Vector &x, const std::vector<bool> &near,
                       NodalCondition &condition)>;

/// The products A C A^T and C A^T of one C; the columns of a node are made when it is required.
class NodalCompliance {
public:
  /// `average`: A, rows 2 node + component, columns the contact dofs.
  explicit NodalCompliance(SparseMatrix average);
  /// Drops all columns: C is another one.
  void forget() { known_.assign(known_.size(), false); }
  /// Makes the columns of these nodes. Collective where `compliance` is.
  void require(const std::vector<Index> &nodes, Compliance &compliance);

  const SparseMatrix &average() const { return average_; }
  /// The nodes whose functions meet that of a node.
  const std::vector<Index> &neighbours(Index node) const { return neighbours_[node]; }
  /// C A_a^T, contact dofs x 2, of a node that was required.
  auto moved(Index node) const { return moved_.middleCols<2>(2 * node); }
  /// What a load on node b, which was required, moves: (G_ab load) of the nodes a from `first` on,
  /// two components each.
  auto moved_nodes(Index b, const Eigen::Vector2d &load, Index first, Index count) const {
    return load[0] * blocks_.col(2 * b).segment(2 * first, 2 * count) +
           load[1] * blocks_.col(2 * b + 1).segment(2 * first, 2 * count);
  }
  /// G_ab, b one that was required.
  Eigen::Matrix2d block(Index a, Index b) const {
    const double *at = &blocks_(2 * a, 2 * b);
    return (Eigen::Matrix2d() << at[0], at[blocks_.rows()], at[1], at[blocks_.rows() + 1])
        .finished();
  }

private:
  SparseMatrix average_;
  std::vector<std::vector<Index>> neighbours_;
  Matrix moved_, blocks_;
  std::vector<bool> known_;
};

} // namespace rbvi
