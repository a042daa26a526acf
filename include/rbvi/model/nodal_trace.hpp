// The primal basis of a model where single nodes are constrained, and the gap that it leaves there.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/model/model.hpp"

namespace rbvi {

class NodalTrace {
public:
  /// `model` must outlive it.
  NodalTrace(const ReducedModel &model, const Contact &contact);
  /// nodal_gap - nodal_b u; infinite at nodes where the model has no displacement.
  Vector gap_left(const ContactOperators &operators, const Vector &u) const;
  /// Throws failure where `gap`, of gap_left, says that bodies meet at a node without multipliers,
  /// in a model whose multipliers are those near contact.
  void check_outside(const ContactOperators &operators, const Vector &gap) const;

private:
  const ReducedModel &model_;
  std::vector<Index> dofs_;   ///< contact dofs that nodal_b acts on; empty: all
  Matrix trace_;              ///< the primal basis there
  std::vector<bool> unknown_; ///< of each contact dof; empty: none is
  /// Where b separates per normal multiplier whether it has a column, else per contact dof whether
  /// some column meets it; empty: all.
  std::vector<bool> held_;
};

} // namespace rbvi
