// Steps with the tangent between nodes (rbvi/method/nodal.hpp): Newton's where there is no
// friction, the turning of the normals included; Kacanov's with friction. What they converge to is
// exact, since the residuals are; the contraction is that of the tangent's error.
#pragma once

#include "linearised_contact.hpp"
#include "loaded_columns.hpp"

#include <Eigen/Cholesky>

namespace rbvi {

class NodalSteps {
public:
  /// `contact.nodal` is there; it must outlive this.
  /// `whole`: states are wanted on all contact dofs, not only near contact.
  NodalSteps(const NonlinearContact &contact, bool whole)
      : contact_(contact), near_(whole ? 0 : static_cast<std::size_t>(contact.laws.nodes())) {}
  /// From `state` with the multipliers last.x, not empty. `change`: relative, of the last step.
  Iterate step(const Vector &state, const Iterate &last, double change);
  /// Sets u on all contact dofs and evaluates the condition there. False where that makes nodes
  /// overlap which no step has seen; the next ones see all.
  bool complete(Iterate &iterate);
  const NodalCondition &condition() const { return here_; }

private:
  using Frame = Eigen::Vector2d;
  Frame normal(Index node) const { return {here_.normal(0, node), here_.normal(1, node)}; }
  Frame tangent(Index node) const { return {-here_.normal(1, node), here_.normal(0, node)}; }
  /// Nodes that carry or that overlap.
  std::vector<Index> touching(const Vector &x) const;
  /// These nodes, and some beside them, are near.
  void see(const std::vector<Index> &nodes);
  /// u less what they move, on rows_.
  void subtract(const LoadedColumns &columns, Vector &u) const {
    for (const Compliance::Range &rows : rows_)
      columns.subtract_from(u, rows);
  }
  double diagonal(Index node, const Frame &along) const;
  Vector diagonals(const std::vector<Index> &known) const;
  bool are_as_before(const std::vector<Index> &nodes, const Eigen::Matrix2Xd &before) const;
  void begin_near();
  Matrix columns(const std::vector<Index> &which);
  void set_tangent(const std::vector<Index> &active);
  /// The loads, two components a node, that a Newton step adds; changes x.
  Eigen::Matrix2Xd newton_on_active(double tolerance, Vector &x) const;
  Compliance::Range near_range() const;
  std::vector<Index> violated(const Vector &x, const Eigen::Matrix2Xd &loads) const;
  Eigen::Matrix2Xd newton(Vector &x, double change);
  Eigen::Matrix2Xd kacanov(const Iterate &last, Iterate &next);

  const NonlinearContact &contact_;
  std::vector<bool> near_;              ///< per node; empty: all
  std::vector<Compliance::Range> rows_; ///< the contact dofs beside them
  NodalCondition here_;
  Eigen::Matrix2Xd e_;          ///< 2 x nodes, A (u_0 - C load - s)
  Eigen::Matrix2Xd tangent_at_; ///< the normals when the tangent was made; empty: there is none
  // With friction: the nodes near contact, their rows and laws; H between them, the columns that
  // are known.
  std::vector<Index> near_nodes_, near_rows_;
  NodeLaws near_laws_;
  Matrix h_;
  std::vector<bool> known_;
  // Without friction, between the active nodes: H, its factor; tangential displacements under
  // normal (p_) and tangential (q_) loads.
  std::vector<Index> active_;
  Matrix factor_;
  Matrix p_, q_;
};

} // namespace rbvi
